// The clock of runs that the page holds. A message advances the virtual time, and the next one
// waits for its answer; if a run is slow, its time becomes slow instead of a queue growing.
// Messages are sent as often as visible changes are possible: with each picture of the screen if a
// plant moves, otherwise 25 times a second, and never more often than there are scans.
import { runs, type Run } from '../lib/runs.svelte';
import { files } from '../lib/files.svelte';
import { shell } from '../lib/shell.svelte';

/** Time between two messages, in ms: if a plant's picture moves, and if only the drawing does. */
const SMOOTH = 15;
const CALM = 40;
/** Longest wait for slow scans, so that a pause takes effect quickly. */
const PATIENT = 200;
/** A page that was hidden does not catch up more than this, in ms. */
const LONGEST = 400;

class Clock {
  #last = 0;
  #owed = 0;
  #going = false;

  /** Starts the clock; it runs while a run is playing. */
  go(): void {
    if (this.#going) return;
    this.#going = true;
    this.#owed = 0;
    this.#last = performance.now();
    this.#wait(0);
  }

  #wait(ms: number): void {
    // If a plant's picture moves, the message is sent in step with the pictures of the screen.
    if (ms <= SMOOTH) requestAnimationFrame(() => void this.#tick());
    else setTimeout(() => void this.#tick(), ms);
  }

  async #tick(): Promise<void> {
    const run = files.current ? runs.of(files.current.name) : null;
    if (!run?.playing || run.shared) {
      this.#going = false;
      return;
    }
    const now = performance.now();
    this.#owed = document.hidden ? 0 : Math.min(this.#owed + now - this.#last, LONGEST);
    this.#last = now;
    await this.#advance(run);
    this.#wait(Math.max(0, gap(run) - (performance.now() - now)));
  }

  async #advance(run: Run): Promise<void> {
    const ms = this.#owed * run.speed;
    this.#owed = 0;
    try {
      await runs.send(run, { do: 'run_advance', ms, times: true, most_scans: 4000 });
    } catch (error) {
      run.playing = false;
      shell.say((error as Error).message, 'error');
    }
  }
}

function gap(run: Run): number {
  const scan = run.started.period_ms / run.speed;
  return Math.min(PATIENT, Math.max(scan, run.pictures > 0 ? SMOOTH : CALM));
}

export const clock = new Clock();
