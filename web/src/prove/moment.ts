// Plays the run of a failed test, or of a refuted question of an exercise, and stops where it fails.
import { tick } from 'svelte';
import { openSheet } from '../frame/sheets';
import type { OpenFile } from '../lib/files.svelte';
import type { ProofScan } from '../lib/protocol';
import { shape } from '../lib/shape.svelte';
import { shell } from '../lib/shell.svelte';
import { chronogram } from '../run/chronogram.svelte';
import { show } from './play';

/** Plays the run on the text as it is now. The panel on the right stays in front. */
export async function playTo(file: OpenFile, title: string, scans: ProofScan[]): Promise<void> {
  const row = { number: -1, claim: [title, title, title] as [string, string, string], run: scans };
  const front = shell.tabs.right;
  if (shape.phone) openSheet(null);
  else shell.below('chronogram');
  await show(file, row, file.look.hash, (run) => {
    // Puts the cursor of the chronogram at the failure, and moves the drawing to a step that is active there.
    chronogram.a = run.end;
    const [active] = run.active;
    const id = active === undefined ? undefined : run.started.steps[active]?.id;
    if (id) shell.jump(file, id);
    shell.select([]);
    // A new run shows the panel *Operate*; the findings of an exercise are still needed.
    void tick().then(() => {
      if (front) shell.tabs.right = front;
    });
  });
}
