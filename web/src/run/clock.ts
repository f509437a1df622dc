// The wall clock of runs that the page holds: a message moves the virtual time on,
// and the next one waits for its answer, so that a slow run makes time slow and not
// the queue long. It asks as often as something can have changed to be seen: with
// each picture of the screen where a plant moves, else 25 times a second, and never
// more often than there are scans.
import { runs, type Run } from '../lib/runs.svelte';
import { files } from '../lib/files.svelte';
import { shell } from '../lib/shell.svelte';

/** Between two messages, ms: where a picture moves, and where only the drawing does. */
const SMOOTH = 15;
const CALM = 40;
/** Slow scans are waited for no longer than that, so that a pause is felt at once. */
const PATIENT = 200;
/** A page that was hidden does not catch up. */
const LONGEST = 400;

class Clock {
  #last = 0;
  #owed = 0;
  #going = false;

  /** Goes while something runs. */
  go(): void {
    if (this.#going) return;
    this.#going = true;
    this.#owed = 0;
    this.#last = performance.now();
    this.#wait(0);
  }

  #wait(ms: number): void {
    // A message of a plant's picture goes out with the picture of the screen before it.
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
