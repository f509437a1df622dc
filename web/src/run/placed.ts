// Where the transitions of a run stand in a drawing whose text has changed since. An id has the number of a transition,
// and another transition can have it now; steps have their names.
import { chartOf } from '../lib/ids';
import type { Item } from '../lib/protocol';

/** What tells a transition from others, the surer one first: its label, or its steps and its receptivity; its steps. */
type Marks = readonly [whole: string, steps: string];

function marksOf({ label, steps, source }: Item): Marks {
  const between = JSON.stringify(steps ?? []);
  return [label === undefined ? `${between} ${source ?? ''}` : `label ${label}`, between];
}

const transitionsOf = (items: readonly Item[]) => items.filter((item) => item.part === 'transition');

/** The transitions of a run, by the names of their charts, as they were when text and run agreed. */
export class Placed {
  readonly #known = new Map<string, ReadonlyMap<string, Marks>>();
  /** The new ids in the charts that are drawn; none for a transition that is no longer there. */
  readonly #moved = new Map<string, ReadonlyMap<string, string>>();

  /** Takes in the drawing of a chart; `same` says that its text is that of the run. */
  show(chart: string, items: readonly Item[], same: boolean): void {
    const now = transitionsOf(items);
    if (same) {
      this.#known.set(chart, new Map(now.map((item) => [item.id, marksOf(item)])));
      this.#moved.delete(chart);
    } else this.#moved.set(chart, paired(this.#known.get(chart) ?? new Map(), now));
  }

  /** The present id of a transition of the run; null if there is none, or if it is not known. */
  of(id: string): string | null {
    const moved = this.#moved.get(chartOf(id));
    return moved ? (moved.get(id) ?? null) : id;
  }
}

/** Pairs transitions of before with those of now: first those that are alike in all, in their order, then those between the
 * same steps, if there is one on each side. */
function paired(before: ReadonlyMap<string, Marks>, now: readonly Item[]): Map<string, string> {
  const found = new Map<string, string>();
  let left: [string, Marks][] = [...before];
  let free: [string, Marks][] = now.map((item) => [item.id, marksOf(item)]);
  for (const which of [0, 1] as const) {
    const [olds, news] = [grouped(left, which), grouped(free, which)];
    for (const [mark, ids] of olds) {
      const others = news.get(mark) ?? [];
      if (which === 1 && (ids.length !== 1 || others.length !== 1)) continue;
      ids.slice(0, others.length).forEach((id, n) => found.set(id, others[n] as string));
    }
    const taken = new Set(found.values());
    left = left.filter(([id]) => !found.has(id));
    free = free.filter(([id]) => !taken.has(id));
  }
  return found;
}

/** The ids with each mark. */
function grouped(all: readonly (readonly [string, Marks])[], which: 0 | 1): Map<string, string[]> {
  const groups = new Map<string, string[]>();
  for (const [id, marks] of all) groups.set(marks[which], [...(groups.get(marks[which]) ?? []), id]);
  return groups;
}
