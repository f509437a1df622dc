// The open files. The text is kept here and in the worker. Changes typed here and changes made
// there while an answer is on its way are rebased on each other.
import { ChangeSet, type Text } from '@codemirror/state';
import { drafts } from './drafts.svelte';
import { opened as beside } from './opened.svelte';
import { page, Refused, type Message } from './page';
import { prefs } from './prefs.svelte';
import type { Edited, Gesture, Look, Problem, Shelved, Splice } from './protocol';
import { Redraws, type Drawing } from './redrawn';
import { Conflict, server } from './server';

/** The origin of a change; a listener that made the change itself can ignore it. */
export type Origin = 'text' | 'structure' | 'history' | 'disk' | 'others';

export interface TextChange {
  splices: Splice[];
  origin: Origin;
}

type Listener = (change: TextChange) => void;

interface Typed {
  changes: ChangeSet;
  /** True if it is undone as a unit of its own. */
  unit: boolean;
  /** True for a change of somebody else, which is not undone here. */
  others: boolean;
}

export const asSpecs = (splices: Splice[]) => splices.map((s) => ({ from: s.from, to: s.to, insert: s.insert }));

export function asSplices(changes: ChangeSet): Splice[] {
  const found: Splice[] = [];
  changes.iterChanges((from, to, _a, _b, insert: Text) => {
    found.push({ from, to, insert: insert.toString() });
  }, true);
  return found;
}

export function apply(text: string, splices: Splice[]): string {
  let out = '';
  let at = 0;
  for (const s of splices) {
    out += text.slice(at, s.from) + s.insert;
    at = s.to;
  }
  return out + text.slice(at);
}

/** Two changes of one text, each as a change of the text that the other one makes. At one place `theirs` comes first. */
export function crossed(theirs: ChangeSet, mine: ChangeSet): [theirs: ChangeSet, mine: ChangeSet] {
  return [theirs.map(mine, true), mine.map(theirs)];
}

/** The change that makes one text of another: what differs, as one splice. */
export function between(now: string, text: string): Splice[] {
  const most = Math.min(now.length, text.length);
  let from = 0;
  while (from < most && now[from] === text[from]) from++;
  let tail = 0;
  while (tail < most - from && now[now.length - 1 - tail] === text[text.length - 1 - tail]) tail++;
  return now === text ? [] : [{ from, to: now.length - tail, insert: text.slice(from, text.length - tail) }];
}

export class OpenFile {
  readonly name: string;
  look: Look = $state.raw(undefined as unknown as Look);
  text: string = $state.raw('');
  /** The text as it is on the disk. */
  saved: string | null = $state.raw(null);
  /** The server's hash of that text. */
  tag: string | null = null;
  /** The present text on the disk, if it is neither ours nor the one that was read. */
  outside: { text: string; hash: string } | null = $state.raw(null);
  readonly changed: boolean = $derived(this.text !== this.saved);
  /** The text whose saving waits until the server is back. */
  waits: string | null = $state.raw(null);
  /** Its text is unsaved work of an earlier time. */
  recovered = $state(false);
  /** Why it cannot be changed here now, if so. */
  locked: string | null = $state(null);

  #listeners = new Set<Listener>();
  /** Typed changes that are not sent yet; each is relative to the text after those before it. */
  #typed: Typed[] = [];
  /** Ends when every change asked for so far is in the text here and in the worker. */
  #line: Promise<unknown> = Promise.resolve();
  #drawings = new Map<string, { version: number; drawing: Promise<Drawing>; redraws: Redraws }>();

  constructor(look: Look, text: string) {
    this.name = look.file;
    this.look = look;
    this.text = text;
  }

  /** True if closing loses something. A new file that was never changed has nothing to lose. */
  get loses(): boolean {
    return this.changed && (this.saved !== null || this.look.can_undo || this.recovered);
  }

  /** Calls a listener after every change of the text. */
  listen(listener: Listener): () => void {
    this.#listeners.add(listener);
    return () => this.#listeners.delete(listener);
  }

  /** Takes changes typed in the text view. What is typed while the worker is busy is sent together
   * afterwards. */
  type(splices: Splice[], unit = false): Promise<void> {
    return this.#put(splices, unit, 'text');
  }

  /** Executes the fix of this number of a problem of the present look. */
  async mend(problem: Problem, fix: number): Promise<void> {
    const splices = problem.fixes[fix]?.splices;
    if (splices) return this.fix(splices);
    const { version } = this.look;
    const of = this.look.problems.indexOf(problem);
    // A newer look has come meanwhile, and shows its own problems.
    if (of < 0) return;
    await this.#turn(() => this.#change({ do: 'mend', file: this.name, version, problem: of, fix }, 'structure'));
  }

