// The start of the page: finds the server or the playground, opens the first file, restores unsaved
// work.
import { afterChanges } from '../lib/changes.svelte';
import { drafts } from '../lib/drafts.svelte';
import { embedded } from '../lib/embedded';
import { files, type OpenFile } from '../lib/files.svelte';
import { local } from '../lib/local';
import { prefs } from '../lib/prefs.svelte';
import { server, type Changed } from '../lib/server';
import { shell } from '../lib/shell.svelte';
import { runs } from '../lib/runs.svelte';
import { carries } from '../share/links';
import { openAddress } from '../share/parcels';
import { together } from '../together/together.svelte';
import { back, lookAt, saveWaiting } from './back';
import { recover } from './recover';

export async function begin(): Promise<void> {
  // In a narrow window the sides lie over the drawing, so they are closed at first.
  const narrow = matchMedia('(max-width: 1000px)');
  const shut = () => narrow.matches && (prefs.leftOpen = prefs.rightOpen = false);
  narrow.addEventListener('change', shut);
  shut();
  await shell.try(() => server.begin());
  shell.folder = (await shell.try(() => server.files())) ?? [];
  server.hear((message) => {
    const changed = message.changed as Changed | undefined;
    if (changed) void changedOutside(changed);
    if (message.drafts) drafts.soon();
  });
  let lost = false;
  server.link((up) => {
    if (up && lost) void shell.try(back);
    if (!up) runs.lost();
    lost = !up;
  });
  local.hear(() => drafts.soon());
  const start = carries(location.hash) ? undefined : server.info?.start;
  const wished = new URL(location.href).searchParams.get('file') ?? start;
  if (wished) await shell.try(() => files.read(wished));
  // A frame in another page keeps no unsaved work.
  if (!embedded) await recover();
  // Behind that, because unsaved work may have the name of a file in the link, and stays.
  await shell.try(openAddress);
  void shell.try(() => together.begin());
  shell.ready = true;
  addEventListener('hashchange', () => void shell.try(openAddress));
  if (!embedded) await saveWaiting();
}

/** A file of the folder has changed: takes the new text if nothing was changed here, otherwise
 * asks. */
async function changedOutside({ path, hash }: Changed): Promise<void> {
  shell.folder = (await shell.try(() => server.files())) ?? shell.folder;
  const file = files.find(path);
  if (!file) return files.outside(path);
  if (file.tag === hash || (await together.outside(file, hash))) return;
  await lookAt(file);
  if (!file.outside) together.saved(file);
}

/** Keeps copies of unsaved work, one second after a change; call once, inside a component. */
export function keepDrafts(): void {
  if (embedded) return;
  afterChanges(1000, (file) => [file.text, file.changed], (file) => void keep(file));
}

async function keep(file: OpenFile): Promise<void> {
  if (!files.list.includes(file)) return;
  if (file.changed) await drafts.keep(file.name, { text: file.text, base: file.tag ?? '', waits: file.waits });
  else await drafts.undone(file.name, file.saved);
}
