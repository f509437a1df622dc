// A drawing prepared for queries: symbols by id, which symbol follows which, which lies where. It
// knows geometry only.
import { actionOf, titleOf } from '../lib/ids';
import type { Box } from '../lib/protocol';
import type { Drawing, Placed as Item } from '../lib/redrawn';

export type Point = [x: number, y: number];

const RANK: Record<Item['part'], number> = { action: 0, step: 1, transition: 2, connector: 3, comment: 3.5, title: 3.6, link: 4, text: 5 };

export class Scene {
  readonly drawing: Drawing;
  readonly items: Item[];
  readonly byId = new Map<string, Item>();
  /** For each step its actions. */
  readonly actions = new Map<string, Item[]>();
  #joined: { after: Map<string, string[]>; before: Map<string, string[]> } | null = null;
  #lines = new Map<string, Point[]>();
  #rectangles = new Map<string, Box>();
  #tokens = new Map<string, number>();

  constructor(drawing: Drawing) {
    this.drawing = drawing;
    this.items = drawing.items;
    for (const item of this.items) {
      this.byId.set(item.id, item);
      const of = item.part === 'action' ? actionOf(item.id) : null;
      if (!of) continue;
      const known = this.actions.get(of.step);
      if (known) known.push(item);
      else this.actions.set(of.step, [item]);
    }
  }

  /** For each step or transition the ids of its followers. */
  get after(): ReadonlyMap<string, string[]> {
    return this.#neighbours().after;
  }

  get before(): ReadonlyMap<string, string[]> {
    return this.#neighbours().before;
  }

