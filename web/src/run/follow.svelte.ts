// Reacts to other parts of the page: continues a run with a changed text, ends the runs of closed
// files, and starts an example that was chosen.
import { untrack } from 'svelte';
import { files, type OpenFile } from '../lib/files.svelte';
import { t } from '../lib/i18n';
import { runs } from '../lib/runs.svelte';
import { server } from '../lib/server';
import { shell } from '../lib/shell.svelte';

class Begun {
  /** True if it is known whether there is a server. */
  ready = $derived(shell.ready);
}

export const begun = new Begun();

/** A changed text is taken over after this long without typing, in ms. */
const PAUSE = 600;

/** The notice of a taken-over change appears at most this often, in ms. */
const OFTEN = 20_000;
let said = -OFTEN;

/** True if a file can run and contains something that moves. */
function lively(file: OpenFile): boolean {
  return file.look.plants.length > 0 && !file.changed && !file.look.problems.some((p) => p.severity === 'error');
}

/** Files that were visible before. */
const seen = new Set<string>();

/** Call inside the component that stands above all files. */
export function follow(): void {
  // The component is created when a file is chosen in the gallery; or at the start, before the page
  // is ready, with the file that the server was given.
  let chosen = untrack(() => shell.ready);
  $effect(() => {
    const file = files.current;
    if (!shell.ready || !file) return;
    untrack(() => {
      const named = seen.size === 0 && file.name === server.info?.start;
      const begin = (chosen || named) && !seen.has(file.name) && lively(file) && !runs.of(file.name);
      chosen = false;
      files.list.forEach((f) => seen.add(f.name));
      if (!begin) return;
      void shell.try(async () => {
        if (await runs.isShared(file.name)) await runs.share(file);
        else await runs.play(await runs.start(file), true);
      });
    });
  });

  $effect(() => {
    const file = files.current;
    const run = runs.current;
    if (!file || !run) return;
    if (run.hash === file.look.hash) run.foreign = false;
    if (run.hash === file.look.hash || run.foreign) return;
    if (file.look.problems.some((p) => p.severity === 'error')) return;
    const timer = setTimeout(() => {
      void shell.try(async () => {
        // No dialog interrupts the user while typing.
        const at = document.activeElement;
        await runs.swap(file, false, !!at?.closest('input, textarea, .cm-editor'));
        if (run.hash !== file.look.hash || performance.now() - said < OFTEN) return;
        said = performance.now();
        shell.say(t('run.swapped'));
      });
    }, PAUSE);
    return () => clearTimeout(timer);
  });

  $effect(() => {
    const open = new Set(files.list.map((f) => f.name));
    untrack(() => {
      for (const run of runs.all) if (!open.has(run.file)) void runs.stop(run.file).catch(() => undefined);
    });
  });
}
