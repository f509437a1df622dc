// Drawings as the page has them, made of the differences that the worker sends.
import { page, type Message } from './page';
import type { Drawing, Item, Redrawn } from './protocol';

/** The drawing of one chart in one look, asked for again after every change of the text. */
export class Redraws {
  #number = 0;
  #items: Item[] = [];

  async ask(message: Message): Promise<Drawing> {
    const answer = await page.call<Redrawn>({ ...message, since: this.#number });
    const { number, since, places, items, ...drawing } = answer;
    // Another drawing may have come in between; the worker answers in order, but asks may overlap.
    if (since !== undefined && since !== this.#number) return this.ask(message);
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
    if (item.as === undefined) return item;
    const { svg, far } = old[item.as] as Item;
    return { ...item, svg, far };
  });
}
