// Going back in time in a recorded run: by the slider of the run bar and by the times of the chronogram.
import { runs, type Run } from '../lib/runs.svelte';
import { shell } from '../lib/shell.svelte';

/** The instants that are wished and not yet asked for, in ms. */
const wished = new WeakMap<Run, number>();
const busy = new WeakSet<Run>();

/** Shows a run as it was at an instant, in ms. While an answer is on its way, only the latest wish is kept. */
export async function seek(run: Run, ms: number): Promise<void> {
  wished.set(run, Math.max(0, Math.min(ms, run.end)));
  if (busy.has(run)) return;
  busy.add(run);
  for (let to = wished.get(run); to !== undefined; to = wished.get(run)) {
    wished.delete(run);
    const at: number = to;
    await shell.try(async () => {
      if (run.playing) await runs.play(run, false);
      await runs.send(run, { do: 'run_seek', ms: at });
    });
  }
  busy.delete(run);
}
