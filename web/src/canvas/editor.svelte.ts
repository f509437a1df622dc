// The state of the visible drawing, and the operations on it. One drawing is visible at a time; the
// panels beside it (palette, properties) use the same state.
import type { OpenFile } from '../lib/files.svelte';
import { t } from '../lib/i18n';
import { actionOf, kindOf, leavingPart, SHEET } from '../lib/ids';
import { declaration, listed, type NewName } from '../lib/names';
import { page, Refused } from '../lib/page';
import type { Box, Edited, Gesture, LinkForm, Undeclared } from '../lib/protocol';
import type { Placed as Item } from '../lib/redrawn';
import { choices, drawnFor } from '../lib/instances.svelte';
import { opened } from '../lib/opened.svelte';
import { shell } from '../lib/shell.svelte';
import { Scene, type Point } from './scene';

export type Field = 'name' | 'receptivity' | 'action' | 'comment' | 'label' | 'priority';

export interface InPlace {
  id: string;
  field: Field;
  /** The number of the action; absent for a new one. */
  index?: number;
  /** Text that is already typed when the field opens. */
  typed?: string;
  /** For a comment that does not exist yet: its place. */
  at?: [number, number];
}

export interface View {
  x: number;
  y: number;
  k: number;
}

/** A tool that is dragged from the palette. */
export type Tool = 'step' | 'transition' | 'macro' | 'enclosing' | 'or' | 'and' | 'action' | 'comment';

interface Camera {
  fit(): void;
  /** Moves the view by px of the screen. */
  panBy(dx: number, dy: number): void;
  zoomBy(factor: number): void;
  /** Makes a box of the plane visible. */
  reveal(box: Box, centre?: boolean): void;
  moveTo(x: number, y: number): void;
  focus(): void;
}

/** Gives the reason of a refusal to a field, if there is one. */
async function told<T>(work: Promise<T>, refused?: (why: string) => void): Promise<T | null> {
  try {
    return await work;
  } catch (error) {
    if (!refused || !(error instanceof Refused)) throw error;
    refused(error.message);
    return null;
  }
}

class Editor {
  file: OpenFile | null = $state.raw(null);
  chart: string | null = $state(null);
  scene: Scene | null = $state.raw(null);
  view: View = $state.raw({ x: 0, y: 0, k: 1 });
  width = $state(0);
  height = $state(0);
  inplace: InPlace | null = $state.raw(null);
  /** The place of the context menu on the screen. */
  menu: { x: number; y: number } | null = $state.raw(null);
  marquee: Box | null = $state.raw(null);
  /** The id of the symbol or link that a drop would affect. */
  target: string | null = $state(null);
  moving: { ids: ReadonlySet<string>; dx: number; dy: number } | null = $state.raw(null);
  /** A link that is being drawn: from this symbol, or to it, to or from a place of the plane. */
  linking: { from: string; x: number; y: number; back?: boolean } | null = $state.raw(null);
  /** The corners of the selected link while one of its segments is dragged. */
  bending: Point[] | null = $state.raw(null);
  /** The dragged tool, with its place on the screen. */
  tool: { what: Tool; x: number; y: number } | null = $state.raw(null);
  /** A text that screen readers read out. */
  said = $state('');
  /** The steps that healing would join if the selected symbols were deleted, such as `4 → 6`. */
  joined = $state('');
  camera: Camera | null = null;
  /** Number of gestures whose results have not arrived. */
  #under = $state(0);
  readonly busy: boolean = $derived(this.#under > 0);
  #copied = '';

  readonly selected: Item[] = $derived(
    [...shell.selection].map((id) => this.scene?.byId.get(id)).filter((i): i is Item => i !== undefined),
  );
  readonly one: Item | null = $derived(this.selected.length === 1 ? (this.selected[0] ?? null) : null);
  readonly stale: boolean = $derived(this.scene?.drawing.stale ?? false);

  /** The file in which the chart stands, if it is another one: it is changed there. */
  readonly elsewhere: string | null = $derived(this.file?.look.charts.find((c) => c.name === this.chart)?.file ?? null);

  /** The names that nothing declares in the selected symbols; without a selection, in the whole file. */
  readonly undeclared: readonly Undeclared[] = $derived.by(() => {
    const all = this.file?.look.undeclared ?? [];
    if (shell.selection.size === 0) return all;
    const chosen = (id: string) => shell.selection.has(id) || shell.selection.has(actionOf(id)?.step ?? '');
    return all.filter((u) => u.items.some(chosen));
  });

  /** Tells where a chart of another file is changed; false for a chart of this one. */
  #refuses(): boolean {
    if (this.elsewhere === null) return false;
    shell.say(t('canvas.elsewhere', { name: this.elsewhere }));
    return true;
  }