  /** Who follows whom; most scenes are not asked for it. */
  #neighbours(): { after: Map<string, string[]>; before: Map<string, string[]> } {
    if (this.#joined) return this.#joined;
    const joined = { after: new Map<string, string[]>(), before: new Map<string, string[]>() };
    const put = (side: Map<string, string[]>, a: string, b: string) => {
      const known = side.get(a);
      if (!known) side.set(a, [b]);
      else if (!known.includes(b)) known.push(b);
    };
    for (const { ends } of this.items) {
      if (!ends) continue;
      put(joined.after, ends[0], ends[1]);
      put(joined.before, ends[1], ends[0]);
    }
    const x = (id: string) => this.byId.get(id)?.at?.[0] ?? 0;
    for (const side of [joined.after, joined.before]) side.forEach((ids) => ids.length > 1 && ids.sort((a, b) => x(a) - x(b)));
    return (this.#joined = joined);
  }

  /** Where the origin of the chart of a symbol is; on a sheet of several charts each has a place. */
  origin(id: string): Point {
    return this.byId.get(titleOf(id))?.at ?? [0, 0];
  }

  /** All symbols of the chart with this title. */
  ofTitle(title: string): string[] {
    return this.items.filter((i) => titleOf(i.id) === title).map((i) => i.id);
  }

  /** The given symbols, and the transitions that are linked to no other steps: a drag moves them
   * together. */
  withNeighbours(ids: ReadonlySet<string>): Set<string> {
    const all = new Set(ids);
    const y = (id: string) => this.byId.get(id)?.at?.[1] ?? 0;
    const among = (steps: string[] | undefined) => steps?.every((s) => ids.has(s)) ?? false;
    for (const link of this.items) {
      const [from, to] = link.part === 'link' && link.ends ? link.ends : ['', ''];
      // A link that runs back upward does not make its ends neighbours.
      if (y(from) >= y(to)) continue;
      if (ids.has(from) && this.byId.get(to)?.part === 'transition' && among(this.before.get(to))) all.add(to);
      if (ids.has(to) && this.byId.get(from)?.part === 'transition' && among(this.after.get(from))) all.add(from);
    }
    return all;
  }

  /** The box of a symbol without its texts. */
  core(item: Item): Box {
    return item.square ?? item.bar ?? item.area;
  }

  /** The rectangle of an action without its line to the step. */
  rectangle(action: Item): Box {
    const known = this.#rectangles.get(action.id);
    if (known) return known;
    const found = /class="g7-action" x="([-\d.]+)" y="([-\d.]+)" width="([\d.]+)" height="([\d.]+)"/.exec(action.svg);
    const cut = found ? null : /class="g7-action" d="([^"]+)"/.exec(action.svg)?.[1];
    const box: Box | null = found ? [Number(found[1]), Number(found[2]), Number(found[3]), Number(found[4])] : cut ? round(corners(cut)) : null;
    const [dx, dy] = action.shift ?? [0, 0];
    const placed: Box = box ? [box[0] + dx, box[1] + dy, box[2], box[3]] : action.area;
    this.#rectangles.set(action.id, placed);
    return placed;
  }

  /** The height of the token in a step: below the name, or on the lower edge if the name has two
   * lines. */
  tokenAt(id: string): number {
    const known = this.#tokens.get(id);
    if (known !== undefined) return known;
    const item = this.byId.get(id);
    const [, y = 0, , h = 0] = item?.square ?? [];
    const lines = item?.svg.split('class="g7-name"').length ?? 0;
    const at = y + h - (lines > 2 ? 0 : 11);
    this.#tokens.set(id, at);
    return at;
  }

  /** The outline of a symbol; for an action without its line to the step. */
  outline(item: Item): Box {
    return item.part === 'action' ? this.rectangle(item) : item.area;
  }

  /** The symbol at a place; `reach` is the distance that still counts. */
  hit(x: number, y: number, reach: number): Item | null {
    let best: Item | null = null;
    let bestAt = Infinity;
    for (const item of this.items) {
      if (item.part === 'text') continue;
      const [ax, ay, w, h] = item.area;
      if (x < ax - reach || y < ay - reach || x > ax + w + reach || y > ay + h + reach) continue;
      const away = item.part === 'link' ? this.distance(item, x, y) : outside(item.area, x, y);
      if (away > reach) continue;
      const at = RANK[item.part] + (away > 0 ? 2.5 : 0) + away / (reach + 1);
      if (at < bestAt) {
        best = item;
        bestAt = at;
      }
    }
    return best;
  }

  /** The link nearest to a place, within reach. */
  linkAt(x: number, y: number, reach: number): Item | null {
    let best: Item | null = null;
    let least = reach;
    for (const item of this.items) {
      if (item.part !== 'link') continue;
      const away = this.distance(item, x, y);
      if (away < least) {
        best = item;
        least = away;
      }
    }
    return best;
  }

  /** The step or transition without a follower whose lower end is nearest, within reach. */
  endAt(x: number, y: number, reach: number): Item | null {
    let best: Item | null = null;
    let least = reach;
    for (const item of this.items) {
      if (item.part !== 'step' && item.part !== 'transition') continue;
      if ((this.after.get(item.id)?.length ?? 0) > 0) continue;
      const [bx, by, w, h] = this.core(item);
      const away = Math.hypot(x - (bx + w / 2), y - (by + h + 12));
      if (away < least) {
        best = item;
        least = away;
      }
    }
    return best;
  }

  within(box: Box): Item[] {
    const [x, y, w, h] = box;
    return this.items.filter((item) => {
      if (item.part === 'link' || item.part === 'connector' || item.part === 'text') return false;
      const [bx, by, bw, bh] = this.core(item);
      return bx >= x && by >= y && bx + bw <= x + w && by + bh <= y + h;
    });
  }

  distance(link: Item, x: number, y: number): number {
    const line = this.line(link);
    let least = Infinity;
    for (let i = 1; i < line.length; i++) {
      least = Math.min(least, toSegment(x, y, line[i - 1] as Point, line[i] as Point));
    }
    return least;
  }

  /** The corners of a link. */
  line(link: Item): Point[] {
    const known = this.#lines.get(link.id);
    if (known) return known;
    const [dx, dy] = link.shift ?? [0, 0];
    const line = corners(link.far).map(([x, y]): Point => [x + dx, y + dy]);
    this.#lines.set(link.id, line);
    return line;
  }

  /** The next symbol in a direction: up and down along links, left and right the nearest one. */
  towards(id: string, way: 'up' | 'down' | 'left' | 'right'): string | null {
    const item = this.byId.get(id);
    if (!item) return null;
    if (item.part === 'link' && (way === 'up' || way === 'down')) return item.ends?.[way === 'up' ? 0 : 1] ?? null;
    const of = actionOf(id);
    if (of && (way === 'up' || way === 'down')) {
      const next = this.actions.get(of.step)?.[of.index + (way === 'down' ? 1 : -1)];
      return next ? next.id : this.towards(of.step, way);
    }
    if (of && way === 'left') return of.step;
    if (way === 'down') return this.after.get(id)?.[0] ?? null;
    if (way === 'up') return this.before.get(id)?.[0] ?? null;
    if (way === 'right' && item.part === 'step') {
      const action = this.actions.get(id)?.[0];
      if (action) return action.id;
    }
    return this.#beside(item, way);
  }

  #beside(item: Item, way: 'left' | 'right'): string | null {
    const [x, y] = middle(this.core(item));
    let best: string | null = null;
    let least = Infinity;
    for (const other of this.items) {
      if (other.part !== 'step' && other.part !== 'transition') continue;
      const [ox, oy] = middle(this.core(other));
      const dx = way === 'right' ? ox - x : x - ox;
      if (dx < 20) continue;
      const away = dx + Math.abs(oy - y) * 3;
      if (away < least) {
        least = away;
        best = other.id;
      }
    }
    return best;
  }

  /** The box of the step where the chart begins. */
  first(): Box {
    const rank = (step: Item) => (step.initial ? 0 : step.step === 'entry' ? 1 : 2);
    let begin: Item | null = null;
    for (const item of this.items) {
      if (item.part !== 'step') continue;
      if (!begin || (rank(item) - rank(begin) || reading(item, begin)) < 0) begin = item;
    }
    return begin ? this.core(begin) : [0, 0, 0, 0];
  }

  /** Steps and transitions in reading order: from top to bottom, from left to right. */
  ordered(): Item[] {
    return this.items
      .filter((i) => i.part === 'step' || i.part === 'transition')
      .sort(reading);
  }
}

