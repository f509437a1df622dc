// Drawings as the page has them, made of the differences that the worker sends.
//
// A symbol that only moves is not sent again: its SVG stays what it was where the symbol first stood, and
// `shift` leads from there to the present place. Boxes and points are always those of the present place.
import { page } from './page';
import type { Box, Item, Redrawn, Requests } from './protocol';

type Vector = [x: number, y: number];

/** A symbol in a drawing. */
export interface Placed extends Item {
  /** How far the symbol stands from where `svg` and `far` show it; absent if it stands there. */
  shift?: Vector | undefined;
}

/** A whole drawing. */
export interface Drawing extends Omit<Redrawn, 'items' | 'number' | 'since'> {
  items: Placed[];
}

/** The transformation that puts the SVG of a symbol at its place. */
export const placing = ({ shift }: Placed): string | undefined => (shift ? `translate(${shift[0]} ${shift[1]})` : undefined);

/** The SVG of a symbol at its place. */
export const svgOf = (item: Placed): string => (item.shift ? `<g transform="${placing(item)}">${item.svg}</g>` : item.svg);

/** A drawing that is asked for once. */
export async function drawn(wish: Omit<Requests['drawing'], 'since'>): Promise<Drawing> {
  const { items, ...drawing } = await page.call({ ...wish, do: 'drawing' });
  return { ...drawing, items: merged(items, []) };
}

/** The drawing of one chart in one look, asked for again after every change of the text. */
export class Redraws {
  #number = 0;
  #items: Placed[] = [];

  async ask(wish: Omit<Requests['drawing'], 'since'>): Promise<Drawing> {
    const answer = await page.call({ ...wish, do: 'drawing', since: this.#number });
    const { number, since, items, ...drawing } = answer;
    // Another drawing may have come in between; the worker answers in order, but asks may overlap.
    if (since !== undefined && since !== this.#number) return this.ask(wish);
    this.#items = merged(items, this.#items);
    this.#number = number ?? 0;
    return { ...drawing, items: this.#items };
  }
}

function merged(sent: Redrawn['items'], old: Placed[]): Placed[] {
  const items: Placed[] = [];
  for (const one of sent) {
    if ('count' in one) {
      const { as, count, by, along, ids, ends } = one;
      const stays = by[0] === 0 && by[1] === 0;
      let joined = 0;
      for (let n = 0; n < count; n++) {
        const was = old[as + n] as Placed;
        if (stays && along === 0 && !ids) {
          items.push(was);
          continue;
        }
        const item = stays ? { ...was } : moved(was, by);
        item.from += along;
        item.to += along;
        if (ids) item.id = ids[n] as string;
        if (was.ends && ends) item.ends = ends[joined++] as [string, string];
        items.push(item);
      }
    } else if ('as' in one) {
      const { as, by, ...rest } = one;
      const was = old[as] as Placed;
      items.push({ ...rest, svg: was.svg, far: was.far, shift: shifted(was.shift, by) });
    } else items.push(one);
  }
  return items;
}

// Lengths have one decimal; sums of them would get more.
const sum = (a: number, b: number) => Math.round((a + b) * 10) / 10;
const to = ([x, y]: Vector, by: Vector): Vector => [sum(x, by[0]), sum(y, by[1])];
const boxTo = ([x, y, w, h]: Box, by: Vector): Box => [sum(x, by[0]), sum(y, by[1]), w, h];

function moved(was: Placed, by: Vector): Placed {
  const item: Placed = { ...was, area: boxTo(was.area, by), shift: shifted(was.shift, by) };
  if (was.square) item.square = boxTo(was.square, by);
  if (was.bar) item.bar = boxTo(was.bar, by);
  if (was.text) item.text = boxTo(was.text, by);
  if (was.at) item.at = to(was.at, by);
  return item;
}

function shifted(was: Vector | undefined, by: Vector): Vector | undefined {
  const shift = to(was ?? [0, 0], by);
  return shift[0] === 0 && shift[1] === 0 ? undefined : shift;
}
