// The moving marks of a run, in a layer of their own: one path for each kind of mark, because
// changing a path costs the painter far less than moving nodes, and text nodes that are reused.
// Colour is never the only sign: an active step has a thick frame and a token, an enabled
// transition a thick bar, an enabled transition with a true receptivity a bar with an arrow head, a
// forced variable a dashed frame and a lock.
import type { Live } from '../lib/live.svelte';
import type { Box, Item } from '../lib/protocol';
import type { Scene } from './scene';

const SVG = 'http://www.w3.org/2000/svg';

/** The kinds of marks, in the order of painting; behind them the window in which they are drawn, which shows
 * nothing: a layer whose size does not change with its marks costs the browser a fifth less. */
const KINDS = ['window', 'lit', 'flash', 'other', 'on', 'token', 'enabled', 'holds', 'hatch', 'lock', 'break', 'stop', 'far-enabled', 'far-on'] as const;
type Kind = (typeof KINDS)[number];

/** The texts of one kind: as many nodes as were ever visible at once. */
class Texts {
  #made: SVGTextElement[] = [];
  #used = 0;
  #was = 0;
  constructor(
    readonly parent: SVGGElement,
    readonly name: string,
  ) {}

  begin(): void {
    this.#was = this.#used;
    this.#used = 0;
  }

  put(x: number, y: number, text: string): void {
    let node = this.#made[this.#used++];
    if (!node) {
      node = document.createElementNS(SVG, 'text');
      node.setAttribute('class', this.name);
      node.append('');
      this.parent.append(node);
      this.#made.push(node);
    }
    set(node, 'x', String(x));
    set(node, 'y', String(y));
    const inside = node.firstChild as Text;
    if (inside.data !== text) inside.data = text;
  }

  /** Empties the texts that are not needed now. */
  end(): void {
    for (let i = this.#used; i < this.#was; i++) (this.#made[i]?.firstChild as Text).data = '';
  }
}

export class LiveLayer {
  #paths = new Map<Kind, SVGPathElement>();
  #was = new Map<Kind, string>();
  #times: Texts;
  #others: Texts;
  #values: Texts;

  constructor(root: SVGGElement) {
    for (const kind of KINDS) {
      const path = document.createElementNS(SVG, 'path');
      path.setAttribute('class', kind);
      root.append(path);
      this.#paths.set(kind, path);
    }
    this.#times = new Texts(root, 'time');
    this.#others = new Texts(root, 'time other');
    this.#values = new Texts(root, 'value');
  }

  /** Draws the marks within a window of the plane. */
  show(scene: Scene, live: Live, window: [number, number, number, number], far: boolean): void {
    const drawn = new Map<Kind, string>();
    if (live.running) drawn.set('window', rect([window[0], window[1], window[2] - window[0], window[3] - window[1]], 0));
    for (const texts of [this.#times, this.#others, this.#values]) texts.begin();
    if (far) farMarks(scene, live, drawn);
    else this.#near(scene, live, window, drawn);
    for (const texts of [this.#times, this.#others, this.#values]) texts.end();
    for (const [kind, path] of this.#paths) {
      const now = drawn.get(kind) ?? '';
      if (now === (this.#was.get(kind) ?? '')) continue;
      this.#was.set(kind, now);
      path.setAttribute('d', now);
    }
  }

  #near(scene: Scene, live: Live, [x, y, right, low]: [number, number, number, number], drawn: Map<Kind, string>): void {
    const add = (kind: Kind, path: string) => drawn.set(kind, (drawn.get(kind) ?? '') + path);
    const sight = (id: string): Item | null => {
      const item = scene.byId.get(id);
      if (!item) return null;
      const [ax, ay, w, h] = item.area;
      return ax > right || ay > low || ax + w < x || ay + h < y ? null : item;
    };
    for (const id of live.lit) {
      const item = sight(id);
      if (item) add('lit', rect(scene.rectangle(item), 0));
    }
    for (const id of live.on) {
      const square = sight(id)?.square;
      if (!square) continue;
      add('on', rect(square, 0));
      add('token', circle(square[0] + square[2] / 2, scene.tokenAt(id), 5));
      const time = live.times.get(id);
      if (time) this.#times.put(...above(square), time);
    }
    for (const id of live.others) {
      const square = sight(id)?.square;
      if (!square) continue;
      add('other', rect(square, 4));
      this.#others.put(...above(square), live.otherName);
    }
    for (const [id, how] of live.enabled) {
      const bar = how > 0 ? sight(id)?.bar : undefined;
      if (!bar) continue;
      const middle = bar[1] + bar[3] / 2;
      add(how === 2 ? 'holds' : 'enabled', rect([bar[0], middle - 4, bar[2], 8], 0));
      if (how === 2) add('holds', `M${bar[0] - 3} ${middle}l-9 -6v12z`);
    }
    for (const id of live.cleared) {
      const bar = sight(id)?.bar;
      if (bar) add('flash', rect(bar, 6));
    }
    for (const [id, text] of live.values) {
      const item = sight(id);
      // Below a receptivity, where no neighbour stands; beside any other symbol.
      if (item?.text) this.#values.put(item.text[0], item.text[1] + item.text[3] + 12, text);
      else if (item) {
        const [bx, by, w, h] = scene.rectangle(item);
        this.#values.put(bx + w + 6, by + h / 2 + 4, text);
      }
    }
    for (const id of live.forced) {
      const area = sight(id)?.area;
      if (!area) continue;
      add('hatch', rect(area, 2));
      add('lock', lock(area[0] + area[2] - 4, area[1] - 7));
    }
    for (const id of live.breaks) {
      const item = sight(id);
      if (!item) continue;
      const core = scene.core(item);
      add('break', circle(core[0] - 10, core[1] + core[3] / 2, 5));
    }
    const stopped = live.stopped ? sight(live.stopped) : null;
    if (stopped) add('stop', rect(scene.core(stopped), 9));
  }
}

function farMarks(scene: Scene, live: Live, drawn: Map<Kind, string>): void {
  let on = '';
  for (const id of live.on) {
    const square = scene.byId.get(id)?.square;
    if (square) on += rect(square, 8);
  }
  let enabled = '';
  for (const [id, how] of live.enabled) {
    const bar = how > 0 ? scene.byId.get(id)?.bar : undefined;
    if (bar) enabled += rect(bar, 3);
  }
  drawn.set('far-on', on);
  drawn.set('far-enabled', enabled);
}

/** Where a text above a square ends: to the left of the link, because lines beside the link go up
 * and down. */
function above(square: Box): [x: number, y: number] {
  return [square[0] + square[2] / 2 - 5, square[1] - 4];
}

function set(node: Element, name: string, value: string): void {
  if (node.getAttribute(name) !== value) node.setAttribute(name, value);
}

function rect([x, y, w, h]: Box, wider: number): string {
  const [width, height] = [w + 2 * wider, h + 2 * wider];
  return `M${x - wider} ${y - wider}h${width}v${height}h${-width}z`;
}

function circle(x: number, y: number, r: number): string {
  return `M${x - r} ${y}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0z`;
}

function lock(x: number, y: number): string {
  return `M${x} ${y + 5}h9v7h-9zM${x + 2} ${y + 5}v-2a2.5 2.5 0 0 1 5 0v2`;
}
