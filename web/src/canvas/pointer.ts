// The meaning of a press on the drawing: select, move, mark an area, draw a link. The camera moves
// the view itself.
import type { Placed as Item } from '../lib/redrawn';
import { actionOf, SHEET } from '../lib/ids';
import type { LinkEnd } from '../lib/protocol';
import { shell } from '../lib/shell.svelte';
import { bendsOf, moved, type Segment } from './bends';
import { editor } from './editor.svelte';
import type { Point } from './scene';

/** Movements smaller than this are clicks, in px; a finger is less steady than a mouse. */
const CLICK = 4;
const TAP = 10;
/** A finger that stays so long opens the menu, in ms. */
const LONG = 500;
/** So long after the finger is lifted its click may come, in ms. */
const LIFTED = 100;
/** Two taps within this time, in ms, and this distance, in px, are one double tap. */
const TWICE = 400;
const NEAR = 30;
/** So near to an edge of the sheet a drag moves the view, in px. */
const EDGE = 36;
/** How fast it does so at the edge itself, in px per ms. */
const FAST = 0.9;
/** Symbols move in steps of half a unit. */
const SNAP = 5;

type Doing =
  | { what: 'press'; item: Item | null; add: boolean }
  | { what: 'move'; ids: Set<string>; title?: Item }
  | { what: 'mark'; item: Item | null; add: boolean }
  | { what: 'link'; from: string }
  | { what: 'relink'; link: string; end: LinkEnd; part: Item['part'] }
  | { what: 'bend'; link: Item; line: Point[]; segment: Segment };

/** True if a symbol can be dragged; links only follow their symbols. */
function held(item: Item | null): boolean {
  // A chart that is opened beside another has its place from the step that opens it: it is not dragged.
  if (item?.part === 'title') return editor.chart === SHEET;
  return item !== null && ['step', 'transition', 'action', 'comment'].includes(item.part);
}

/** Keeps the click away that some browsers send when the finger is lifted: it would press the menu, which now lies under
 * the finger. It ends with that click or shortly after the finger, because the next one may come from a key. */
function loseClick(): void {
  const ended = new AbortController();
  const once = { capture: true, once: true, signal: ended.signal };
  const lost = (click: MouseEvent) => {
    // A click of a key counts no presses.
    if (click.detail > 0) click.stopPropagation();
    ended.abort();
  };
  window.addEventListener('click', lost, once);
  window.addEventListener('pointerdown', () => ended.abort(), once);
  for (const end of ['pointerup', 'pointercancel']) window.addEventListener(end, () => setTimeout(() => ended.abort(), LIFTED), once);
}

export class Pointer {
  #doing: Doing | null = null;
  #at = { x: 0, y: 0 };
  /** The pressed place of the plane, which stays when the view moves. */
  #from: [number, number] = [0, 0];
  /** The last place of the pointer while it drags near an edge, and when the view moved there. */
  #edge: { e: PointerEvent; at: number } | null = null;
  #place: (e: { clientX: number; clientY: number }) => [number, number];
  #root: HTMLElement;
  #touch = false;
  #long = 0;
  /** The last tap of a finger. */
  #tapped = { at: -Infinity, x: 0, y: 0 };
  #menu: (e: PointerEvent) => void;

