// The instances of charts with parameters: several parts of a run have one symbol, and a drawing shows
// those of the chosen instance.
import { chartOf } from './ids';
import type { ChartRow } from './protocol';

/** A step or transition of a run. */
export interface Part {
  id: string;
  instance?: string | null;
}

/** The instances of each chart with parameters, by the name of the chart, in the order of the program. */
export function instancesOf(steps: readonly Part[]): Map<string, string[]> {
  const found = new Map<string, Set<string>>();
  for (const step of steps) {
    if (!step.instance) continue;
    const chart = chartOf(step.id);
    found.set(chart, (found.get(chart) ?? new Set()).add(step.instance));
  }
  return new Map([...found].map(([chart, names]) => [chart, [...names]]));
}

/** The chart that is drawn for a name: `Axis` for `Axis[3]`, for an instance with a name of its own, and `Cycle` for
 * `left.Cycle`, the chart of an instance of a function block. */
export function drawnFor(charts: readonly ChartRow[], name: string): string | undefined {
  const base = name.replace(/\[[^\]]*\]$/, '');
  const found = charts.find((c) => c.name === name) ?? charts.find((c) => c.params && c.name === base) ?? charts.find((c) => c.instances?.includes(name)) ?? charts.find((c) => c.block && name.endsWith(`.${c.name}`));
  return found?.name;
}

/** The name that the chart of a symbol has in the program. */
export type Chosen = (chart: string) => string;

/** True if a part is that of the chosen instance, or of a chart without parameters. */
export function isShown(part: Part | undefined, chosen: Chosen): part is Part {
  return part !== undefined && (!part.instance || part.instance === chosen(chartOf(part.id)));
}

/** The ids of those parts of a run that a drawing shows, each with what is told of the part. */
export function* shownOf<T>(parts: readonly Part[], told: Iterable<readonly [number, T]>, chosen: Chosen): Generator<[string, T]> {
  for (const [number, what] of told) {
    const part = parts[number];
    if (isShown(part, chosen) && part.id) yield [part.id, what];
  }
}

class Choices {
  /** The chosen instances, by file and chart. */
  #chosen: ReadonlyMap<string, string> = $state.raw(new Map());

  /** The instance that the drawing of a chart shows: the chosen one, otherwise the first. A chart without
   * parameters is its own. */
  of(file: string, chart: string, instances: ReadonlyMap<string, readonly string[]>): string {
    const names = instances.get(chart);
    const chosen = this.#chosen.get(`${file}\n${chart}`);
    return chosen !== undefined && names?.includes(chosen) ? chosen : (names?.[0] ?? chart);
  }

  choose(file: string, chart: string, instance: string): void {
    this.#chosen = new Map(this.#chosen).set(`${file}\n${chart}`, instance);
  }
}

export const choices = new Choices();
