// Finds the transitions of a run in a drawing whose text has changed since. The id of a transition contains its number, and
// another transition can have that number now. Steps need no such search: their ids contain their names.
import { chartOf } from '../lib/ids';
import type { Item } from '../lib/protocol';

/** Two texts by which a transition is found again: its label, or its steps with its receptivity; and its steps alone. */
type Traits = readonly [whole: string, steps: string];

function traitsOf({ label, steps, source }: Item): Traits {
  const between = JSON.stringify(steps ?? []);
  return [label === undefined ? `${between} ${source ?? ''}` : `label ${label}`, between];
}

const transitionsOf = (items: readonly Item[]) => items.filter((item) => item.part === 'transition');

/** The transitions of a run as they were drawn when the text was last that of the run. */
export class Transitions {
  /** By the names of charts and the ids of that time. */
  readonly #known = new Map<string, ReadonlyMap<string, Traits>>();
  /** The present ids, by the names of charts and the ids of that time. A transition that is gone has none. */
  readonly #moved = new Map<string, ReadonlyMap<string, string>>();

  /** Notes the drawing of a chart. `same` is true if its text is that of the run. */
  show(chart: string, items: readonly Item[], same: boolean): void {
    const now = transitionsOf(items);
    if (same) {
      this.#known.set(chart, new Map(now.map((item) => [item.id, traitsOf(item)])));
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
function paired(before: ReadonlyMap<string, Traits>, now: readonly Item[]): Map<string, string> {
  const found = new Map<string, string>();
  let left: [string, Traits][] = [...before];
  let free: [string, Traits][] = now.map((item) => [item.id, traitsOf(item)]);
  for (const which of [0, 1] as const) {
    const [olds, news] = [grouped(left, which), grouped(free, which)];
    for (const [trait, ids] of olds) {
      const others = news.get(trait) ?? [];
      if (which === 1 && (ids.length !== 1 || others.length !== 1)) continue;
      ids.slice(0, others.length).forEach((id, n) => found.set(id, others[n] as string));
    }
    const taken = new Set(found.values());
    left = left.filter(([id]) => !found.has(id));
    free = free.filter(([id]) => !taken.has(id));
  }
  return found;
}

/** The ids of the transitions that share a trait, by that trait. */
function grouped(all: readonly (readonly [string, Traits])[], which: 0 | 1): Map<string, string[]> {
  const groups = new Map<string, string[]>();
  for (const [id, traits] of all) {
    const group = groups.get(traits[which]);
    if (group) group.push(id);
    else groups.set(traits[which], [id]);
  }
  return groups;
}
