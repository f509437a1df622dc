// The state of the window: the visible chart, the selection, the open dialog, and the places at
// which components of other folders appear.
import { tick, type Component } from 'svelte';
import { files, type OpenFile } from './files.svelte';
import type { Key } from './i18n';
import { prefs } from './prefs.svelte';
import { chartOf, SHEET } from './ids';
import { Refused } from './page';
import type { FileRow } from './server';

/** A component with a place in the window. */
export interface Panel {
  id: string;
  title: Key;
  /** `over` lies above everything. */
  region: 'left' | 'right' | 'bottom' | 'top' | 'text' | 'reader' | 'start' | 'over';
  component: Component;
  /** Panels with lower numbers come first. */
  order: number;
  /** False while there is nothing to be seen in it; a panel without this is always there. */
  shown?: () => boolean;
}

/** A place of the text to be shown. */
export interface Reveal {
  file: string;
  from: number;
  to: number;
}

export interface Notice {
  id: number;
  text: string;
  kind: 'info' | 'error';
}

class Shell {
  /** The visible chart of each file. */
  #charts: Record<string, string> = $state({});
  /** The ids of the selected symbols in the visible chart. */
  selection: ReadonlySet<string> = $state.raw(new Set());
  hover: string | null = $state(null);
  /** A symbol that the canvas is asked to show. */
  goto: { id: string; n: number } | null = $state.raw(null);
  /** A place that the text view is asked to show. */
  reveal: Reveal | null = $state.raw(null);
  dialog: string | null = $state(null);
  /** The code of the problem that a dialog explains. */
  explained = $state('');
  /** The open tab of each region. */
  tabs: Record<string, string> = $state({});
  notices: Notice[] = $state.raw([]);
  /** True if the gallery covers the window. */
  gallery = $state(false);
  /** True if a text to be read stands beside the editor; on a telephone, in its place. */
  reading = $state(false);
  /** True after the start: the server is found and the first file is open. */
  ready = $state(false);
  /** The files of the server's folder, or the examples. */
  folder: FileRow[] = $state.raw([]);
  /** The file that the closing dialog asks about. */
  closing: OpenFile | null = $state.raw(null);
  #count = 0;

  /** True if the folder has a file of this path. */
  inFolder(path: string): boolean {
    return this.folder.some((row) => row.path === path);
  }

  /** The visible chart of a file: the chosen one, otherwise the first. */
  chart(file: OpenFile | null): string | null {
    if (!file) return null;
    const chosen = this.#charts[file.name];
    const charts = file.look.charts;
    if (chosen === SHEET && charts.length > 1) return SHEET;
    return charts.find((c) => c.name === chosen)?.name ?? charts[0]?.name ?? null;
  }

  show(file: OpenFile, chart?: string): void {
    files.current = file;
    if (chart !== undefined && this.chart(file) !== chart) {
      this.#charts[file.name] = chart;
      this.selection = new Set();
    }
  }

  /** Shows a symbol and selects it. */
  jump(file: OpenFile, id: string): void {
    // A sheet of all charts has the symbol as well.
    const everywhere = this.chart(file) === SHEET && !file.look.charts.find((c) => c.name === chartOf(id))?.file;
    this.show(file, everywhere ? SHEET : chartOf(id));
    this.selection = new Set([id]);
    this.goto = { id, n: ++this.#count };
  }

  /** Shows a place of the text. */
  showText(file: OpenFile, from: number, to: number): void {
    files.current = file;
    if (prefs.view === 'chart') prefs.view = 'both';
    this.reveal = { file: file.name, from, to };
  }

  /** Shows a panel at the bottom. */
  below(panel: string): void {
    prefs.bottomOpen = true;
    this.tabs.bottom = panel;
  }

  /** Shows the list of problems, and selects the one at a place of the text if there is one. */
  problems(at?: number): void {
    this.below('problems');
    const all = files.current?.look.problems ?? [];
    const n = Math.max(0, all.findIndex((p) => at !== undefined && p.from <= at && at <= p.to));
    void tick().then(() => document.querySelectorAll<HTMLElement>('.problems .problem')[n]?.focus());
  }

  /** Gives the drawing the keys, if it is visible. */
  keysToDrawing(): void {
    void tick().then(() => document.querySelector<HTMLElement>('#drawing [role=application]')?.focus());
  }

  /** Shows the page on a kind of problem. */
  explain(code: string): void {
    this.explained = code;
    this.dialog = 'explain';
  }

  select(ids: Iterable<string>): void {
    this.selection = new Set(ids);
  }

  say(text: string, kind: 'info' | 'error' = 'info'): void {
    const id = ++this.#count;
    this.notices = [...this.notices.slice(-3), { id, text, kind }];
    setTimeout(() => this.drop(id), kind === 'error' ? 8000 : 4000);
  }

  drop(id: number): void {
    this.notices = this.notices.filter((n) => n.id !== id);
  }

  /** Does something that may be refused; shows a refusal to the user. */
  async try<T>(work: () => Promise<T>): Promise<T | undefined> {
    try {
      return await work();
    } catch (error) {
      this.say(error instanceof Error ? error.message : String(error), 'error');
      if (!(error instanceof Refused)) console.error(error);
      return undefined;
    }
  }
}

export const shell = new Shell();
