// Plays the run of an answer on the chart: from its first scan to its last, where it stays.
import { chronogram } from '../run/chronogram.svelte';
import type { OpenFile } from '../lib/files.svelte';
import { proofs, type Played } from '../lib/proofs.svelte';
import type { ProofRow } from '../lib/protocol';
import { runs, type Run } from '../lib/runs.svelte';
import { shell } from '../lib/shell.svelte';

/** The time that a scan is seen, in ms; less where the run is long. */
const SEEN = 500;
/** The longest time that a run takes to be shown, in ms. */
const WHOLE = 5_000;
/** A step of the show is seen at least so long; of longer runs not every scan is seen. */
const LEAST = 120;

const wait = (ms: number) => new Promise((done) => setTimeout(done, ms));

export function play(file: OpenFile, row: ProofRow): Promise<void> {
  return show(file, row, proofs.asked(file));
}

/** Plays a run of the text of this hash; `before` is done when it is there, and before it is seen. */
export async function show(file: OpenFile, row: Played, hash: string, before: (run: Run) => void = () => undefined): Promise<void> {
  await shell.try(async () => {
    const run = await proofs.play(file, row, hash);
    if (!run) return;
    const id = row.blame?.[0] ?? row.id;
    if (id) shell.jump(file, id);
    shell.select([]);
    chronogram.whole(run);
    before(run);
    await walk(run, row.run?.length ?? 0);
  });
}

/** Goes through the scans. Whoever moves the run meanwhile, or shows another one, ends the walk. */
async function walk(run: Run, scans: number): Promise<void> {
  if (scans < 2 || matchMedia('(prefers-reduced-motion: reduce)').matches) return;
  const period = run.started.period_ms;
  const seen = Math.max(LEAST, Math.min(SEEN, WHOLE / scans));
  const stride = Math.max(1, Math.ceil((scans * seen) / WHOLE));
  const mine = (at: number) => proofs.playing?.run === run && Math.abs(run.now - at) < period / 2;
  for (let scan = 0; scan < scans - 1; scan += stride) {
    await runs.send(run, { do: 'run_seek', ms: scan * period });
    await wait(seen);
    if (!mine(scan * period)) return;
  }
  await runs.send(run, { do: 'run_live' });
}
