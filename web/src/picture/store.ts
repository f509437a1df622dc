// Where a picture comes from and where it goes: the file beside the chart, and the `view` of its plant in the text.
import { exercises } from '../exercise/exercises.svelte';
import type { OpenFile } from '../lib/files.svelte';
import { t } from '../lib/i18n';
import { page, Refused } from '../lib/page';
import { beside } from '../lib/paths';
import type { Gesture } from '../lib/protocol';
import { wasSaved } from '../lib/pictures.svelte';
import { Conflict, server } from '../lib/server';
import { shell } from '../lib/shell.svelte';
import { guests } from '../share/guests';
import { blank, Sheet } from './sheet.svelte';

/** A picture that is being drawn. */
export interface Drawn {
  file: OpenFile;
  plant: string;
  /** The name in the text, relative to the file of the chart. */
  name: string;
  sheet: Sheet;
  /** The server's hash of the text that was read; null for a new file. */
  hash: string | null;
}

/** Opens the picture of a plant; a plant without one gets an empty sheet. */
export async function openPicture(file: OpenFile, plant: string): Promise<Drawn> {
  await file.settled();
  const { file: name, bindings, names } = await page.call({ do: 'plant_picture', file: file.name, plant });
  if (name === undefined) return { file, plant, name: freeName(file, plant), sheet: new Sheet(blank(plant), bindings, names, true), hash: null };
  if ((await exercises.picture(file.name, name)) !== null) throw new Refused(t('picture.exercise'));
  const path = beside(file.name, name);
  const guest = guests.find(path);
  const { text, hash } = guest === undefined ? await server.read(path) : { text: guest, hash: null };
  return { file, plant, name, sheet: new Sheet(text, bindings, names, false), hash };
}

/** A name for a new picture that no file has. */
function freeName(file: OpenFile, plant: string): string {
  const stem = plant.toLowerCase().replace(/[^a-z0-9]+/g, '-').replace(/^-|-$/g, '') || 'plant';
  const taken = (name: string) => shell.inFolder(beside(file.name, name)) || guests.find(beside(file.name, name)) !== undefined;
  for (let n = 1; ; n++) {
    const name = n === 1 ? `${stem}.svg` : `${stem}-${n}.svg`;
    if (!taken(name)) return name;
  }
}

/** Saves a picture, then says in the text what it shows. Throws if either cannot be done: the text then names no file that
 * is not there, and saving again does the rest. */
export async function savePicture(drawn: Drawn): Promise<void> {
  const { file, plant, sheet } = drawn;
  await file.settled();
  if (!file.look.clean) throw new Refused(t('picture.syntax'));
  const { text } = sheet;
  const gesture: Gesture = { g: 'view', plant, file: drawn.name, bindings: [...sheet.bindings] };
  const path = beside(file.name, drawn.name);
  if (server.writes) {
    try {
      drawn.hash = await server.write(path, text, drawn.hash);
    } catch (error) {
      if (!(error instanceof Conflict)) throw error;
      if (error.text !== text) {
        // Whoever saves again has been told.
        drawn.hash = error.hash;
        throw new Refused(t('picture.conflict', { name: path }));
      }
      drawn.hash = error.hash;
    }
    guests.drop(path);
  } else guests.put(path, text);
  wasSaved(path);
  await file.edit(gesture);
  sheet.isSaved();
}