  /** `menu` opens the menu at a place. */
  constructor(root: HTMLElement, menu: (e: PointerEvent) => void) {
    this.#root = root;
    this.#menu = menu;
    this.#place = (e) => {
      const box = root.getBoundingClientRect();
      return [e.clientX - box.left, e.clientY - box.top];
    };
  }

  /** The symbol at a place of the screen. */
  under(e: { clientX: number; clientY: number }): Item | null {
    const [x, y] = editor.toPlane(...this.#place(e));
    const reach = (this.#touch ? 14 : 6) / Math.min(editor.view.k, 1);
    return editor.scene?.hit(x, y, reach) ?? null;
  }

  /** True if the last press was one of a finger. */
  get fingers(): boolean {
    return this.#touch;
  }

  /** True if a drag moves a symbol. A finger moves selected ones alone, because it often meets a symbol where paper was
   * meant. */
  #moves(item: Item | null): boolean {
    if (!item || !held(item)) return false;
    return !this.#touch || shell.selection.has(item.id) || shell.selection.has(actionOf(item.id)?.step ?? '');
  }

  /** True for the second tap of a finger at one place. Not every browser tells of that as a double click. */
  twice(e: MouseEvent): boolean {
    if (!this.#touch) return false;
    const was = this.#tapped;
    const double = e.timeStamp - was.at < TWICE && Math.hypot(e.clientX - was.x, e.clientY - was.y) < NEAR;
    this.#tapped = { at: double ? -Infinity : e.timeStamp, x: e.clientX, y: e.clientY };
    return double;
  }

  /** True if a press moves the view: on the paper, or with the middle button. */
  mayPan = (e: MouseEvent | TouchEvent): boolean => {
    if ('touches' in e) {
      if (e.touches.length > 1) {
        this.stop();
        return true;
      }
      const touch = e.touches[0];
      return !!touch && !this.#moves(this.under(touch));
    }
    if (e.button === 1) return true;
    return e.button === 0 && !e.shiftKey && !held(this.under(e));
  };

  down(e: PointerEvent): void {
    this.#touch = e.pointerType === 'touch';
    editor.menu = null;
    // While the view is moved, the browser need not look for what is under the pointer.
    if (e.button === 1) this.#root.setPointerCapture(e.pointerId);
    if (e.button !== 0 || !e.isPrimary) return;
    const item = this.under(e);
    this.#press(e);
    const add = e.shiftKey || e.ctrlKey || e.metaKey;
    this.#doing = held(item) || !e.shiftKey ? { what: 'press', item, add } : { what: 'mark', item, add };
    if (this.#touch) this.#long = window.setTimeout(() => this.#stay(e), LONG);
  }

  /** A finger stays where it pressed. */
  #stay(e: PointerEvent): void {
    if (this.#doing?.what !== 'press') return;
    this.#doing = null;
    this.#menu(e);
    loseClick();
  }

  #press(e: PointerEvent): void {
    [this.#at.x, this.#at.y] = this.#place(e);
    this.#from = editor.toPlane(this.#at.x, this.#at.y);
  }

  /** Starts a link at a symbol. */
  link(e: PointerEvent, from: string): void {
    this.#press(e);
    this.#doing = { what: 'link', from };
    const [x, y] = this.#from;
    editor.linking = { from, x, y };
    this.#root.setPointerCapture(e.pointerId);
  }

  /** Takes an end of a link; the other one stays. */
  relink(e: PointerEvent, link: Item, end: LinkEnd): void {
    const [from, to] = link.ends ?? ['', ''];
    const [own, other] = end === 'from' ? [from, to] : [to, from];
    const part = editor.scene?.byId.get(own)?.part;
    if (!part) return;
    this.#press(e);
    this.#doing = { what: 'relink', link: link.id, end, part };
    const [x, y] = this.#from;
    editor.linking = { from: other, x, y, back: end === 'from' };
    this.#root.setPointerCapture(e.pointerId);
  }

  /** Takes a segment of a link. */
  bend(e: PointerEvent, link: Item, segment: Segment): void {
    const line = editor.scene?.line(link);
    if (!line) return;
    this.#press(e);
    this.#doing = { what: 'bend', link, line, segment };
    this.#root.setPointerCapture(e.pointerId);
  }

  move(e: PointerEvent): void {
    const doing = this.#doing;
    if (!doing) {
      if (e.buttons === 0) shell.hover = this.under(e)?.id ?? null;
      return;
    }
    const [x, y] = this.#place(e);
    const [dx, dy] = [x - this.#at.x, y - this.#at.y];
    if (doing.what === 'press') {
      if (Math.hypot(dx, dy) < (this.#touch ? TAP : CLICK)) return;
      clearTimeout(this.#long);
      if (!doing.item || !this.#grab(doing.item, doing.add, e.altKey)) {
        this.#doing = null;
        this.#root.setPointerCapture(e.pointerId);
        return;
      }
      this.#root.setPointerCapture(e.pointerId);
    }
    this.#drag(e);
    this.#atEdge(e);
  }

  /** Shows what is dragged at the place of the pointer. */
  #drag(e: PointerEvent): void {
    const now = this.#doing;
    const [px, py] = editor.toPlane(...this.#place(e));
    const [fx, fy] = this.#from;
    const snap = (n: number) => Math.round(n / SNAP) * SNAP;
    if (now?.what === 'move') {
      editor.moving = { ids: now.ids, dx: snap(px - fx), dy: snap(py - fy) };
    } else if (now?.what === 'bend') {
      editor.bending = moved(now.line, now.segment, snap(now.segment.upright ? px - fx : py - fy));
    } else if (now?.what === 'mark') {
      editor.marquee = [Math.min(px, fx), Math.min(py, fy), Math.abs(px - fx), Math.abs(py - fy)];
      this.#root.setPointerCapture(e.pointerId);
    } else if ((now?.what === 'link' || now?.what === 'relink') && editor.linking) {
      editor.linking = { ...editor.linking, x: px, y: py };
      const over = this.under(e);
      const fits = (item: Item) => (now.what === 'link' ? item.id !== now.from && (item.part === 'step' || item.part === 'transition') : item.part === now.part);
      editor.target = over && fits(over) ? over.id : null;
    }
  }

  /** Near an edge of the sheet the view goes on by itself, and what is dragged with it. */
  #atEdge(e: PointerEvent): void {
    const waiting = this.#edge !== null;
    this.#edge = { e, at: this.#edge?.at ?? performance.now() };
    if (!waiting) requestAnimationFrame(this.#onward);
  }

  #onward = (now: number): void => {
    const edge = this.#edge;
    this.#edge = null;
    if (!edge || !this.#doing || this.#doing.what === 'press') return;
    const speed = (at: number, size: number) => Math.max(0, Math.min(1, (EDGE - at) / EDGE)) - Math.max(0, Math.min(1, (EDGE - size + at) / EDGE));
    const [x, y] = this.#place(edge.e);
    const [right, down] = [speed(x, editor.width), speed(y, editor.height)];
    if (right === 0 && down === 0) return;
    const by = FAST * Math.max(0, Math.min(50, now - edge.at));
    editor.camera?.panBy(right * by, down * by);
    this.#drag(edge.e);
    this.#edge = { e: edge.e, at: now };
    requestAnimationFrame(this.#onward);
  };

  /** Starts dragging the selection or the pressed symbol; neighbours come along unless `alone` is
   * true. */
  #grab(item: Item, add: boolean, alone: boolean): boolean {
    if (!this.#moves(item)) return false;
    if (item.part === 'title') {
      shell.select([item.id]);
      this.#doing = { what: 'move', ids: new Set(editor.scene?.ofTitle(item.id)), title: item };
      return true;
    }
    const id = actionOf(item.id)?.step ?? item.id;
    if (!shell.selection.has(item.id) && !shell.selection.has(id)) {
      shell.select(add ? [...shell.selection, id] : [id]);
    }
    const parts = [...shell.selection].map((s) => actionOf(s)?.step ?? s);
    const ids = new Set(parts.filter((s) => ['step', 'transition', 'comment'].includes(editor.scene?.byId.get(s)?.part ?? '')));
    const taken = ids.size > 0 ? ids : new Set([id]);
    this.#doing = { what: 'move', ids: alone ? taken : (editor.scene?.withNeighbours(taken) ?? taken) };
    return true;
  }

  up(e: PointerEvent): void {
    const doing = this.#doing;
    this.#doing = null;
    clearTimeout(this.#long);
    if (!doing) return;
    if (doing.what === 'press') this.#click(doing.item, doing.add);
    else if (doing.what === 'move') void this.#drop(doing.ids, doing.title);
    else if (doing.what === 'mark') this.#mark(doing.item);
    else if (doing.what === 'bend') void this.#bent(doing.link, doing.line);
    else if (doing.what === 'relink') this.#take(doing.link, doing.end);
    else this.#join(doing.from, e);
  }

  stop(): void {
    this.#doing = null;
    clearTimeout(this.#long);
    editor.moving = null;
    editor.marquee = null;
    editor.linking = null;
    editor.bending = null;
    editor.target = null;
  }

  #click(item: Item | null, add: boolean): void {
    if (!item) {
      if (!add) shell.select([]);
      return;
    }
    if (!add) {
      shell.select([item.id]);
      return;
    }
    const ids = new Set(shell.selection);
    if (!ids.delete(item.id)) ids.add(item.id);
    shell.select(ids);
  }

  async #drop(ids: Set<string>, title?: Item): Promise<void> {
    const moving = editor.moving;
    if (title) {
      if (moving && (moving.dx !== 0 || moving.dy !== 0)) await editor.arrange(title, moving.dx, moving.dy);
    } else if (moving && (moving.dx !== 0 || moving.dy !== 0)) {
      // Neighbours that only came along stay unselected.
      const selected = [...shell.selection];
      if (await editor.apply({ g: 'move', ids: [...ids], dx: moving.dx, dy: moving.dy })) shell.select(selected);
    }
    editor.moving = null;
  }

  async #bent(link: Item, was: Point[]): Promise<void> {
    const line = editor.bending;
    const isMoved = line?.some(([x, y], n) => x !== was[n]?.[0] || y !== was[n]?.[1]);
    const [ox, oy] = editor.scene?.origin(link.id) ?? [0, 0];
    const points = bendsOf(link, line ?? []).map(([x, y]): Point => [x - ox, y - oy]);
    if (line && isMoved) await editor.apply({ g: 'bend', link: link.id, points });
    editor.bending = null;
  }

  /** Selects the symbols in the marked area; without an area it was a click. */
  #mark(item: Item | null): void {
    const box = editor.marquee;
    editor.marquee = null;
    if (!box) {
      this.#click(item, true);
      return;
    }
    const found = editor.scene?.within(box).map((i) => i.id) ?? [];
    shell.select([...shell.selection, ...found]);
  }

  #take(link: string, end: LinkEnd): void {
    const to = editor.target;
    editor.linking = null;
    editor.target = null;
    if (to) void editor.apply({ g: 'relink', link, end, to });
  }

  #join(from: string, e: PointerEvent): void {
    const to = editor.target;
    const moved = Math.hypot(this.#place(e)[0] - this.#at.x, this.#place(e)[1] - this.#at.y) >= CLICK;
    editor.linking = null;
    editor.target = null;
    if (to) void editor.apply({ g: 'connect', from, to });
    else if (!moved) void editor.apply({ g: 'next', id: from });
  }
}
