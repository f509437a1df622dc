// Copies of unsaved work: those that the server keeps, and those of the browser if there is no server or it is away.
// A copy belongs to a window; it is deleted when its owner saves the file, or when the user asks for it.
import { t } from './i18n';
import { local } from './local';
import { Refused } from './page';
import { server } from './server';

/** The file has changes; they were undone; it was closed without being saved. */
export type End = 'open' | 'undone' | 'closed';

export interface Draft {
  path: string;
  text: string;
  /** The hash of the file that was changed; empty for a new file, null if it is not known. */
  base: string | null;
  /** The text whose saving waits for the server. */
  waits?: string | null;
}

/** A copy, as the list tells of it. */
export interface DraftRow {
  id: string;
  path: string;
  /** The name of the person, if it is another one. */
  person?: string;
  /** Who has it: this window, another one that is there, one that has gone; or it was closed. */
  holder: 'this' | 'other' | 'gone' | 'closed';
  at: number;
  size: number;
  kept: 'server' | 'browser';
}

class Drafts {
  rows: DraftRow[] = $state.raw([]);
  /** The copies of this window, as they were kept last. */
  #last = new Map<string, Omit<Draft, 'path'>>();
  #soon: ReturnType<typeof setTimeout> | undefined;
  /** Ends when all that was asked of the server before is done: the last wish for a file is the one that stays. */
  #line: Promise<unknown> = Promise.resolve();

  /** The copies that can be had back. */
  readonly back: DraftRow[] = $derived(this.rows.filter((row) => row.holder === 'gone' || row.holder === 'closed'));

  /** Asks for the list anew. */
  async look(): Promise<void> {
    const kept = server.writes ? await server.drafts().catch(() => []) : [];
    this.rows = [...kept, ...(await local.rows())].sort((a, b) => b.at - a.at);
  }

  /** The same, a little later: several changes at once are one. */
  soon(): void {
    clearTimeout(this.#soon);
    this.#soon = setTimeout(() => void this.look(), 300);
  }

  /** Keeps a copy; true if the server has it. */
  async keep(path: string, draft: Omit<Draft, 'path'>, end: End = 'open'): Promise<boolean> {
    if (end === 'open') this.#last.set(path, draft);
    else this.#last.delete(path);
    const kept = server.writes && (await this.#turn(() => server.keepDraft(path, draft, end)));
    if (kept) local.saved(path);
    else {
      local.keep(path, draft, end);
      this.soon();
    }
    return kept;
  }

  /** The text of a file is again as it was saved: what was kept can still be had back. */
  async undone(path: string, saved: string | null): Promise<void> {
    const last = this.#last.get(path);
    if (!last) return;
    if (last.text === saved) await this.saved(path);
    else await this.keep(path, last, 'undone');
  }

  /** The file is saved: this window needs no copy. */
  async saved(path: string): Promise<void> {
    this.#last.delete(path);
    local.saved(path);
    if (server.writes) await this.#turn(() => server.savedDraft(path));
    this.soon();
  }

  async read(row: DraftRow): Promise<Draft> {
    return there(row.kept === 'server' ? await server.draft(row.id) : local.read(row.id));
  }

  /** Makes this window the owner of a copy; one that was closed stays beside it. */
  async take(row: DraftRow): Promise<Draft> {
    const draft = there(row.kept === 'server' ? await server.takeDraft(row.id) : await local.take(row.id));
    // A browser's copy is newer than what the server has of a window that has gone: that is offered, and nothing more.
    const older = this.rows.filter((r) => r.path === row.path && r.kept === 'server' && r.holder === 'gone');
    if (row.kept === 'browser') for (const other of older) await this.shelve(other);
    if (row.holder !== 'closed') this.#last.set(row.path, draft);
    this.soon();
    return draft;
  }

  /** Puts the copy of a window that has gone into the list of closed ones. */
  async shelve(row: DraftRow): Promise<void> {
    const draft = there(row.kept === 'server' ? await server.takeDraft(row.id) : await local.take(row.id));
    await this.keep(row.path, draft, 'closed');
    this.soon();
  }

  /** Deletes a copy for good. */
  async drop(row: DraftRow): Promise<void> {
    if (row.kept === 'server') await server.dropDraft(row.id);
    else local.drop(row.id);
    await this.look();
  }

  /** Asks the server for something when all asked before is done; true if it was done. */
  #turn(work: () => Promise<void>): Promise<boolean> {
    const done = this.#line.then(work).then(
      () => true,
      () => false,
    );
    this.#line = done;
    return done;
  }
}

/** A copy that may have gone meanwhile. */
function there(draft: Draft | null): Draft {
  if (!draft) throw new Refused(t('work.away'));
  return draft;
}

export const drafts = new Drafts();
