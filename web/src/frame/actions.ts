// The operations of the frame on files.
import { drafts } from '../lib/drafts.svelte';
import { files, type OpenFile } from '../lib/files.svelte';
import { t } from '../lib/i18n';
import { page } from '../lib/page';
import { base } from '../lib/paths';
import { Conflict, Gone, server } from '../lib/server';
import { shell } from '../lib/shell.svelte';
import { together } from '../together/together.svelte';

/** A first file: one chart with one step, on which the user can build. */
const FIRST = 'chart G1 {\n  initial step 0\n}\n';

/** Saves the text with every change that was asked for before, such as an undo still under way. */
export async function save(file: OpenFile): Promise<void> {
  await file.settled();
  if (!server.writes) {
    download(file);
    return;
  }
  await put(file, file.text);
}

/** Saves a text of a file, and says what became of it. Without a connection it waits until the server is back. */
export async function put(file: OpenFile, text: string): Promise<void> {
  try {
    await files.save(file, text);
    together.saved(file);
    shell.say(t('app.saved', { name: file.name }));
  } catch (error) {
    if (error instanceof Gone && text !== file.saved) {
      file.waits = text;
      // Kept at once, so that loading the page again loses neither the text nor the wish.
      await drafts.keep(file.name, { text: file.text, base: file.tag ?? '', waits: text });
      shell.say(t('gone.waits', { name: file.name }));
      return;
    }
    file.waits = null;
    if (error instanceof Conflict) {
      file.outside = { text: error.text, hash: error.hash };
      if (file !== files.current) shell.say(t('app.outside', { name: file.name }), 'error');
    } else shell.say((error as Error).message, 'error');
  }
}

/** Downloads the text as a file. */
export function download(file: OpenFile): void {
  handOut(base(file.name), file.text, 'text/plain');
}

export function handOut(name: string, content: BlobPart, type: string): void {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([content], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** Closes a file; one that has something to lose asks first. */
export function close(file: OpenFile): void {
  if (file.loses) {
    shell.closing = file;
    shell.dialog = 'close';
  } else void shell.try(() => files.close(file));
}

/** Adds a chart and shows it, with its first step selected. */
export async function newChart(file: OpenFile): Promise<void> {
  const before = new Set(file.look.charts.map((c) => c.name));
  const edited = await shell.try(() => file.edit({ g: 'add_chart', kind: 'chart' }));
  const made = file.look.charts.find((c) => !before.has(c.name));
  if (!edited || !made) return;
  shell.show(file, made.name);
  shell.select(edited.select ?? []);
  shell.keysToDrawing();
}

export function newFile(): void {
  let n = 1;
  const taken = (name: string) => files.find(name) || shell.inFolder(name);
  while (taken(`new-${n}.g7`)) n++;
  shell.gallery = false;
  void shell.try(() => files.open(`new-${n}.g7`, FIRST)).then(() => shell.keysToDrawing());
}

/** Opens a file of the user's machine. */
export async function openLocal(input: HTMLInputElement): Promise<void> {
  const chosen = input.files?.[0];
  input.value = '';
  if (!chosen) return;
  await openText(chosen.name, await chosen.text());
}

/** Opens a text from elsewhere: a .g7 file or a chart of another tool; the page recognizes it by
 * its content. */
export async function openText(name: string, text: string): Promise<void> {
  const file = await shell.try(() => files.open(name, text));
  if (!file) return;
  if (!file.look.imported && !/\.g7$/i.test(name)) {
    shell.say(t('start.notOurs', { name }), 'error');
    await shell.try(() => files.close(file));
  } else shell.gallery = false;
}

/** Takes the text from the disk, as one edit that can be undone. */
export async function takeTheirs(file: OpenFile): Promise<void> {
  const outside = file.outside;
  if (!outside) return;
  await shell.try(() => file.replace(outside.text));
  file.saved = outside.text;
  file.tag = outside.hash;
  file.outside = null;
  together.saved(file);
}

/** Merges both versions if they changed different lines; otherwise the question stays. */
export async function mergeBoth(file: OpenFile): Promise<void> {
  const outside = file.outside;
  const base = file.saved;
  if (!outside || base === null) return;
  const merged = await shell.try(() => page.call({ do: 'merge', base, mine: file.text, theirs: outside.text }));
  if (!merged || file.outside !== outside) return;
  const { text } = merged;
  if (text === null) {
    shell.say(t('app.outside.clash'), 'error');
    return;
  }
  await shell.try(() => file.replace(text));
  file.saved = outside.text;
  file.tag = outside.hash;
  file.outside = null;
  together.saved(file);
  shell.say(t('app.outside.merged'));
}

/** Keeps our text; saving will overwrite the version on the disk, which the user has seen now. */
export function keepMine(file: OpenFile): void {
  if (!file.outside) return;
  file.saved = file.outside.text;
  file.tag = file.outside.hash;
  file.outside = null;
  together.saved(file);
}