  /** Applies a change that was offered, as an edit of its own. */
  fix(splices: Splice[]): Promise<void> {
    return this.#put(splices, true, 'structure');
  }

  /** Makes a change of somebody else, which is not undone here. */
  others(splices: Splice[]): Promise<void> {
    return this.#put(splices, true, 'others');
  }

  /** Waits until no change is under way: the worker has the present text. */
  async settled(): Promise<void> {
    for (let line: Promise<unknown> | undefined; line !== this.#line; ) {
      line = this.#line;
      await line;
    }
  }

  /** Asks for the problems again, in the language that was chosen meanwhile. */
  again(): Promise<void> {
    return this.#turn(async () => {
      this.look = await lent(await page.call({ do: 'look', file: this.name }));
    });
  }

  /** True if it uses the file of this name. */
  uses(name: string): boolean {
    return this.look.uses.includes(name);
  }

  /** The texts of the files that it uses, for another worker or the server. */
  async used(): Promise<Shelved[]> {
    return page.call({ do: 'used', file: this.name });
  }

  /** Executes a gesture. */
  edit(gesture: Gesture): Promise<Edited> {
    return this.#turn(() => this.#change({ do: 'edit', file: this.name, gesture }, 'structure'));
  }

  /** Undoes the last change; null if there is none when its turn comes. */
  undo(): Promise<Edited | null> {
    return this.#turn(async () => (this.look.can_undo ? this.#change({ do: 'undo', file: this.name }, 'history') : null));
  }

  /** The inverse of undo; null if nothing was undone. */
  redo(): Promise<Edited | null> {
    return this.#turn(async () => (this.look.can_redo ? this.#change({ do: 'redo', file: this.name }, 'history') : null));
  }

  format(): Promise<Edited> {
    return this.#turn(() => this.#change({ do: 'format', file: this.name }, 'structure'));
  }

  /** Replaces the whole text as one edit that can be undone: a newer version from the disk. */
  async replace(text: string): Promise<void> {
    await this.#put(between(this.text, text), true, 'disk');
    await this.settled();
  }

  /** The drawing of a chart, for the present text. */
  drawing(chart: string): Promise<Drawing> {
    const look = prefs.look;
    const open = [...beside.of(this.name, chart)];
    const key = `${chart}\n${look}\n${prefs.pages}\n${open.join('\n')}`;
    const known = this.#drawings.get(key);
    if (known && known.version === this.look.version) return known.drawing;
    const redraws = known?.redraws ?? new Redraws();
    const drawing = redraws.ask({ file: this.name, chart, look, actions: true, pages: prefs.pages ? 'pl7' : null, open });
    this.#drawings.set(key, { version: this.look.version, drawing, redraws });
    return drawing;
  }

  async #put(splices: Splice[], unit: boolean, origin: Origin): Promise<void> {
    if (splices.length === 0) return;
    const others = origin === 'others';
    if (!others) this.#open();
    const changes = ChangeSet.of(asSpecs(splices), this.text.length);
    const last = this.#typed.at(-1);
    if (last && !last.unit && !unit) last.changes = last.changes.compose(changes);
    else this.#typed.push({ changes, unit, others });
    this.text = apply(this.text, splices);
    this.#tell({ splices, origin });
    await this.#turn(() => this.#send());
  }

  /** Refuses a change of a file that is locked. */
  #open(): void {
    if (this.locked !== null) throw new Refused(this.locked);
  }

  /** Does a work when all asked for before it is done. */
  #turn<T>(work: () => Promise<T>): Promise<T> {
    const done = this.#line.then(work);
    // A change that fails tells its caller; those behind it go on.
    this.#line = done.catch(() => undefined);
    return done;
  }

  async #change(message: Message<'edit' | 'mend' | 'undo' | 'redo' | 'format'>, origin: Origin): Promise<Edited> {
    this.#open();
    const edited = await page.call(message);
    let theirs = ChangeSet.of(asSpecs(edited.splices), this.#typed[0]?.changes.length ?? this.text.length);
    for (const mine of this.#typed) [theirs, mine.changes] = crossed(theirs, mine.changes);
    const splices = asSplices(theirs);
    this.text = apply(this.text, splices);
    this.look = edited;
    this.#tell({ splices, origin });
    // The listeners hear of the text before any waiting, in the order of its changes.
    this.look = await lent(edited);
    return edited;
  }

  /** Sends the typed changes until none are left. */
  async #send(): Promise<void> {
    for (let next = this.#typed.shift(); next; next = this.#typed.shift()) {
      const splices = asSplices(next.changes);
      if (splices.length === 0) continue;
      this.look = await lent(await page.call({ do: 'splice', file: this.name, splices, unit: next.unit, others: next.others }));
    }
  }

  #tell(change: TextChange): void {
    this.#listeners.forEach((listener) => listener(change));
    files.usedChanged(this.name);
  }
}

