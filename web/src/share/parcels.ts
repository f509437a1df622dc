// The files of a link: which of them go into one, and where they go when it is opened.
import { drafts } from '../lib/drafts.svelte';
import { exercises } from '../exercise/exercises.svelte';
import { embedded } from '../lib/embedded';
import { files, type OpenFile } from '../lib/files.svelte';
import { t } from '../lib/i18n';
import { beside } from '../lib/paths';
import { server } from '../lib/server';
import { shell } from '../lib/shell.svelte';
import { guests } from './guests';
import { carries, MOST, packed, sizeOf, Unreadable, unpacked, type Leaf, type Parcel } from './links';

/** The file as it is now, with the files that it uses and the pictures of its plants. */
export async function parcelOf(file: OpenFile): Promise<Parcel> {
  await file.settled();
  const uses = (await file.used()).flatMap(({ file: path, text }) => (typeof text === 'string' ? [{ file: beside(file.name, path), text }] : []));
  const pictures: Leaf[] = [];
  for (const name of new Set(file.look.pictures)) {
    const text = await readPicture(file.name, name).catch(() => null);
    if (text !== null) pictures.push({ file: beside(file.name, name), text });
  }
  return { file: file.name, text: file.text, uses, pictures };
}

/** The text of a picture that a file names: that of its exercise, one that came with a link or was drawn in this window, or
 * that of the folder. */
export async function readPicture(file: string, name: string): Promise<string> {
  const path = beside(file, name);
  return (await exercises.picture(file, name)) ?? guests.find(path) ?? (await server.read(path)).text;
}

/** The link from its `#` on; null if the files are too large for one. */
export const linkOf = async (parcel: Parcel): Promise<string | null> => (sizeOf(parcel) > MOST ? null : packed(parcel));

/** Opens the files of the page's address, if it carries some. A link that cannot be read is told; what is open stays as
 * it is. */
export async function openAddress(): Promise<void> {
  const hash = location.hash;
  if (!carries(hash)) return;
  try {
    await openParcel(await unpacked(hash));
  } catch (error) {
    if (!(error instanceof Unreadable)) throw error;
    shell.say(t(`share.${error.why}`), 'error');
  } finally {
    // Loading a window again must not bring the old text back; a frame has nothing else to show.
    if (!embedded && location.hash === hash) history.replaceState(null, '', location.pathname + location.search);
  }
}

/** Opens files that came together: the file itself is shown. */
export async function openParcel({ file, text, uses, pictures }: Parcel): Promise<void> {
  const texts = [...uses, { file, text }];
  const folder = await freeFolder([...texts, ...pictures]);
  for (const leaf of pictures) if (!shell.inFolder(folder + leaf.file)) guests.put(folder + leaf.file, leaf.text);
  // The file itself comes last, so that it is the one that is shown.
  for (const leaf of texts) {
    const name = folder + leaf.file;
    const opened = await (!files.find(name) && shell.inFolder(name) ? files.read(name) : files.open(name, leaf.text));
    // At once: the address is about to forget it.
    if (!embedded && opened.changed) await drafts.keep(opened.name, { text: opened.text, base: opened.tag ?? '' });
  }
  shell.gallery = false;
}

/** The folder for files of a link: none if each can have its own name. A file that is here with another text stays what
 * it is, and those of the link stand in a folder of their own. */
async function freeFolder(all: Leaf[]): Promise<string> {
  for (let n = 0; ; n++) {
    const folder = n === 0 ? '' : `link-${n}/`;
    const free = await Promise.all(all.map((leaf) => fits(folder + leaf.file, leaf.text)));
    if (free.every(Boolean)) return folder;
  }
}

/** True if no file with another text has the name. */
async function fits(name: string, text: string): Promise<boolean> {
  const open = files.find(name)?.text ?? guests.find(name);
  if (open !== undefined) return open === text;
  if (!shell.inFolder(name)) return true;
  return (await server.read(name).catch(() => null))?.text === text;
}
