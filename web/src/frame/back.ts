// Runs when the server is back: saves the texts that waited for it, and takes over the files that have changed on the disk.
import { drafts } from '../lib/drafts.svelte';
import { files, type OpenFile } from '../lib/files.svelte';
import { t } from '../lib/i18n';
import { runs } from '../lib/runs.svelte';
import { server } from '../lib/server';
import { shell } from '../lib/shell.svelte';
import { together } from '../together/together.svelte';
import { put } from './actions';

/** Saves the texts whose saving waits. */
export async function saveWaiting(): Promise<void> {
  for (const file of files.list) {
    if (file.waits !== null) await put(file, file.waits);
  }
}

/** Takes the text of the disk if nothing was changed here; otherwise the user is asked. */
export async function lookAt(file: OpenFile): Promise<void> {
  const now = await server.read(file.name).catch(() => null);
  if (!now || now.text === file.saved) return;
  if (file.text === now.text || !file.changed) {
    if (file.text !== now.text) await shell.try(() => file.replace(now.text));
    file.saved = now.text;
    file.tag = now.hash;
  } else file.outside = now;
}

/** Goes on with a server that was away; nobody has to click. */
export async function back(): Promise<void> {
  shell.say(t('gone.back'));
  shell.folder = (await server.files().catch(() => null)) ?? shell.folder;
  await saveWaiting();
  for (const file of files.list) if (file.tag !== null && !file.outside && !together.of(file)) await lookAt(file);
  // The server gets the copies that the browser has kept meanwhile.
  for (const file of files.list) if (file.changed) await drafts.keep(file.name, { text: file.text, base: file.tag ?? '' });
  await drafts.look();
  const used = new Set(files.list.flatMap((file) => file.look.uses));
  for (const name of used) if (!files.find(name)) await files.outside(name);
  await runs.back();
}
