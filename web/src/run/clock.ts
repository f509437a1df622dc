// The wall clock of runs that the page holds: a message moves the virtual time on,
// and the next one waits for its answer, so that a slow run makes time slow and not
// the queue long.
import { runs, type Run } from '../lib/runs.svelte';
import { files } from '../lib/files.svelte';
import { shell } from '../lib/shell.svelte';

/** Between two messages: smooth where a picture moves, else as often as the drawing changes. */
const SMOOTH = 15;
const CALM = 38;
/** A page that was hidden does not catch up. */
const LONGEST = 200;

class Clock {
  #last = 0;
  #owed = 0;
  #sent = 0;
  #busy = false;
  #handle = 0;

  /** Goes while something runs. */
  go(): void {
    if (this.#handle !== 0) return;
    this.#last = performance.now();
    this.#handle = requestAnimationFrame((at) => this.#tick(at));
  }

  #tick(at: number): void {
    this.#handle = 0;
    const run = files.current ? runs.of(files.current.name) : null;
    if (!run?.playing || run.shared) {
      this.#owed = 0;
      return;
    }
    this.#owed = Math.min(this.#owed + Math.max(0, at - this.#last), LONGEST);
    this.#last = at;
    const gap = run.started.view ? SMOOTH : CALM;
    if (!this.#busy && at - this.#sent >= gap) {
      this.#sent = at;
      void this.#advance(run);
    }
    this.#handle = requestAnimationFrame((next) => this.#tick(next));
  }

  async #advance(run: Run): Promise<void> {
    this.#busy = true;
    const ms = this.#owed * run.speed;
    this.#owed = 0;
    try {
      await runs.send(run, { do: 'run_advance', ms, times: true, most_scans: 4000 });
    } catch (error) {
      run.playing = false;
      shell.say((error as Error).message, 'error');
    } finally {
      this.#busy = false;
    }
  }
}

export const clock = new Clock();
