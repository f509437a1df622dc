// The sheet of the picture editor: the text of the picture, its bindings, what is selected, and every change of them with
// its way back. The text is the truth: a change splices it, and what stands on the sheet is read from it again.
import { untrack } from 'svelte';
import type { PictureBinding, PictureName } from '../lib/protocol';
import { rangeOf, sameBinding, USUAL, valueFor, type Offer, type Range } from './effects';
import { around, framed, placeOf, STILL, union, type Box, type Place } from './frame';
import { attribute, encoded, inside, local, spliced, withAttribute, type Splice } from './markup';
import { partOf, stem, written, type Part } from './parts';
import { appended, content, freeName, marked, NAME, pictureOf, renamed, sizeOf, withFrame, without, withStyle, type Picture, type Thing } from './things';

/** The state of the sheet at one moment. */
interface Moment {
  text: string;
  bindings: readonly PictureBinding[];
}

export const GRID = 10;
/** The colours that a part can be given; each is light where the page is light, and dark where it is dark. */
export const COLOURS = {
  ink: '#232a33',
  soft: '#56606e',
  accent: '#1d56d8',
  green: '#0f7a3a',
  red: '#c0272d',
  amber: '#8f5a00',
  violet: '#7a3cc2',
  sunken: '#eceff3',
} as const;
export type Colour = keyof typeof COLOURS;

export type Edge = 'left' | 'centre' | 'right' | 'top' | 'middle' | 'bottom';
export type Layer = 'front' | 'back' | 'forward' | 'backward';

