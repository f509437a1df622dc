// How far a student is with each exercise. The browser keeps it; nothing is sent.
import { server } from '../lib/server';

export interface Progress {
  /** The name of the student's file. */
  file: string;
  /** The number of hints that were taken. */
  hints: number;
  /** A check has found all right. */
  passed: boolean;
  /** The text of the file, as it was last. */
  text: string;
}

/** Several servers with different folders may use the same address. */
const key = () => `g7-exercises:${server.info?.place ?? ''}`;

/** True for what this page has written, and not a damaged or foreign value. */
function isProgress(value: unknown): value is Progress {
  const { file, hints, passed, text } = (value ?? {}) as Partial<Progress>;
  return typeof file === 'string' && typeof hints === 'number' && typeof passed === 'boolean' && typeof text === 'string';
}

function stored(): Map<string, Progress> {
  try {
    const found = JSON.parse(localStorage.getItem(key()) ?? '{}') as Record<string, unknown>;
    return new Map(Object.entries(found).filter((row): row is [string, Progress] => isProgress(row[1])));
  } catch {
    return new Map();
  }
}

class Kept {
  #byId: ReadonlyMap<string, Progress> = $state.raw(new Map());

  /** Reads what is kept; call once the server is known, and when another window has changed it. */
  look(): void {
    this.#byId = stored();
  }

  of(id: string): Progress | null {
    return this.#byId.get(id) ?? null;
  }

  /** The exercise to which a file belongs. */
  idOf(file: string): string | null {
    return [...this.#byId].find(([, one]) => one.file === file)?.[0] ?? null;
  }

  put(id: string, change: Partial<Progress>): void {
    // Another window may have gone on with another exercise.
    const all = stored();
    const before = all.get(id) ?? this.#byId.get(id) ?? { file: '', hints: 0, passed: false, text: '' };
    all.set(id, { ...before, ...change });
    this.#byId = all;
    try {
      localStorage.setItem(key(), JSON.stringify(Object.fromEntries(all)));
    } catch {
      // Where nothing can be kept, it stays until the page is left.
    }
  }

  hear(): void {
    addEventListener('storage', (event) => event.key === key() && this.look());
  }
}

export const progress = new Kept();
