// What follows from elsewhere: a changed text is taken over into its run, closed
// files end theirs, and an example that was chosen begins to run by itself.
import { untrack } from 'svelte';
import { files, type OpenFile } from '../lib/files.svelte';
import { t } from '../lib/i18n';
import { runs } from '../lib/runs.svelte';
import { server } from '../lib/server';
import { shell } from '../lib/shell.svelte';

class Begun {
  /** Whether the server, if there is one, is known. */
  ready = $derived(shell.ready);
}

export const begun = new Begun();

/** A text is taken over when no key was pressed for so long. */
const PAUSE = 600;

/** That a change was taken over is not said again and again. */
const OFTEN = 20_000;
let said = -OFTEN;

/** Whether a file can be run, and has something that moves. */
function lively(file: OpenFile): boolean {
  return file.look.plants.length > 0 && !file.changed && !file.look.problems.some((p) => p.severity === 'error');
}

/** Files that were in view before. */
const seen = new Set<string>();

/** Call inside the component that stands above every file in view. */
export function follow(): void {
  // That component comes when a file is chosen in the gallery; or at the beginning,
  // before the page is ready, with the file that was named to the server.
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
        // A dialog does not come between someone and what is being typed.
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