/** Compares symbols in reading order. */
const reading = (a: Item, b: Item): number => (a.at?.[1] ?? 0) - (b.at?.[1] ?? 0) || (a.at?.[0] ?? 0) - (b.at?.[0] ?? 0);

export function middle([x, y, w, h]: Box): Point {
  return [x + w / 2, y + h / 2];
}

export function union(boxes: Box[]): Box | null {
  if (boxes.length === 0) return null;
  const x = Math.min(...boxes.map((b) => b[0]));
  const y = Math.min(...boxes.map((b) => b[1]));
  const right = Math.max(...boxes.map((b) => b[0] + b[2]));
  const low = Math.max(...boxes.map((b) => b[1] + b[3]));
  return [x, y, right - x, low - y];
}

/** The smallest box round some points. */
function round(points: Point[]): Box {
  const [x, y] = [Math.min(...points.map((p) => p[0])), Math.min(...points.map((p) => p[1]))];
  return [x, y, Math.max(...points.map((p) => p[0])) - x, Math.max(...points.map((p) => p[1])) - y];
}

function outside([x, y, w, h]: Box, px: number, py: number): number {
  return Math.hypot(Math.max(x - px, 0, px - x - w), Math.max(y - py, 0, py - y - h));
}

function toSegment(x: number, y: number, [ax, ay]: Point, [bx, by]: Point): number {
  const [dx, dy] = [bx - ax, by - ay];
  const length = dx * dx + dy * dy;
  const t = length === 0 ? 0 : Math.max(0, Math.min(1, ((x - ax) * dx + (y - ay) * dy) / length));
  return Math.hypot(x - ax - t * dx, y - ay - t * dy);
}

/** The corners of the first open line in path data made of M, L, H and V. */
function corners(path: string): Point[] {
  const found: Point[] = [];
  let [x, y] = [0, 0];
  for (const [, letter, numbers] of path.matchAll(/([MLHVZ])([^MLHVZ]*)/g)) {
    if (letter === 'M' && found.length > 0) break;
    const [a = 0, b = 0] = (numbers ?? '').trim().split(/[ ,]+/).map(Number);
    if (letter === 'H') x = a;
    else if (letter === 'V') y = a;
    else if (letter !== 'Z') [x, y] = [a, b];
    found.push([x, y]);
  }
  return found;
}
