// Copies of unsaved work in the browser: for the playground, and for the folder of a server that
// does not answer.
import { server } from './server';

/** Several servers with different folders may use the same address. */
const place = () => `g7-draft:${server.info?.folder ?? ''}|`;

export const local = {
  all(): { path: string; text: string }[] {
    try {
      const keys = Object.keys(localStorage).filter((k) => k.startsWith(place()));
      return keys.map((k) => ({ path: k.slice(place().length), text: localStorage.getItem(k) ?? '' }));
    } catch {
      return [];
    }
  },

  /** Keeps a text; without a text the copy is deleted. */
  put(path: string, text: string | null): void {
    try {
      if (text === null) localStorage.removeItem(place() + path);
      else localStorage.setItem(place() + path, text);
    } catch {
      // If the storage is full, it keeps its contents.
    }
  },
};
