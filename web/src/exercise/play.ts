// Plays the run of a test that fails, or of a question that is refuted, up to the moment where it goes wrong.
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
    // The cursor stands at the moment where it goes wrong.
    chronogram.a = run.end;
  });
}
