// The moving marks of a run, in a layer of their own made of nodes that are kept
// and used again. Colour is never the only sign: active has a thick frame and a
// token, enabled a thick bar, enabled and true a filled mark, forced a lock.
import type { Live } from '../lib/live.svelte';
import type { Box, Item } from '../lib/protocol';
import type { Scene } from './scene';

const SVG = 'http://www.w3.org/2000/svg';

/** Nodes of one kind: as many as were ever in sight at once. */
class Pool {
  #made: SVGElement[] = [];
  #used = 0;
  #was = 0;
  constructor(
    readonly parent: SVGGElement,
    readonly html: string,
  ) {}

  begin(): void {
    this.#was = this.#used;
    this.#used = 0;
  }

  next(): SVGElement {
    let node = this.#made[this.#used];
    if (!node) {
      node = document.createElementNS(SVG, 'g');
      node.innerHTML = this.html;
      this.parent.append(node);
      this.#made.push(node);
    } else if (this.#used >= this.#was) node.style.display = '';
    this.#used++;
    return node;
  }

  end(): void {
    for (let i = this.#used; i < this.#was; i++) (this.#made[i] as SVGElement).style.display = 'none';
  }
}

function place(node: SVGElement, x: number, y: number): void {
  const to = `translate(${x} ${y})`;
  if (node.getAttribute('transform') !== to) node.setAttribute('transform', to);
}

function write(node: Element | null, text: string): void {
  if (!node) return;
  const inside = node.firstChild as Text | null;
  if (!inside) node.textContent = text;
  else if (inside.data !== text) inside.data = text;
}

const LOCK = '<path class="lock" d="M0 5h9v7h-9zM2 5v-2a2.5 2.5 0 0 1 5 0v2"/>';

export class LiveLayer {
  #on: Pool;
  #enabled: Pool;
  #holds: Pool;
  #lit: Pool;
  #value: Pool;
  #forced: Pool;
  #break: Pool;
  #flash: Pool;
  #stop: Pool;
  #farOn: SVGPathElement;
  #farEnabled: SVGPathElement;

  constructor(root: SVGGElement) {
    const pool = (html: string) => {
      const g = document.createElementNS(SVG, 'g');
      root.append(g);
      return new Pool(g, html);
    };
    const path = (name: string) => {
      const p = document.createElementNS(SVG, 'path');
      p.setAttribute('class', name);
      root.append(p);
      return p;
    };
    this.#lit = pool('<rect class="lit"/>');
    this.#on = pool('<rect class="on"/><circle class="token" r="5"/><text class="time" text-anchor="middle"/>');
    this.#enabled = pool('<rect class="enabled"/>');
    this.#holds = pool('<rect class="holds"/><path class="holds-mark" d="M0 0l-9 -6v12z"/>');
    this.#flash = pool('<rect class="flash"/>');
    this.#value = pool('<text class="value"/>');
    this.#forced = pool(`<rect class="hatch"/><g>${LOCK}</g>`);
    this.#break = pool('<circle class="break" r="5"/>');
    this.#stop = pool('<rect class="stop" rx="4"/>');
    this.#farEnabled = path('far-enabled');
    this.#farOn = path('far-on');
  }

  /** Draws the marks within a window of the plane. */
  show(scene: Scene, live: Live, window: [number, number, number, number], far: boolean): void {
    const pools = [this.#on, this.#enabled, this.#holds, this.#lit, this.#value, this.#forced, this.#break, this.#flash, this.#stop];
    pools.forEach((p) => p.begin());
    if (far) this.#far(scene, live);
    else {
      set(this.#farOn, 'd', '');
      set(this.#farEnabled, 'd', '');
      this.#near(scene, live, window);
    }
    pools.forEach((p) => p.end());
  }

  #far(scene: Scene, live: Live): void {
    let on = '';
    for (const id of live.on) {
      const b = scene.byId.get(id)?.square;
      if (b) on += `M${b[0] - 8} ${b[1] - 8}h${b[2] + 16}v${b[3] + 16}h-${b[2] + 16}z`;
    }
    let enabled = '';
    for (const id of live.enabled.keys()) {
      const b = scene.byId.get(id)?.bar;
      if (b) enabled += `M${b[0]} ${b[1] - 3}h${b[2]}v${b[3] + 6}h-${b[2]}z`;
    }
    set(this.#farOn, 'd', on);
    set(this.#farEnabled, 'd', enabled);
  }

  #near(scene: Scene, live: Live, [x, y, right, low]: [number, number, number, number]): void {
    const sight = (id: string): Item | null => {
      const item = scene.byId.get(id);
      if (!item) return null;
      const [ax, ay, w, h] = item.area;
      return ax > right || ay > low || ax + w < x || ay + h < y ? null : item;
    };
    for (const id of live.lit) {
      const item = sight(id);
      if (item) frame(this.#lit.next(), item.area, 0);
    }
    for (const id of live.on) {
      const item = sight(id);
      if (item?.square) this.#step(item.square, live.times.get(id) ?? '');
    }
    for (const [id, how] of live.enabled) {
      const item = how > 0 ? sight(id) : null;
      if (!item?.bar) continue;
      const [bx, by, w, h] = item.bar;
      const node = (how === 2 ? this.#holds : this.#enabled).next();
      place(node, bx, by + h / 2);
      box(node.firstElementChild, [0, -4, w, 8]);
      if (how === 2) set(node.lastElementChild, 'transform', 'translate(-3 0)');
    }
    for (const id of live.cleared) {
      const item = sight(id);
      if (item?.bar) frame(this.#flash.next(), item.bar, 5);
    }
    for (const [id, text] of live.values) {
      const item = sight(id);
      if (!item) continue;
      const node = this.#value.next();
      const [bx, by, w, h] = item.area;
      place(node, bx + w + 6, by + h / 2 + 4);
      write(node.firstElementChild, text);
    }
    for (const id of live.forced) {
      const item = sight(id);
      if (!item) continue;
      const node = this.#forced.next();
      frame(node, item.area, 2);
      set(node.lastElementChild, 'transform', `translate(${item.area[2] - 4} -6)`);
    }
    for (const id of live.breaks) {
      const item = sight(id);
      if (item) place(this.#break.next(), scene.core(item)[0] - 9, scene.core(item)[1] + scene.core(item)[3] / 2);
    }
    const stopped = live.stopped ? sight(live.stopped) : null;
    if (stopped) frame(this.#stop.next(), scene.core(stopped), 9);
  }

  #step(square: Box, time: string): void {
    const node = this.#on.next();
    const [x, y, w, h] = square;
    place(node, x, y);
    const [rect, token, text] = node.children as unknown as [Element, Element, Element];
    box(rect, [0, 0, w, h]);
    set(token, 'cx', String(w / 2));
    set(token, 'cy', String(h - 11));
    set(text, 'x', String(w / 2));
    set(text, 'y', '13');
    write(text, time);
  }
}

function set(node: Element | null, name: string, value: string): void {
  if (node && node.getAttribute(name) !== value) node.setAttribute(name, value);
}

function box(node: Element | null, [x, y, w, h]: Box): void {
  set(node, 'x', String(x));
  set(node, 'y', String(y));
  set(node, 'width', String(w));
  set(node, 'height', String(h));
}

/** Puts a node with a rectangle round a box. */
function frame(node: SVGElement, [x, y, w, h]: Box, wider: number): void {
  place(node, x, y);
  box(node.firstElementChild, [-wider, -wider, w + 2 * wider, h + 2 * wider]);
}
