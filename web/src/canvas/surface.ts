// The still picture: symbols in blocks of the plane; only visible blocks are in the document.
// Painting dominates the cost, so panning moves one layer, and in a zoomed-out view each block is
// one path without texts.
//
// The symbols of a block stand in one cell of the grid by the place where their SVG shows them, and are all shifted
// from there by the same vector. So where symbols only move, the block gets another transformation and keeps its nodes:
// a text that is made anew is set anew, which costs more than all else. A transformation of each symbol would cost
// every move of the view.
import { escaped } from '../lib/escape';
import { placing, type Placed as Item } from '../lib/redrawn';
import type { Scene } from './scene';

const SVG = 'http://www.w3.org/2000/svg';
/** Side of a block, in px at 100 %. */
const BLOCK = 640;
/** Round the view, in px of the screen: the blocks that are drawn with it, those drawn in advance once the view has stood
 * still for `PAUSE` ms, and those that stay in the document. */
const ROUND = 20;
const ADVANCE = 300;
const LEAVE = 900;
const PAUSE = 150;
/** Below this zoom texts cannot be read and are left out. */
export const FAR = 0.3;

/** The layers of blocks, from below: what is longer than some blocks, other links, symbols over them. */
const LAYERS = ['long', 'links', 'symbols'] as const;
type Layer = (typeof LAYERS)[number];

interface Block {
  layer: Layer;
  x: number;
  y: number;
  right: number;
  low: number;
  items: Item[];
  /** What screen readers say of the symbols, while they are in the document. */
  names: string[];
  node: SVGElement | null;
  shown: 'near' | 'far' | null;
}

/** The text for a screen reader that describes a symbol. */
export type Namer = (item: Item) => string;

export function domId(id: string): string {
  return `i:${id.replace(/\s/g, '%20')}`;
}

export class Surface {
  readonly root: SVGGElement;
  #layers: Record<Layer, SVGGElement>;
  /** The blocks of each cell and layer. */
  #cells = new Map<number, Block[]>();
  #name: Namer;
  #pause = 0;

  constructor(root: SVGGElement, name: Namer) {
    this.root = root;
    this.#name = name;
    this.#layers = { long: group(), links: group(), symbols: group() };
    root.append(...LAYERS.map((layer) => this.#layers[layer]));
  }

  /** Shows another drawing; symbols that look the same keep their nodes, unless they have left their block. */
  set(scene: Scene, again = false): void {
    const old = this.#cells;
    this.#cells = new Map();
    for (const item of scene.items) this.#put(item);
    for (const [cell, were] of old) {
      const blocks = again ? [] : (this.#cells.get(cell) ?? []);
      const rest: Block[] = [];
      for (const was of were) {
        if (!was.node) continue;
        const block = blocks.find((block) => !block.node && alike(was, block));
        if (block) this.#keep(was, block);
        else rest.push(was);
      }
      for (const was of rest) {
        const block = was.shown === 'near' ? nearest(was, blocks) : null;
        if (block) this.#mend(was, block);
        else was.node?.remove();
      }
    }
  }

  /** Gives the nodes of a block to the block that looks like it. */
  #keep(was: Block, block: Block): void {
    take(was, block);
    block.names = was.names;
    if (block.shown !== 'near') return;
    // The list of children is slow, and in most blocks nothing is named anew.
    let children: Element[] | undefined;
    block.items.forEach((item, n) => {
      if (was.items[n] === item) return;
      children ??= [...(block.node?.children ?? [])];
      this.#rename(children[n] as Element, was.items[n] as Item, block, n);
    });
  }

  /** Gives the nodes of a block to one that has many of its symbols; the others are taken out and put in. */
  #mend(was: Block, block: Block): void {
    const node = was.node as SVGElement;
    const children = [...node.children];
    take(was, block);
    let at = 0;
    block.items.forEach((item, n) => {
      const found = was.items.findIndex((old, k) => k >= at && same(old, item));
      if (found < 0) {
        const made = group();
        block.names[n] = spoken(item) ? this.#name(item) : '';
        made.innerHTML = near(item, block.names[n] as string);
        node.insertBefore(made.firstElementChild as Element, children[at] ?? null);
        return;
      }
      for (; at < found; at++) children[at]?.remove();
      block.names[n] = was.names[found] as string;
      this.#rename(children[at++] as Element, was.items[found] as Item, block, n);
    });
    for (; at < children.length; at++) children[at]?.remove();
  }

  /** Names the drawn symbols anew: their names depend on the run, and that of a step on its actions. */
  speak(): void {
    for (const blocks of this.#cells.values()) {
      for (const block of blocks) {
        if (block.shown === 'near') block.items.forEach((item, n) => this.#say(block, item, n));
      }
    }
  }

  #say(block: Block, item: Item, n: number): void {
    if (!spoken(item)) return;
    const name = this.#name(item);
    if (name === block.names[n]) return;
    block.node?.children[n]?.setAttribute('aria-label', name);
    block.names[n] = name;
  }

  /** Brings the names of a node up to date, which showed another symbol. */
  #rename(child: Element, old: Item, block: Block, n: number): void {
    const item = block.items[n] as Item;
    if (old.id !== item.id) {
      child.setAttribute('data-id', item.id);
      if (spoken(item)) child.id = domId(item.id);
    }
    if (!spoken(item)) return;
    const name = this.#name(item);
    if (name === block.names[n]) return;
    child.setAttribute('aria-label', name);
    block.names[n] = name;
  }

