// Drawings as the page has them, made of the differences that the worker sends.
import { page } from './page';
import type { Item, Redrawn, Requests } from './protocol';

/** A whole drawing. */
export interface Drawing extends Omit<Redrawn, 'items' | 'number' | 'since' | 'places'> {
  items: Item[];
}

/** A drawing that is asked for once. */
export async function drawn(wish: Omit<Requests['drawing'], 'since'>): Promise<Drawing> {
  const { items, ...drawing } = await page.call({ ...wish, do: 'drawing' });
  return { ...drawing, items: merged(items, [], []) };
}

/** The drawing of one chart in one look, asked for again after every change of the text. */
export class Redraws {
  #number = 0;
  #items: Item[] = [];

  async ask(wish: Omit<Requests['drawing'], 'since'>): Promise<Drawing> {
    const answer = await page.call({ ...wish, do: 'drawing', since: this.#number });
    const { number, since, places, items, ...drawing } = answer;
    // Another drawing may have come in between; the worker answers in order, but asks may overlap.
    if (since !== undefined && since !== this.#number) return this.ask(wish);
    this.#items = merged(items, this.#items, places ?? []);
    this.#number = number ?? 0;
    return { ...drawing, items: this.#items };
  }
}

function merged(sent: Redrawn['items'], old: Item[], places: number[]): Item[] {
  let next = 0;
  return sent.map((item) => {
    if (typeof item === 'number') {
      const known = old[item] as Item;
      const [from, to] = [places[next++] as number, places[next++] as number];
      return known.from === from && known.to === to ? known : { ...known, from, to };
    }
    if (!('as' in item)) return item;
    const { as, ...rest } = item;
    const { svg, far } = old[as] as Item;
    return { ...rest, svg, far };
  });
}
