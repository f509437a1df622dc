// The place of this page's person at a file, told to the others a few times a second.
import type { OpenFile } from '../lib/files.svelte';
import { server, type Here } from '../lib/server';
import { together } from './together.svelte';

/** Time between two messages, in ms. */
const PAUSE = 100;
/** Greatest number of selected symbols that are told. */
const MOST = 64;

class Places {
  #here: Here = {};
  #file: OpenFile | null = null;
  #timer: ReturnType<typeof setTimeout> | undefined;

  /** Notes a part of the place; the others hear of it a little later. */
  tell(file: OpenFile, part: Here): void {
    if (this.#file !== file) this.#here = {};
    this.#file = file;
    const select = part.select?.slice(0, MOST);
    this.#here = { ...this.#here, ...part, ...(select && { select }) };
    this.#timer ??= setTimeout(() => {
      this.#timer = undefined;
      this.#send();
    }, PAUSE);
  }

  #send(): void {
    const gathering = together.of(this.#file);
    if (!gathering || gathering.others.length === 0 || !this.#file) return;
    void server.call({ do: 'together_here', file: this.#file.name, here: this.#here }).catch(() => undefined);
  }
}

export const places = new Places();
