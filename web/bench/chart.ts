// The chart of the benchmark: sequences of 20 steps that return to their first step.

export const LENGTH = 20;

/** A chart of this many steps; with `timed`, each token moves on by itself 25 times a second. */
export function chartText(steps: number, timed = false): string {
  const lines = ['input a, b, c : BOOL', 'output V : BOOL', 'chart Big {'];
  for (let i = 0; i < steps; i++) {
    const head = i % LENGTH === 0 ? 'initial step' : 'step';
    lines.push(`  ${head} ${i}${i % 4 === 1 ? ' { N V }' : ''}`);
  }
  for (let i = 0; i < steps; i++) {
    const to = i % LENGTH === LENGTH - 1 ? i - LENGTH + 1 : i + 1;
    lines.push(`  ${i} -> ${to} when ${timed ? `40ms/X${i}` : 'a · not b + ↑c'}`);
  }
  lines.push('}');
  return lines.join('\n');
}

/** The active step in each of 50 places at a tick. */
export function active(steps: number, tick: number): number[] {
  const every = steps / 50;
  return Array.from({ length: 50 }, (_, n) => Math.floor(n * every) + ((tick + n) % Math.max(1, Math.floor(every))));
}
