// Copies of unsaved work in the browser: of the playground, and of the folder of a
// server that does not answer.
import { server } from './server';

/** Folders of several servers may be open under one address. */
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

  /** Keeps a text; without one it is forgotten. */
  put(path: string, text: string | null): void {
    try {
      if (text === null) localStorage.removeItem(place() + path);
      else localStorage.setItem(place() + path, text);
    } catch {
      // A full store keeps what it has.
    }
  },
};
