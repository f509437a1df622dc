// Compares two runs of one chart under two profiles: finds where they start to differ.
import type { Run } from './state.svelte';

export interface Difference {
  ms: number;
  /** The signals that differ, with their values in both runs. */
  signals: { name: string; a: string; b: string }[];
  seen: boolean;
}

/** Steps and outputs by name, with the numbers of their signals. */
function watched(run: Run): Map<string, number> {
  const found = new Map<string, number>();
  run.started.signals.forEach((s, i) => {
    if (s.role === 'output') found.set(s.name, i);
  });
  run.started.steps.forEach((s, i) => found.set(s.activity, run.started.signals.length + i));
  return found;
}

function same(a: Run, b: Run): boolean {
  const other = watched(b);
  for (const [name, lane] of watched(a)) {
    const there = other.get(name);
    if (there !== undefined && value(a, lane) !== value(b, there)) return false;
  }
  return true;
}

function value(run: Run, lane: number): string {
  const step = lane - run.started.signals.length;
  if (step < 0) return run.shows[lane] ?? '';
  return run.active.has(step) ? 'TRUE' : 'FALSE';
}

/** The first instant after `since`, at which the runs were equal, at which steps or outputs differ.
 * */
export async function differ(a: Run, b: Run, since = 0): Promise<Difference | null> {
  // Many scans can lie between two messages: runs that are equal now need not have been equal all
  // the time.
  if (a.now === b.now && a.now <= since && same(a, b)) return null;
  const here = watched(a);
  const there = watched(b);
  const names = [...here.keys()].filter((n) => there.has(n));
  const to = Math.max(a.now, b.now);
  const ask = (run: Run, of: Map<string, number>) =>
    run.answers.call({
      do: 'run_lanes',
      run: run.name,
      signals: names.flatMap((n) => of.get(n) ?? []),
      from_ms: Math.min(since, a.now, b.now),
      to_ms: to,
      most: 100_000,
    });
  const [left, right] = await Promise.all([ask(a, here), ask(b, there)]);
  let first = Infinity;
  let signals: Difference['signals'] = [];
  names.forEach((name, i) => {
    const found = parting(left.lanes[i] ?? [], right.lanes[i] ?? [], to);
    if (!found || found.ms > first) return;
    if (found.ms < first) signals = [];
    first = found.ms;
    signals.push({ name, a: found.a, b: found.b });
  });
  return signals.length > 0 ? { ms: first, signals, seen: false } : null;
}

type Edge = [number, number, string];

/** The first difference between two lanes. */
function parting(a: Edge[], b: Edge[], to: number): { ms: number; a: string; b: string } | null {
  const instants = [...new Set([...a, ...b].map((e) => e[0]))].sort((x, y) => x - y);
  let i = -1;
  let j = -1;
  for (const ms of instants) {
    if (ms > to) return null;
    while (i + 1 < a.length && (a[i + 1] as Edge)[0] <= ms) i++;
    while (j + 1 < b.length && (b[j + 1] as Edge)[0] <= ms) j++;
    const left = a[i]?.[2] ?? '';
    const right = b[j]?.[2] ?? '';
    if (left !== right) return { ms, a: left, b: right };
  }
  return null;
}
