// The start of the page: finds the server or the playground, opens the first file, restores unsaved
// work.
import { files, type OpenFile } from '../lib/files.svelte';
import { t } from '../lib/i18n';
import { prefs } from '../lib/prefs.svelte';
import { local } from '../lib/local';
import { server, type Changed } from '../lib/server';
import { shell } from '../lib/shell.svelte';

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
  });
  const wished = new URL(location.href).searchParams.get('file') ?? server.info?.start;
  if (wished) await shell.try(() => files.read(wished));
  await recover();
  shell.ready = true;
}

/** A file of the folder has changed: takes the new text if nothing was changed here, otherwise
 * asks. */
async function changedOutside({ path, hash }: Changed): Promise<void> {
  shell.folder = (await shell.try(() => server.files())) ?? shell.folder;
  const file = files.find(path);
  if (!file) return files.outside(path);
  if (file.tag === hash) return;
  const now = await server.read(path).catch(() => null);
  if (!now || now.text === file.saved) return;
  if (file.text === now.text || !file.changed) {
    if (file.text !== now.text) await shell.try(() => file.replace(now.text));
    file.saved = now.text;
    file.tag = now.hash;
  } else file.outside = now;
}

/** Opens the copies that were kept before a crash, as unsaved files. */
async function recover(): Promise<void> {
  for (const draft of await drafts()) {
    const known = shell.folder.some((f) => f.path === draft.path);
    const file = known
      ? await shell.try(() => files.read(draft.path))
      : await shell.try(() => files.open(draft.path, draft.text));
    if (!file) continue;
    if (known && file.text === draft.text) continue;
    if (file.text !== draft.text) await shell.try(() => file.replace(draft.text));
    shell.say(t('app.recovered', { name: draft.path }));
  }
}

/** The copies of unsaved work: those of the server; those of the browser if there is no server or
 * it was away. */
async function drafts(): Promise<{ path: string; text: string }[]> {
  const kept = server.writes ? await server.drafts().catch(() => []) : [];
  // The browser's copies were made while the server did not answer, so they are newer.
  const own = local.all();
  return [...kept.filter((d) => !own.some((o) => o.path === d.path)), ...own];
}

/** Keeps copies of unsaved work, one second after the last change; call once, inside a component.
 * */
export function keepDrafts(): void {
  const timers = new Map<string, ReturnType<typeof setTimeout>>();
  $effect(() => {
    for (const file of files.list) {
      const { name, text } = file;
      const changed = file.changed;
      clearTimeout(timers.get(name));
      timers.set(
        name,
        setTimeout(() => void keep(file, changed ? text : null), 1000),
      );
    }
  });
}

async function keep(file: OpenFile, text: string | null): Promise<void> {
  if (!files.list.includes(file)) return;
  let kept = false;
  if (server.writes) {
    const asked = text === null ? server.dropDraft(file.name) : server.keepDraft(file.name, text);
    kept = await asked.then(
      () => true,
      () => false,
    );
  }
  local.put(file.name, kept ? null : text);
}
