// Plays the run of a failed test, or of a refuted question, and stops where it fails.
import { tick } from 'svelte';
import { openSheet } from '../frame/sheets';
import type { OpenFile } from '../lib/files.svelte';
import type { ProofScan } from '../lib/protocol';
import { shape } from '../lib/shape.svelte';
import { shell } from '../lib/shell.svelte';
import { show } from '../prove/play';
import { chronogram } from '../run/chronogram.svelte';

export async function play(file: OpenFile, title: string, scans: ProofScan[]): Promise<void> {
  const row = { number: -1, claim: [title, title, title] as [string, string, string], run: scans };
  if (shape.phone) openSheet(null);
  else shell.below('chronogram');
  await show(file, row, file.look.hash, (run) => {
    // Puts the cursor of the chronogram at the failure, and moves the drawing to a step that is active there.
    chronogram.a = run.end;
    const [active] = run.active;
    const id = active === undefined ? undefined : run.started.steps[active]?.id;
    if (id) shell.jump(file, id);
    shell.select([]);
    // A new run shows the panel *Operate*; the student still needs the findings.
    void tick().then(() => (shell.tabs.right = 'exercise'));
  });
}
