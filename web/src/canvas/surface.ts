// The still picture: symbols in blocks of the plane; only visible blocks are in the document.
// Painting dominates the cost, so panning moves one layer, and in a zoomed-out view each block is
// one path without texts.
//
// The symbols of a block stand in one cell of the grid by the place where their SVG shows them, and are all shifted
// from there by the same vector. So where symbols only move, the block gets another transformation and keeps its nodes:
// a text that is made anew is set anew, which costs more than all else. A transformation of each symbol would cost
// every move of the view.
import { placing, type Placed as Item } from '../lib/redrawn';
import type { Scene } from './scene';

const SVG = 'http://www.w3.org/2000/svg';
/** Side of a block, in px at 100 %. */
const BLOCK = 640;
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

const escaped = (text: string) =>
  text.replace(/[&<>"]/g, (c) => ({ '&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;' })[c] ?? c);

export class Surface {
  readonly root: SVGGElement;
  #layers: Record<Layer, SVGGElement>;
  /** The blocks of each cell and layer. */
  #cells = new Map<number, Block[]>();
  #name: Namer;

  constructor(root: SVGGElement, name: Namer) {
    this.root = root;
    this.#name = name;
    this.#layers = { long: group(), links: group(), symbols: group() };
    root.append(...LAYERS.map((layer) => this.#layers[layer]));
  }

  /** Shows another drawing; blocks whose symbols look the same keep their nodes. */
  set(scene: Scene, again = false): void {
    const old = this.#cells;
    this.#cells = new Map();
    for (const item of scene.items) this.#put(item);
    for (const [cell, were] of old) {
      const blocks = again ? [] : (this.#cells.get(cell) ?? []);
      for (const was of were) {
        if (!was.node) continue;
        const block = blocks.find((block) => !block.node && alike(was, block));
        if (block) this.#keep(was, block);
        else was.node.remove();
      }
    }
  }

  /** Gives the nodes of a block to the block that looks like it. */
  #keep(was: Block, block: Block): void {
    const node = was.node as SVGElement;
    block.node = node;
    block.shown = was.shown;
    block.names = was.names;
    const [before, after] = [placing(was.items[0] as Item), placing(block.items[0] as Item)];
    if (before !== after) place(node, after);
    if (block.shown !== 'near') return;
    block.items.forEach((item, n) => {
      const old = was.items[n] as Item;
      if (old === item) return;
      const child = node.children[n] as SVGElement;
      if (old.id !== item.id) {
        child.setAttribute('data-id', item.id);
        if (spoken(item)) child.id = domId(item.id);
      }
      if (!spoken(item)) return;
      const name = this.#name(item);
      if (name === block.names[n]) return;
      child.setAttribute('aria-label', name);
      block.names[n] = name;
    });
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

  /** Shows a window of the plane; `k` is the zoom. */
  show(x: number, y: number, right: number, low: number, k: number): void {
    const want = k < FAR ? 'far' : 'near';
    const [enter, leave] = [300 / k, 900 / k];
    for (const b of [...this.#cells.values()].flat()) {
      const beyond = Math.max(x - b.right, b.x - right, y - b.low, b.y - low);
      if (b.shown === want ? beyond <= leave : beyond <= enter) {
        if (b.shown !== want) this.#draw(b, want);
      } else if (b.node) {
        b.node.remove();
        b.node = null;
        b.shown = null;
      }
    }
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
const spoken = (item: Item): boolean => item.part !== 'link' && item.part !== 'text';

function near(item: Item, name: string): string {
  const id = escaped(item.id);
  if (!spoken(item)) return `<g data-id="${id}">${item.svg}</g>`;
  return `<g data-id="${id}" id="${escaped(domId(item.id))}" role="img" aria-label="${escaped(name)}">${item.svg}</g>`;
}

/** True if the symbols of two blocks look the same, wherever they stand. */
function alike({ items: was }: Block, { items }: Block): boolean {
  return was.length === items.length && items.every((item, n) => item.svg === was[n]?.svg && item.far === was[n]?.far && spoken(item) === spoken(was[n] as Item));
}

function place(node: SVGElement, how: string | undefined): void {
  if (how === undefined) node.removeAttribute('transform');
  else node.setAttribute('transform', how);
}

function group(): SVGGElement {
  return document.createElementNS(SVG, 'g');
}