const TINT = /^--tint: var\(--(\w+), #[\da-f]+\)$/;

/** A new picture, with a name for screen readers. */
export const blank = (title: string): string =>
  `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 400 240" font-family="sans-serif" font-size="12">\n  <title>${encoded(title)}</title>\n</svg>\n`;

export class Sheet {
  text: string = $state.raw('');
  bindings: readonly PictureBinding[] = $state.raw([]);
  selected: ReadonlySet<number> = $state.raw(new Set());
  snaps = $state(true);
  readonly names: readonly PictureName[];
  readonly picture: Picture = $derived(pictureOf(this.text));
  readonly things: readonly Thing[] = $derived(this.picture.things);
  readonly size: Box = $derived(sizeOf(this.picture));
  readonly marked: string = $derived(marked(this.picture));
  /** The boxes of the things without their frames, as the browser draws them. */
  boxes: readonly Box[] = $state.raw([]);
  readonly places: readonly Place[] = $derived(this.things.map((t, n) => placeOf(t.frame ?? STILL, this.boxes[n] ?? { x: 0, y: 0, width: 0, height: 0 })));
  readonly chosen: readonly number[] = $derived([...this.selected].filter((n) => n < this.things.length).sort((a, b) => a - b));
  /** The thing that is selected alone. */
  readonly one: number | null = $derived(this.chosen.length === 1 ? (this.chosen[0] ?? null) : null);
  #before: Moment[] = $state.raw([]);
  #after: Moment[] = $state.raw([]);
  /** The last change is one of this kind, which the next of the same kind goes on. */
  #going = '';
  #saved: Moment = $state.raw({ text: '', bindings: [] });
  readonly changed: boolean = $derived(this.text !== this.#saved.text || JSON.stringify(this.bindings) !== JSON.stringify(this.#saved.bindings));

  /** Throws where the text is no picture. */
  constructor(text: string, bindings: readonly PictureBinding[], names: readonly PictureName[], fresh: boolean) {
    pictureOf(text);
    this.text = text;
    this.bindings = bindings;
    this.names = names;
    this.#saved = fresh ? { text: '', bindings: [] } : { text, bindings };
  }

  get canUndo(): boolean {
    return this.#before.length > 0;
  }

  get canRedo(): boolean {
    return this.#after.length > 0;
  }

  /** What is on the sheet now is in the file. */
  isSaved(): void {
    this.#saved = { text: this.text, bindings: this.bindings };
  }

  undo(): void {
    this.#travel(this.#before, this.#after);
  }

  redo(): void {
    this.#travel(this.#after, this.#before);
  }

  #travel(from: Moment[], to: Moment[]): void {
    const moment = from.at(-1);
    if (!moment) return;
    const [rest, more] = [from.slice(0, -1), [...to, { text: this.text, bindings: this.bindings }]];
    [this.#before, this.#after] = from === this.#before ? [rest, more] : [more, rest];
    this.#going = '';
    this.selected = new Set();
    ({ text: this.text, bindings: this.bindings } = moment);
  }

  /** Makes a change that can be undone. Changes of one kind that follow each other, such as those of a drag, are one. */
  #change(splices: readonly Splice[], bindings: readonly PictureBinding[] = this.bindings, going = ''): void {
    const text = spliced(this.text, splices);
    if (text === this.text && bindings === this.bindings) return;
    if (going === '' || going !== this.#going) this.#before = [...this.#before, { text: this.text, bindings: this.bindings }];
    this.#after = [];
    this.#going = going;
    this.text = text;
    this.bindings = bindings;
  }

  /** The next change is one of its own. */
  rest(): void {
    this.#going = '';
  }

  // Selection

  select(things: Iterable<number>): void {
    this.selected = new Set(things);
    this.rest();
  }

  toggle(thing: number): void {
    const now = new Set(this.selected);
    if (!now.delete(thing)) now.add(thing);
    this.select(now);
  }

  selectAll(): void {
    this.select(this.things.keys());
  }

  /** What a thing is called: its own title, its part, its first name. */
  nameOf(n: number): string {
    const thing = this.things[n];
    if (!thing) return '';
    const title = [...inside(thing.element)].find((e) => local(e) === 'title');
    const said = title ? this.text.slice(title.open, title.close).trim() : '';
    const name = thing.part === null ? thing.names[0] : thing.names[0]?.split('_')[0];
    return said || name || thing.part || local(content(thing));
  }

  // Changes of the drawing

  snapped(n: number): number {
    return this.snaps ? Math.round(n / GRID) * GRID : Math.round(n);
  }

  /** Puts a part on the sheet, with its middle at a place; without one, where there is room. */
  add(part: Part, at?: { x: number; y: number }): void {
    const { x, y } = at ?? this.#room(part);
    const name = freeName(this.picture, stem(part.id));
    const transform = `translate(${this.snapped(x - part.width / 2)} ${this.snapped(y - part.height / 2)})`;
    const count = this.things.length;
    this.#change([...withStyle(this.picture, part.id, part.style), ...appended(this.picture, written(part, name, transform))]);
    this.select([count]);
  }

  /** Puts an SVG file of the user on the sheet as a part; throws where it is none. */
  addFile(name: string, text: string): void {
    this.add(partOf(name.replace(/\.svg$/i, ''), text, name));
  }

  #room({ width, height }: Part): { x: number; y: number } {
    const { x, y, width: w, height: h } = this.size;
    const taken = untrack(() => this.places).map(around);
    for (let top = y + GRID; top + height <= y + h; top += GRID)
      for (let left = x + GRID; left + width <= x + w; left += GRID)
        if (taken.every((b) => left >= b.x + b.width || left + width <= b.x || top >= b.y + b.height || top + height <= b.y)) return { x: left + width / 2, y: top + height / 2 };
    return { x: x + w / 2, y: y + h / 2 };
  }

  /** Puts things to places. */
  put(places: ReadonlyMap<number, Place>, going = ''): void {
    const splices = [...places].flatMap(([n, place]) => {
      const [thing, box] = [this.things[n], this.boxes[n]];
      return thing && box ? withFrame(this.text, thing, framed(place, box)) : [];
    });
    this.#change(splices, this.bindings, going);
  }

  /** Moves what is selected. */
  shift(dx: number, dy: number, going = ''): void {
    const moved = this.chosen.flatMap((n): [number, Place][] => {
      const place = this.places[n];
      return place ? [[n, { ...place, cx: place.cx + dx, cy: place.cy + dy }]] : [];
    });
    if (dx !== 0 || dy !== 0) this.put(new Map(moved), going);
  }

  /** Brings an edge or the middle of what is selected into one line; of one thing alone, into that of the sheet. */
  align(edge: Edge): void {
    const boxes = this.chosen.flatMap((n): [number, Box, Place][] => (this.places[n] ? [[n, around(this.places[n]), this.places[n]]] : []));
    const all = boxes.length === 1 ? this.size : union(boxes.map(([, box]) => box));
    const by: Record<Edge, (b: Box) => [number, number]> = {
      left: (b) => [all.x - b.x, 0],
      centre: (b) => [all.x + all.width / 2 - b.x - b.width / 2, 0],
      right: (b) => [all.x + all.width - b.x - b.width, 0],
      top: (b) => [0, all.y - b.y],
      middle: (b) => [0, all.y + all.height / 2 - b.y - b.height / 2],
      bottom: (b) => [0, all.y + all.height - b.y - b.height],
    };
    this.put(
      new Map(
        boxes.flatMap(([n, box, place]): [number, Place][] => {
          const [dx, dy] = by[edge](box);
          return Math.abs(dx) + Math.abs(dy) < 1e-3 ? [] : [[n, { ...place, cx: place.cx + dx, cy: place.cy + dy }]];
        }),
      ),
    );
  }

  /** Draws what is selected over or under the other things. */
  raise(to: Layer): void {
    const all = [...this.things.keys()];
    const [mine, others] = [all.filter((n) => this.selected.has(n)), all.filter((n) => !this.selected.has(n))];
    const [first = 0, last = 0] = [mine[0], mine.at(-1)];
    // The number of the others that are under the selected things then.
    const under = { front: others.length, back: 0, forward: others.filter((n) => n < last).length + 1, backward: others.filter((n) => n < first).length - 1 }[to];
    const at = Math.max(0, Math.min(others.length, under));
    const order = [...others.slice(0, at), ...mine, ...others.slice(at)];
    const texts = this.things.map(({ element }) => this.text.slice(element.from, element.to));
    // Each thing is written where another one stood, so all between them stays.
    this.#change(this.things.map(({ element: { from, to } }, n) => ({ from, to, insert: texts[order[n] ?? n] ?? '' })));
    this.select(order.flatMap((n, place) => (this.selected.has(n) ? [place] : [])));
  }

  remove(): void {
    if (this.chosen.length === 0) return;
    const lost = new Set(this.chosen.flatMap((n) => this.things[n]?.names ?? []));
    const left = new Set(this.things.flatMap((t, n) => (this.selected.has(n) ? [] : t.names)));
    this.#change(without(this.picture, this.selected), this.bindings.filter((b) => !lost.has(b.element) || left.has(b.element)));
    this.select([]);
  }

  /** Copies what is selected, a little beside it. Each copy has names of its own, and no bindings. */
  duplicate(): void {
    const taken = new Set<string>();
    const copies = this.chosen.flatMap((n) => {
      const [thing, box, place] = [this.things[n], this.boxes[n], this.places[n]];
      if (!thing || !box || !place) return [];
      const old = thing.names[0]?.split('_')[0] ?? '';
      const name = freeName(this.picture, stem(thing.part ?? old), taken);
      taken.add(name);
      const to = framed({ ...place, cx: place.cx + 2 * GRID, cy: place.cy + 2 * GRID }, box);
      const rename = (was: string) => (was === '' || was === old ? name : was.startsWith(`${old}_`) ? name + was.slice(old.length) : `${name}_${was}`);
      const framedText = spliced(this.text, withFrame(this.text, thing, to));
      const element = pictureOf(framedText).things[n]?.element;
      return element ? [renamed(framedText, element, rename)] : [];
    });
    if (copies.length === 0) return;
    const count = this.things.length;
    this.#change(copies.flatMap((copy) => appended(this.picture, copy)));
    this.select(copies.map((_, n) => count + n));
  }

  // Properties

  /** The colour of a part of the palette; undefined for a thing that has no colour to choose. */
  colourOf(n: number): Colour | null | undefined {
    const thing = this.things[n];
    if (!thing || thing.part === null || !thing.frame) return undefined;
    const style = attribute(thing.element, 'style');
    if (style === undefined) return null;
    const colour = TINT.exec(style)?.[1];
    return colour !== undefined && colour in COLOURS ? (colour as Colour) : undefined;
  }

  paint(colour: Colour | null): void {
    const style = colour === null ? null : `--tint: var(--${colour}, ${COLOURS[colour]})`;
    const things = this.chosen.filter((n) => this.colourOf(n) !== undefined);
    this.#change(things.flatMap((n) => (this.things[n] ? withAttribute(this.text, this.things[n].element, 'style', style) : [])));
  }

  labelOf(n: number, label: number): string {
    const element = this.things[n]?.labels[label];
    const text = element ? this.text.slice(element.open, element.close) : '';
    return text.replaceAll('&lt;', '<').replaceAll('&gt;', '>').replaceAll('&quot;', '"').replaceAll('&amp;', '&');
  }

  write(n: number, label: number, text: string): void {
    const element = this.things[n]?.labels[label];
    if (element && element.close > element.open) this.#change([{ from: element.open, to: element.close, insert: encoded(text) }], this.bindings, `label ${n}`);
  }

  resize(width: number, height: number): void {
    const { x, y } = this.size;
    if (width >= GRID && height >= GRID) this.#change(withAttribute(this.text, this.picture.root, 'viewBox', [x, y, width, height].join(' ')));
  }

  // Bindings

  bindingsOf(n: number): PictureBinding[] {
    const names = new Set(this.things[n]?.names);
    return this.bindings.filter((b) => names.has(b.element));
  }

  /** The name of the element that an effect moves, if it has one. */
  elementOf(n: number, offer: Offer): string | null {
    const thing = this.things[n];
    return offer.element ?? (thing ? (attribute(content(thing), NAME) ?? null) : null);
  }

  /** Binds an effect of a thing to a variable; what the effect followed before, it follows no longer. */
  bind(n: number, offer: Offer, name: PictureName, range?: Range): void {
    const thing = this.things[n];
    if (!thing) return;
    const element = content(thing);
    if (offer.kind === 'press' || offer.kind === 'click') {
      const [on, off] = offer.kind === 'press' ? (['data-g7-press', 'data-g7-click'] as const) : (['data-g7-click', 'data-g7-press'] as const);
      const target = [...inside(thing.element)].find((e) => offer.element !== null && attribute(e, NAME) === offer.element) ?? element;
      this.#change([...withAttribute(this.text, target, off, null), ...withAttribute(this.text, target, on, name.name)]);
      return;
    }
    const named = this.elementOf(n, offer);
    const own = named ?? freeName(this.picture, stem(thing.part ?? local(element)));
    const bound: PictureBinding = { element: own, attribute: offer.attribute, value: valueFor(offer, name, range ?? rangeOf(name) ?? USUAL) };
    const at = this.bindings.findIndex((b) => sameBinding(b, bound));
    const bindings = at < 0 ? [...this.bindings, bound] : this.bindings.with(at, bound);
    this.#change(named === null ? this.#naming(thing, own) : [], bindings);
  }

  /** Gives a thing a name. One with a transform of its own is put into a group that has the name. */
  #naming(thing: Thing, name: string): Splice[] {
    const element = content(thing);
    if (attribute(element, 'transform') === undefined) return withAttribute(this.text, element, NAME, name);
    return [
      { from: element.from, to: element.from, insert: `<g ${NAME}="${name}">` },
      { from: element.to, to: element.to, insert: '</g>' },
    ];
  }

  unbind(bound: PictureBinding): void {
    this.#change([], this.bindings.filter((b) => !sameBinding(b, bound)));
  }

  /** Takes away that a hand turns a signal. */
  free(n: number, hand: number): void {
    const at = this.things[n]?.hands[hand];
    if (at) this.#change(withAttribute(this.text, at.element, at.attribute, null));
  }

  /** Gives a binding another value. */
  revalue(bound: PictureBinding, value: string): void {
    const at = this.bindings.findIndex((b) => sameBinding(b, bound));
    if (at >= 0 && value.trim() !== '' && value !== this.bindings[at]?.value) this.#change([], this.bindings.with(at, { ...bound, value: value.trim() }));
  }
}
