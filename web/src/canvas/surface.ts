// The still picture: symbols in blocks of the plane; only visible blocks are in the document.
// Painting dominates the cost, so panning moves one layer, and in a zoomed-out view each block is
// one path without texts.
import type { Item } from '../lib/protocol';
import type { Scene } from './scene';

const SVG = 'http://www.w3.org/2000/svg';
/** Side of a block, in px at 100 %. */
const BLOCK = 640;
/** Below this zoom texts cannot be read and are left out. */
export const FAR = 0.3;

interface Block {
  x: number;
  y: number;
  right: number;
  low: number;
  items: Item[];
  near: string | null;
  far: string | null;
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
  #long: SVGGElement;
  #blocks = new Map<string, Block>();
  #name: Namer;

  constructor(root: SVGGElement, name: Namer) {
    this.root = root;
    this.#name = name;
    this.#long = group();
    root.append(this.#long);
  }

  /** Shows another drawing; blocks that look the same keep their nodes. */
  set(scene: Scene, again = false): void {
    const old = this.#blocks;
    this.#blocks = new Map();
    for (const item of scene.items) this.#put(item);
    for (const [key, block] of this.#blocks) {
      const was = old.get(key);
      if (!was?.node || again) continue;
      const same = was.shown === 'near' ? was.near === this.#near(block) : was.far === this.#far(block);
      if (!same) continue;
      block.node = was.node;
      block.shown = was.shown;
      was.node = null;
    }
    for (const was of old.values()) was.node?.remove();
  }

  #put(item: Item): void {
    const [x, y, w, h] = item.area;
    const long = Math.max(w, h) > BLOCK * 1.5;
    const key = long ? `l ${item.id}` : `${Math.floor(x / BLOCK)} ${Math.floor(y / BLOCK)}`;
    const block = this.#blocks.get(key);
    if (!block) {
      const made: Block = { x, y, right: x + w, low: y + h, items: [item], near: null, far: null, node: null, shown: null };
      this.#blocks.set(key, made);
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
    for (const [key, b] of this.#blocks) {
      const beyond = Math.max(x - b.right, b.x - right, y - b.low, b.y - low);
      if (b.shown === want ? beyond <= leave : beyond <= enter) {
        if (b.shown !== want) this.#draw(key, b, want);
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

  #draw(key: string, block: Block, how: 'near' | 'far'): void {
    block.node?.remove();
    const node = how === 'near' ? group() : (document.createElementNS(SVG, 'path') as SVGElement);
    if (how === 'near') node.innerHTML = this.#near(block);
    else {
      node.setAttribute('class', 'far');
      node.setAttribute('d', this.#far(block));
    }
    block.node = node;
    block.shown = how;
    (key.startsWith('l ') ? this.#long : this.root).append(node);
  }

  #near(block: Block): string {
    block.near ??= block.items.map((item) => this.#item(item)).join('');
    return block.near;
  }

  #far(block: Block): string {
    block.far ??= block.items.map((item) => item.far).join('');
    return block.far;
  }

  #item(item: Item): string {
    const id = escaped(item.id);
    if (item.part === 'link' || item.part === 'text') return `<g data-id="${id}">${item.svg}</g>`;
    return `<g data-id="${id}" id="${escaped(domId(item.id))}" role="img" aria-label="${escaped(this.#name(item))}">${item.svg}</g>`;
  }
}

function group(): SVGGElement {
  return document.createElementNS(SVG, 'g');
}
