// Plays the run of a test that fails, or of a question that is refuted, up to the moment where it goes wrong.
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
    // The cursor stands at the moment where it goes wrong, and the step that is active then is in sight.
    chronogram.a = run.end;
    const [active] = run.active;
    const id = active === undefined ? undefined : run.started.steps[active]?.id;
    if (id) shell.jump(file, id);
    shell.select([]);
    // The panel of a new run comes forward, and the findings are still of use.
    void tick().then(() => (shell.tabs.right = 'exercise'));
  });
}