/** Gives the worker the texts that a file wants, until it has all of them; returns the newest look at the file. A file
 * that is open under another name than its own has a prefix before that. */
export async function lent<L extends Look>(look: L, prefix = ''): Promise<L> {
  let now: Look = look;
  while (now.wants.length > 0) {
    await shelve(now.wants, prefix);
    now = await page.call({ do: 'look', file: look.file });
  }
  return now === look ? look : { ...look, ...now };
}

/** Reads files that others use, and gives them to the worker. */
async function shelve(names: string[], prefix = ''): Promise<void> {
  const read = async (file: string): Promise<Shelved> => {
    const text = await server.read(file.slice(prefix.length)).then((f) => f.text).catch(() => null);
    return { file, text };
  };
  await page.call({ do: 'lend', files: await Promise.all(names.map(read)) });
}

class Files {
  list: OpenFile[] = $state.raw([]);
  current: OpenFile | null = $state.raw(null);

  find(name: string): OpenFile | undefined {
    return this.list.find((f) => f.name === name);
  }

  /** Opens a text under a name, or shows the file if it is open already. */
  async open(name: string, text: string, saved: string | null = null, tag: string | null = null): Promise<OpenFile> {
    const known = this.find(name);
    if (known) {
      this.current = known;
      return known;
    }
    const look = await lent(await page.call({ do: 'open', file: name, text }));
    if (look.imported) text = (await page.call({ do: 'text', file: look.file })).text;
    const file = new OpenFile(look, text);
    file.saved = look.imported ? null : saved;
    file.tag = look.imported ? null : tag;
    this.list = [...this.list, file];
    this.current = file;
    this.usedChanged(file.name);
    return file;
  }

  /** Opens a file of the server, or an example. */
  async read(path: string): Promise<OpenFile> {
    const known = this.find(path);
    if (known) {
      this.current = known;
      return known;
    }
    const { text, hash } = await server.read(path);
    return this.open(path, text, text, hash);
  }

  #saves = new WeakMap<OpenFile, Promise<unknown>>();

  /** Saves a text of a file, when those before it are saved. */
  save(file: OpenFile, text = file.text): Promise<void> {
    const done = (this.#saves.get(file) ?? Promise.resolve()).then(() => this.#save(file, text));
    this.#saves.set(file, done.catch(() => undefined));
    return done;
  }

  async #save(file: OpenFile, text: string): Promise<void> {
    file.tag = await server.write(file.name, text, file.tag).catch((error: unknown) => {
      // The server has written it, and its answer was lost.
      if (error instanceof Conflict && error.text === text) return error.hash;
      throw error;
    });
    file.saved = text;
    file.outside = null;
    file.waits = null;
    // The user may have typed while the file was saved: that text still needs its copy.
    if (!file.changed) void drafts.saved(file.name);
  }

  async close(file: OpenFile): Promise<void> {
    const at = this.list.indexOf(file);
    this.list = this.list.filter((f) => f !== file);
    if (this.current === file) this.current = this.list[Math.min(at, this.list.length - 1)] ?? null;
    if (file.loses) await drafts.keep(file.name, { text: file.text, base: file.tag ?? '' }, 'closed');
    else if (file.changed) await drafts.saved(file.name);
    await page.call({ do: 'close', file: file.name });
    this.usedChanged(file.name);
  }

  #soon = new Map<string, ReturnType<typeof setTimeout>>();

  /** Looks again, a little later, at the open files that use one that has changed. */
  usedChanged(name: string): void {
    clearTimeout(this.#soon.get(name));
    const heads = this.list.filter((f) => f.name !== name && f.uses(name));
    if (heads.length === 0) return;
    this.#soon.set(name, setTimeout(() => heads.forEach((f) => void f.again()), 200));
  }

  /** Takes the new text of a file of the folder that is not open, for those that use it. */
  async outside(name: string): Promise<void> {
    if (!this.list.some((f) => f.uses(name))) return;
    await shelve([name]);
    this.usedChanged(name);
  }
}

export const files = new Files();
