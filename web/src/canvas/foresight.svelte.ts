// The effect that the text of a field would have: the names that nothing declares, and the text that was meant
// where it cannot be read. The checker is asked while the user types, and only the newest answer counts.
import type { OpenFile } from '../lib/files.svelte';
import { page } from '../lib/page';
import type { Foreseen, Gesture, Undeclared } from '../lib/protocol';

/** The wait for more typing before the checker is asked, in ms. */
const PAUSE = 120;
/** Longest text that is checked while one types; a longer one is checked when it is applied. */
const MOST = 200_000;

export class Foresight {
  #seen: Foreseen | null = $state.raw(null);
  #timer: ReturnType<typeof setTimeout> | undefined;
  #asked = 0;

  readonly names: readonly Undeclared[] = $derived(this.#seen?.undeclared ?? []);
  readonly meant: string | null = $derived(this.#seen?.meant ?? null);

  /** Forgets the field before. */
  begin(): void {
    clearTimeout(this.#timer);
    this.#asked += 1;
    this.#seen = null;
  }

  /** Asks a little later, unless there is another text by then. */
  ask(file: OpenFile, gesture: Gesture | null): void {
    clearTimeout(this.#timer);
    if (file.look.length > MOST) return;
    this.#timer = setTimeout(() => void this.#ask(file, gesture), PAUSE);
  }

  /** Asks now, and waits for the answer. */
  async settle(file: OpenFile, gesture: Gesture | null): Promise<void> {
    clearTimeout(this.#timer);
    await this.#ask(file, gesture);
  }

  async #ask(file: OpenFile, gesture: Gesture | null): Promise<void> {
    const asked = ++this.#asked;
    if (gesture) await file.settled();
    const seen = gesture && (await page.call({ do: 'foresee', file: file.name, gesture }).catch(() => null));
    if (asked === this.#asked) this.#seen = seen;
  }
}
