// Unsaved work is had back: at the start of the page, and when the user asks for it.
import { drafts, type Draft, type DraftRow } from '../lib/drafts.svelte';
import { files, type OpenFile } from '../lib/files.svelte';
import { t } from '../lib/i18n';
import { shell } from '../lib/shell.svelte';

/** Opens the work of this window, and that of windows that have gone. A file that another window of the same person has
 * open is left to it. */
export async function recover(): Promise<void> {
  await drafts.look();
  const all = drafts.rows;
  for (const path of new Set(all.map((row) => row.path))) {
    const rows = all.filter((row) => row.path === path);
    // The browser's copies were made while the server did not answer, so they are newer.
    const first = (holder: DraftRow['holder']) =>
      rows.find((row) => row.holder === holder && row.kept === 'browser') ?? rows.find((row) => row.holder === holder);
    const open = rows.some((row) => row.holder === 'other' && !row.person);
    const row = first('this') ?? (open ? undefined : first('gone'));
    const draft = row && (await shell.try(() => drafts.take(row)));
    if (draft && (await shown(draft, files.current))) shell.say(t('app.recovered', { name: path }));
  }
}

/** Opens a copy as unsaved changes. The changes that its file has now are kept as closed ones. */
export async function restore(row: DraftRow): Promise<void> {
  const file = files.find(row.path);
  if (file?.changed) await drafts.keep(file.name, { text: file.text, base: file.tag ?? '' }, 'closed');
  const draft = await shell.try(() => (row.holder === 'closed' ? drafts.read(row) : drafts.take(row)));
  if (!draft) return;
  shell.gallery = false;
  await shown(draft);
}

/** Opens a copy as the unsaved text of its file, and shows that or another file; false if it is no other text than that
 * of the file. */
async function shown({ path, text, base, waits }: Draft, seen: OpenFile | null = null): Promise<boolean> {
  const open = files.find(path);
  const known = open ? open.saved !== null : shell.inFolder(path);
  const file = await shell.try(() => (known ? files.read(path) : files.open(path, text)));
  if (!file) return false;
  files.current = seen ?? file;
  if (known && file.saved === text) {
    if (file.text !== text) await shell.try(() => file.replace(text));
    await drafts.saved(path);
    return false;
  }
  if (file.text !== text) await shell.try(() => file.replace(text));
  file.recovered = true;
  file.waits = waits ?? null;
  if (known && base !== null && base !== file.tag) {
    // The file was changed since: saving asks what is to be done.
    file.outside = { text: file.saved ?? '', hash: file.tag ?? '' };
    file.saved = null;
    file.tag = base || null;
  }
  return true;
}
