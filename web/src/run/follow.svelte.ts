// What follows from elsewhere: a changed text is taken over into its run, closed
// files end theirs, and the first file of a server begins to run by itself.
import { untrack } from 'svelte';
import { files } from '../lib/files.svelte';
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

/** Call once, inside a component. */
export function follow(): void {
  let first = true;
  $effect(() => {
    const file = files.current;
    if (!shell.ready || !file) return;
    untrack(() => {
      const begin = first && file.name === server.info?.start && file.look.plants.length > 0;
      first = false;
      if (!begin || runs.of(file.name)) return;
      if (file.look.problems.some((p) => p.severity === 'error')) return;
      void shell.try(async () => {
        if (await runs.isShared(file.name)) await runs.share(file);
        else await runs.play(await runs.start(file), true);
      });
    });
  });

  $effect(() => {
    const file = files.current;
    const run = runs.current;
    if (!file || !run || run.hash === file.look.hash) return;
    if (file.look.problems.some((p) => p.severity === 'error')) return;
    const timer = setTimeout(() => {
      void shell.try(async () => {
        await runs.swap(file);
        if (run.hash === file.look.hash) shell.say(t('run.swapped'));
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
