// The files that this page has open together with others, and the server's messages about them.
import { drafts } from '../lib/drafts.svelte';
import { files, type OpenFile } from '../lib/files.svelte';
import { t } from '../lib/i18n';
import { prefs } from '../lib/prefs.svelte';
import { server, type Here, type Person, type Table } from '../lib/server';
import { session } from '../lib/session.svelte';
import { shell } from '../lib/shell.svelte';
import { Gathering, type Made } from './gathering.svelte';

/** How long a new text on the disk may belong to a save of which the others have not told yet, in ms. */
const TOLD = 2000;

/** A message about a file. */
interface Told {
  file: string;
  change?: Made;
  begun?: { version: number; text: string };
  people?: Person[];
  here?: [number, Here][];
  saved?: string;
}

class Together {
  #all: ReadonlyMap<string, Gathering> = $state.raw(new Map());
  /** The files at which people are, on this server. */
  tables: readonly Table[] = $state.raw([]);
  /** The hashes of what the others have saved. */
  #saves = new Set<string>();
  #heard = false;

  of(file: OpenFile | null): Gathering | undefined {
    return file ? this.#all.get(file.name) : undefined;
  }

  /** The others at a file that this page has not joined. */
  waiting(file: OpenFile): readonly Person[] {
    if (this.#all.has(file.name)) return [];
    return this.tables.find((row) => row.file === file.name)?.people ?? [];
  }

  /** The name that the others see. A user has the one of the account. */
  get name(): string {
    return session.told.users && !session.told.guest ? (session.told.user?.name ?? '') : prefs.person.trim();
  }

  /** Hears of other people from now on. */
  async begin(): Promise<void> {
    if (this.#heard || !server.info) return;
    this.#heard = true;
    server.hear((message) => {
      if (message.tables) this.tables = message.tables as Table[];
      if (message.together) this.#hear(message.together as Told);
    });
    let lost = false;
    server.link((up) => {
      if (up && lost) void this.#back();
      lost = !up;
    });
    this.tables = (await server.call({ do: 'together_list' })).tables;
  }

  /** Joins those at a file: to edit, or to look for who may not write. */
  async join(file: OpenFile): Promise<void> {
    await this.begin();
    await file.settled();
    const gathering = this.#all.get(file.name) ?? new Gathering(file);
    gathering.refused = (why) => void this.leave(file).then(() => shell.say(why.message, 'error'));
    gathering.replaced = (text) => this.#keep(file, text);
    this.#put(file.name, gathering);
    try {
      await gathering.join(this.name, server.writes);
    } catch (error) {
      this.#drop(gathering);
      throw error;
    }
    file.locked = gathering.edits ? null : t('tog.looks');
  }

  /** Whoever joins takes the text of the others; changes of one's own can be had back. */
  #keep(file: OpenFile, text: string): void {
    if (text === file.saved) return;
    void drafts.keep(file.name, { text, base: file.tag ?? '' }, 'closed');
    shell.say(t('tog.kept'));
  }

  /** Leaves the others: the text is a copy of one's own from now on. */
  async leave(file: OpenFile): Promise<void> {
    const gathering = this.#all.get(file.name);
    if (!gathering) return;
    this.#drop(gathering);
    await server.call({ do: 'together_leave', file: file.name }).catch(() => undefined);
  }

  /** The file was saved here, or what another program wrote into it was taken over: its others know what the disk has. */
  saved(file: OpenFile): void {
    if (!this.#all.has(file.name) || file.tag === null) return;
    void server.call({ do: 'together_saved', file: file.name, tag: file.tag }).catch(() => undefined);
  }

  /** A file of the folder has changed: true if a person at it has saved it, or if another page takes care of it. */
  async outside(file: OpenFile, tag: string): Promise<boolean> {
    const gathering = this.#all.get(file.name);
    if (!gathering) return false;
    for (let left = TOLD; left > 0 && !this.#saves.has(tag); left -= 100) await new Promise((done) => setTimeout(done, 100));
    return this.#saves.has(tag) || !gathering.first;
  }

  #hear(told: Told): void {
    const gathering = this.#all.get(told.file);
    if (!gathering) return;
    if (told.people) gathering.gone(told.people);
    if (told.here) gathering.moved(told.here);
    if (told.change) void shell.try(() => gathering.made(told.change as Made));
    const { begun, saved } = told;
    if (begun) void shell.try(() => gathering.begun(begun.version, begun.text));
    if (saved !== undefined) void this.#savedBy(gathering.file, saved);
  }

  /** Somebody has saved the file: the disk has that text. */
  async #savedBy(file: OpenFile, tag: string): Promise<void> {
    this.#saves.add(tag);
    const now = await server.read(file.name).catch(() => null);
    if (!now || !this.#saves.has(now.hash)) return;
    file.saved = now.text;
    file.tag = now.hash;
    file.outside = null;
  }

  /** The server is there again: comes back to those at each file, with what was changed meanwhile. */
  async #back(): Promise<void> {
    this.tables = (await server.call({ do: 'together_list' }).catch(() => ({ tables: [] }))).tables;
    for (const gathering of this.#all.values()) await shell.try(() => gathering.join(this.name, server.writes));
  }

  #drop(gathering: Gathering): void {
    gathering.end();
    gathering.file.locked = null;
    this.#put(gathering.file.name, null);
  }

  #put(name: string, gathering: Gathering | null): void {
    const next = new Map(this.#all);
    if (gathering) next.set(name, gathering);
    else next.delete(name);
    this.#all = next;
  }

  /** Leaves the files that are closed. */
  keepOpen(): void {
    for (const gathering of this.#all.values()) if (!files.list.includes(gathering.file)) void this.leave(gathering.file);
  }
}

export const together = new Together();
