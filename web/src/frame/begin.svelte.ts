// The beginning: server or playground, the first file, unsaved work of the last time.
import { files, type OpenFile } from '../lib/files.svelte';
import { t } from '../lib/i18n';
import { prefs } from '../lib/prefs.svelte';
import { local } from '../lib/local';
import { server, type Changed } from '../lib/server';
import { shell } from '../lib/shell.svelte';

export async function begin(): Promise<void> {
  // On a narrow window the sides lie over the drawing: they come when they are called.
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

/** A file of the folder is not as it was: take it over where nothing was changed here, else ask. */
async function changedOutside({ path, hash }: Changed): Promise<void> {
  shell.folder = (await shell.try(() => server.files())) ?? shell.folder;
  const file = files.find(path);
  if (!file || file.tag === hash) return;
  const now = await server.read(path).catch(() => null);
  if (!now || now.text === file.saved) return;
  if (file.text === now.text || !file.changed) {
    if (file.text !== now.text) await shell.try(() => file.replace(now.text));
    file.saved = now.text;
    file.tag = now.hash;
  } else file.outside = now;
}

/** Copies that were kept before a crash are opened again, unsaved. */
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

/** Copies of unsaved work: the server's; the browser's where no server keeps any, or it was gone. */
async function drafts(): Promise<{ path: string; text: string }[]> {
  const kept = server.writes ? await server.drafts().catch(() => []) : [];
  // The browser's were kept when the server did not answer: they are later.
  const own = local.all();
  return [...kept.filter((d) => !own.some((o) => o.path === d.path)), ...own];
}

/** Keeps copies of what is not saved, a second after the last change; call once, inside a component. */
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
