// Copies of unsaved work in the browser: for the playground, and for the folder of a server that
// does not answer.
import type { Draft, DraftRow, End } from './drafts.svelte';
import { here, others } from './here';
import { link } from './link.svelte';
import { server } from './server';

/** How long a copy is kept that was closed, in ms. */
const KEPT = 30 * 24 * 3_600_000;

interface Stored {
  path: string;
  window: string;
  text: string;
  base: string | null;
  waits?: string | null;
  at: number;
  closed: boolean;
}

/** Several servers with different folders may use the same address. */
const place = () => `g7-work:${server.info?.place ?? ''}|`;
/** The places of earlier versions: they had the folder as the user had named it, and the first ones held the text alone. */
const named = () => `g7-work:${server.info?.folder ?? ''}|`;
const before = () => `g7-draft:${server.info?.folder ?? ''}|`;

const keyOf = (path: string) => `${place()}${here}|${path}`;

function stored(key: string): Stored | null {
  try {
    return JSON.parse(localStorage.getItem(key) ?? 'null') as Stored | null;
  } catch {
    return null;
  }
}

/** Writes a copy; if the storage is full, it keeps its contents. */
function write(key: string, copy: Stored): void {
  try {
    localStorage.setItem(key, JSON.stringify(copy));
    link.full = false;
  } catch {
    link.full = true;
  }
}

function drop(key: string): void {
  try {
    localStorage.removeItem(key);
  } catch {
    // Nothing is kept where there is no storage.
  }
}

function keys(from: string): string[] {
  try {
    return Object.keys(localStorage).filter((key) => key.startsWith(from));
  } catch {
    return [];
  }
}

/** Gives the copies of earlier versions the form of today. */
function renew(): void {
  for (const key of keys(before())) {
    const text = localStorage.getItem(key) ?? '';
    const path = key.slice(before().length);
    write(`${place()}|${path}`, { path, window: '', text, base: null, at: Date.now(), closed: false });
    drop(key);
  }
  if (named() === place()) return;
  for (const key of keys(named())) {
    const copy = stored(key);
    if (copy) write(place() + key.slice(named().length), copy);
    drop(key);
  }
}

export const local = {
  async rows(): Promise<DraftRow[]> {
    renew();
    const there = await others();
    const rows: DraftRow[] = [];
    for (const id of keys(place())) {
      const copy = stored(id);
      if (!copy) continue;
      const { path, at, closed, window } = copy;
      if (closed && at < Date.now() - KEPT) {
        drop(id);
        continue;
      }
      const holder = closed ? 'closed' : window === here ? 'this' : there.has(window) ? 'other' : 'gone';
      rows.push({ id, path, holder, at, size: copy.text.length, kept: 'browser' });
    }
    return rows;
  },

  keep(path: string, { text, base, waits }: Omit<Draft, 'path'>, end: End): void {
    const at = Date.now();
    const key = end === 'closed' ? `${keyOf(path)}|${at}` : keyOf(path);
    write(key, { path, window: here, text, base, waits: end === 'open' ? waits : null, at, closed: end !== 'open' });
    if (end === 'closed') drop(keyOf(path));
  },

  saved(path: string): void {
    drop(keyOf(path));
  },

  read(id: string): Draft | null {
    return stored(id);
  },

  /** Takes over the copy of a window that has gone; the other copies of its file that have no window either are
   * closed. */
  async take(id: string): Promise<Draft | null> {
    const copy = stored(id);
    if (!copy || copy.closed) return copy;
    for (const row of await local.rows()) {
      const other = stored(row.id);
      if (other && row.path === copy.path && row.id !== id && row.holder === 'gone') write(row.id, { ...other, closed: true });
    }
    drop(id);
    // The wish of another window to save is not done unasked.
    const taken = copy.window === here ? copy : { ...copy, waits: null };
    local.keep(copy.path, taken, 'open');
    return taken;
  },

  drop,

  /** Calls a listener when another window of this browser changes its copies. */
  hear(listener: () => void): void {
    addEventListener('storage', (event) => event.key?.startsWith(place()) && listener());
  },
};