  /** Executes a gesture: shows a refusal to the user, selects the new symbols. A field takes the refusal itself. */
  async apply(gesture: Gesture, refused?: (why: string) => void): Promise<Edited | undefined> {
    const { file } = this;
    if (this.#refuses()) return undefined;
    // On a sheet of all charts nothing says to which of them a new part belongs.
    if ('chart' in gesture && gesture.chart === SHEET) {
      shell.say(t('sheet.open'));
      return undefined;
    }
    return file ? this.#draw(file, () => told(file.edit(gesture), refused)) : undefined;
  }

  /** Declares names, together with the gesture that names them. */
  async declare(rows: readonly NewName[], gesture?: Gesture | null, refused?: (why: string) => void): Promise<Edited | undefined> {
    const edited = await this.apply(declaration(rows, gesture), refused);
    if (edited && rows.length > 0) shell.say(t('names.done', { names: listed(rows) }));
    return edited;
  }

  async history(way: 'undo' | 'redo'): Promise<void> {
    const { file, chart } = this;
    if (!file || chart === null) return;
    await this.#draw(file, () => (way === 'undo' ? file.undo() : file.redo()));
  }

  async #draw(file: OpenFile, change: () => Promise<Edited | null>): Promise<Edited | undefined> {
    const { chart } = this;
    const selection = shell.selection;
    return this.#during(async () => {
      const edited = (await shell.try(change)) ?? undefined;
      if (edited && chart !== null) await this.#took(file, chart, edited, selection);
      return edited;
    });
  }

  async #during<T>(work: () => Promise<T>): Promise<T> {
    this.#under += 1;
    try {
      return await work();
    } finally {
      this.#under -= 1;
    }
  }

  async #took(file: OpenFile, chart: string, edited: Edited, selection: ReadonlySet<string>): Promise<void> {
    if (file !== this.file || chart !== this.chart) return;
    if (shell.chart(file) === chart) {
      const drawing = await file.drawing(chart);
      if (this.scene?.drawing !== drawing) this.scene = new Scene(drawing);
    }
    for (const sentence of edited.told ?? []) shell.say(sentence);
    // A selection made during the gesture is kept.
    const free = shell.selection === selection;
    // A link that is drawn in two parts is selected by the one at its start.
    const part = (id: string) => (this.scene?.byId.has(id) ? id : leavingPart(id));
    const made = free ? (edited.select ?? []).map(part) : [];
    if (made.length > 0) {
      shell.select(made);
      const item = this.scene?.byId.get(made[0] ?? '');
      if (item) this.camera?.reveal(item.area);
    } else shell.select([...shell.selection].filter((id) => this.scene?.byId.has(id)));
    if (edited.begin && free) this.edit(edited.begin);
  }

  /** Opens the field for editing a text of a symbol. */
  edit(id: string, field?: Field, index?: number): void {
    if (this.#refuses()) return;
    const kind = kindOf(id);
    // A title has no field; its chart is renamed in the properties.
    if (kind === undefined) return;
    const of = actionOf(id);
    const usual: Field = kind === 't' ? 'receptivity' : kind === 'a' ? 'action' : kind === 'n' ? 'comment' : 'name';
    this.menu = null;
    this.inplace = of
      ? { id: of.step, field: 'action', index: of.index }
      : { id, field: field ?? usual, ...(index === undefined ? {} : { index }) };
  }

  /** Opens the field for a new comment at a place of the plane. */
  note(at: [number, number]): void {
    if (this.chart === null) return;
    if (this.chart === SHEET) {
      shell.say(t('sheet.open'));
      return;
    }
    this.menu = null;
    this.inplace = { id: this.chart, field: 'comment', at };
  }

  /** The effect of Enter: opens a chart if the symbol has one, otherwise edits the symbol. */
  enter(item: Item): void {
    if (item.part === 'title') {
      if (this.file && item.name) shell.show(this.file, item.name);
      return;
    }
    if (this.open(item)) return;
    if (item.part === 'step') {
      const first = this.scene?.actions.get(item.id)?.[0];
      this.edit(item.id, 'action', first ? 0 : undefined);
    } else if (item.part === 'link') void this.apply({ g: 'insert', link: item.id, what: 'step' });
    else if (item.part === 'connector') this.follow(item);
    else if (item.part !== 'text') this.edit(item.id);
  }

  /** Draws the charts that a step opens beside the chart, or takes them away again. */
  openBeside(item: Item): void {
    const { file, chart } = this;
    if (!file || chart === null) return;
    opened.toggle(file.name, chart, item.id);
  }

  /** True if the charts that a step opens are drawn beside the chart. */
  isOpened(item: Item | null): boolean {
    const { file, chart } = this;
    return !!file && chart !== null && !!item && opened.of(file.name, chart).includes(item.id);
  }

  /** Shows the chart that a macro-step or an enclosing step opens. */
  open(item: Item): boolean {
    const name = item.macro ?? item.encloses?.[0] ?? this.#enclosed(item);
    const to = name && this.file ? drawnFor(this.file.look.charts, name) : undefined;
    if (!name || !to || !this.file) return false;
    // An instance has the drawing of its chart; a run shows its marks there.
    if (to !== name) choices.choose(this.file.name, to, name);
    shell.show(this.file, to);
    return true;
  }

  /** The chart that an action of an enclosing step names. */
  #enclosed(item: Item): string | undefined {
    const of = actionOf(item.id);
    const charts = of ? this.scene?.byId.get(of.step)?.encloses : undefined;
    return charts?.find((chart) => item.source === `enclose ${chart}`);
  }

  /** Goes from one end of a broken link to the other. */
  follow(item: Item): void {
    const other = item.ends?.[item.id.endsWith('/leaving') ? 1 : 0];
    if (other && this.file) shell.jump(this.file, other);
  }

  /** Selects a symbol of this chart and makes it visible. */
  goTo(id: string): void {
    shell.select([id]);
    const item = this.scene?.byId.get(id);
    if (item) this.camera?.reveal(item.area);
  }

  copy(): Promise<string> {
    return this.#during(() => this.#copy());
  }

  async #copy(): Promise<string> {
    const { file } = this;
    const ids = [...shell.selection];
    if (!file || ids.length === 0) return '';
    const copied = await shell.try(() => page.call({ do: 'copy', file: file.name, ids }));
    if (copied) {
      this.#copied = copied.text;
      await navigator.clipboard?.writeText(copied.text).catch(() => undefined);
    }
    return copied?.text ?? '';
  }

  async cut(): Promise<void> {
    if ((await this.copy()) !== '') await this.apply({ g: 'cut', ids: [...shell.selection] });
  }

  async paste(text?: string, at?: [number, number]): Promise<void> {
    const fragment = text?.trim() ? text : this.#copied;
    if (!fragment || this.chart === null) return;
    await this.apply({ g: 'paste', chart: this.chart, text: fragment, ...(at ? { at } : {}) });
  }

  /** Finds out what healing would join. */
  async findJoined(): Promise<void> {
    const { file } = this;
    const ids = this.selected.map((i) => i.id);
    const look = file?.look;
    const nodes = this.selected.some((i) => i.part === 'step' || i.part === 'transition');
    // A refusal says that the selection is of a text before this one.
    const found = file && nodes ? await page.call({ do: 'joins', file: file.name, ids }).catch(() => []) : [];
    if (this.file !== file || file?.look !== look || this.selected.map((i) => i.id).join() !== ids.join()) return;
    const side = (names: string[]) => (names.length === 1 ? (names[0] ?? '') : `(${names.join(', ')})`);
    const all = found.map((j) => `${side(j.before)} → ${side(j.behind)}`);
    this.joined = all.slice(0, 3).join(', ') + (all.length > 3 ? ', …' : '');
  }

  remove(heal = true): Promise<Edited | undefined> {
    return this.apply({ g: 'delete', ids: [...shell.selection], heal });
  }

  /** True if nothing is typed, dragged or drawn. The handles of a bent link stay while one of them is dragged. */
  get free(): boolean {
    return !this.inplace && !this.moving && !this.linking && !this.marquee && !this.tool;
  }

  /** Gives the way of the selected link back to the layout. */
  async straighten(): Promise<void> {
    const { one } = this;
    if (one?.part === 'link' && one.bent !== undefined) await this.apply({ g: 'bend', link: one.id, points: [] });
  }

  /** Chooses the form in which a link is drawn; without one the layout decides. */
  drawAs(link: Item, form: LinkForm | null): Promise<Edited | undefined> {
    return this.apply({ g: 'link_form', link: link.id, form });
  }

  /** Has the actions of the selected step stand the other way: side by side, or one below the other. */
  async stackOtherwise(): Promise<void> {
    const { one, scene } = this;
    if (!one) return;
    const now = one.stacked ?? scene?.drawing.actions;
    await this.apply({ g: 'action_form', id: one.id, form: now === 'row' ? 'column' : 'row' });
  }

  /** Moves a chart on the sheet of all charts. */
  async arrange(title: Item, dx: number, dy: number): Promise<void> {
    const [x, y] = title.at ?? [0, 0];
    if (await this.apply({ g: 'sheet', chart: title.name ?? null, at: [x + dx, y + dy] })) shell.select([title.id]);
  }

  /** Draws a link in the other form: a line as a jump, a jump as a line. */
  async otherForm(): Promise<void> {
    const { one } = this;
    if (one?.part === 'link') await this.drawAs(one, 'jump');
    else if (one?.part === 'connector') await this.drawAs(one, one.form === 'jump' ? null : 'line');
  }

  /** Selects a link: the first of the selected symbol, or the next one in the chart. */
  nextLink(): void {
    const { one, scene } = this;
    // A link that is broken off is there once, by its start.
    const links = scene?.items.filter((i) => i.part === 'link' || (i.part === 'connector' && i.id.endsWith('/leaving'))) ?? [];
    const first = links.find((l) => one && !one.ends && l.ends?.includes(one.id));
    const next = first ?? links[(links.findIndex((l) => l.id === one?.id) + 1) % links.length];
    if (next) this.goTo(next.id);
  }

  selectAll(): void {
    shell.select(this.scene?.items.filter((i) => ['step', 'transition', 'comment'].includes(i.part)).map((i) => i.id) ?? []);
  }

  /** A free place at the right of the drawing, at the visible height, on the grid. */
  beside(): [number, number] {
    const [x, y, w, h] = this.scene?.drawing.area ?? [0, 0, 0, 0];
    const middle = this.toPlane(0, this.height / 2)[1];
    const grid = (n: number) => Math.round(n / 5) * 5;
    return [grid(x + w + 30), grid(Math.max(y, Math.min(middle, y + h)))];
  }

  /** Converts a place on the screen to a place of the plane. */
  toPlane(x: number, y: number): [number, number] {
    return [(x - this.view.x) / this.view.k, (y - this.view.y) / this.view.k];
  }
}

export const editor = new Editor();