  #put(item: Item): void {
    const [x, y, w, h] = item.area;
    const [dx, dy] = item.shift ?? [0, 0];
    const layer = Math.max(w, h) > BLOCK * 1.5 ? 'long' : item.part === 'link' || item.part === 'text' ? 'links' : 'symbols';
    const cell = cellOf(layer, x - dx, y - dy);
    let blocks = this.#cells.get(cell);
    if (!blocks) this.#cells.set(cell, (blocks = []));
    const block = blocks.find(({ items: [first] }) => (first?.shift?.[0] ?? 0) === dx && (first?.shift?.[1] ?? 0) === dy);
    if (!block) {
      blocks.push({ layer, x, y, right: x + w, low: y + h, items: [item], names: [], node: null, shown: null });
      return;
    }
    block.x = Math.min(block.x, x);
    block.y = Math.min(block.y, y);
    block.right = Math.max(block.right, x + w);
    block.low = Math.max(block.low, y + h);
    block.items.push(item);
  }

  /** Shows a window of the plane; `k` is the zoom. What stands round it is drawn when the view stands still. */
  show(x: number, y: number, right: number, low: number, k: number): void {
    clearTimeout(this.#pause);
    if (this.#show(x, y, right, low, k, ROUND)) this.#pause = window.setTimeout(() => this.#show(x, y, right, low, k, ADVANCE), PAUSE);
  }

  /** Draws the blocks within some px of the window; true if there is something to be drawn in advance. */
  #show(x: number, y: number, right: number, low: number, k: number, round: number): boolean {
    const want = k < FAR ? 'far' : 'near';
    let more = false;
    for (const blocks of this.#cells.values()) {
      for (const b of blocks) {
        const beyond = Math.max(x - b.right, b.x - right, y - b.low, b.y - low) * k;
        if (b.shown === want ? beyond <= LEAVE : beyond <= round) {
          if (b.shown !== want) this.#draw(b, want);
        } else {
          more ||= beyond <= ADVANCE;
          if (!b.node) continue;
          b.node.remove();
          b.node = null;
          b.shown = null;
        }
      }
    }
    return more;
  }

  drop(): void {
    clearTimeout(this.#pause);
  }

  /** The node of a symbol, if it is in the document. */
  node(id: string): SVGElement | null {
    return this.root.querySelector(`[data-id="${CSS.escape(id)}"]`);
  }

  #draw(block: Block, how: 'near' | 'far'): void {
    block.node?.remove();
    const node = how === 'near' ? group() : (document.createElementNS(SVG, 'path') as SVGElement);
    if (how === 'near') {
      block.names = block.items.map((item) => (spoken(item) ? this.#name(item) : ''));
      node.innerHTML = block.items.map((item, n) => near(item, block.names[n] as string)).join('');
    } else {
      node.setAttribute('class', 'far');
      node.setAttribute('d', block.items.map((item) => item.far).join(''));
    }
    place(node, placing(block.items[0] as Item));
    block.node = node;
    block.shown = how;
    this.#layers[block.layer].append(node);
  }
}

/** A number for the cell of a layer in which a place lies. The long layer has small cells. */
function cellOf(layer: Layer, x: number, y: number): number {
  const side = layer === 'long' ? 1 : BLOCK;
  return (Math.floor(y / side) * 2 ** 24 + Math.floor(x / side)) * LAYERS.length + LAYERS.indexOf(layer);
}

/** True if screen readers name a symbol. */
export const spoken = (item: Item): boolean => item.part !== 'link' && item.part !== 'text';

function near(item: Item, name: string): string {
  const id = escaped(item.id);
  if (!spoken(item)) return `<g data-id="${id}">${item.svg}</g>`;
  return `<g data-id="${id}" id="${escaped(domId(item.id))}" role="img" aria-label="${escaped(name)}">${item.svg}</g>`;
}

/** True if two symbols look the same, wherever they stand. */
const same = (was: Item, item: Item): boolean => item.svg === was.svg && item.far === was.far && spoken(item) === spoken(was);

/** True if the symbols of two blocks look the same. */
const alike = ({ items: was }: Block, { items }: Block): boolean =>
  was.length === items.length && items.every((item, n) => same(was[n] as Item, item));

/** The block without nodes that has most symbols of another one, if these are at least half of its own. */
function nearest(was: Block, blocks: Block[]): Block | null {
  const looks = new Set(was.items.map((item) => item.svg));
  let best: Block | null = null;
  let most = 0;
  for (const block of blocks) {
    if (block.node) continue;
    const count = block.items.filter((item) => looks.has(item.svg)).length;
    if (count > most && count * 2 >= block.items.length) [best, most] = [block, count];
  }
  return best;
}

/** Gives the node of a block to another one. */
function take(was: Block, block: Block): void {
  const node = was.node as SVGElement;
  block.node = node;
  block.shown = was.shown;
  const [before, after] = [placing(was.items[0] as Item), placing(block.items[0] as Item)];
  if (before !== after) place(node, after);
}

function place(node: SVGElement, how: string | undefined): void {
  if (how === undefined) node.removeAttribute('transform');
  else node.setAttribute('transform', how);
}

function group(): SVGGElement {
  return document.createElementNS(SVG, 'g');
}
