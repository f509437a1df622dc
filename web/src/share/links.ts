// A link that carries files behind its `#`, where no server sees them: `#g7.1.DATA.g7`. DATA is the JSON of the files,
// compressed (zlib, whose check sum shows damage), as base64url. The end mark shows a cut that a mail program has made,
// and keeps the data from ending with a character that such programs take for punctuation.

/** The version of this form. A later one may hold what this page does not know. */
const VERSION = 1;
const BEGIN = '#g7.';
const END = '.g7';

/** The greatest text of all files together, in code units; a link of a few kB could unpack to gigabytes. */
export const MOST = 4_000_000;

/** A file with its name. */
export interface Leaf {
  file: string;
  text: string;
}

/** A file, with the files that it uses and the pictures of its plants. */
export interface Parcel extends Leaf {
  uses: Leaf[];
  pictures: Leaf[];
}

export const sizeOf = ({ text, uses, pictures }: Parcel): number => [...uses, ...pictures].reduce((sum, leaf) => sum + leaf.text.length, text.length);

/** The link cannot be opened: it was cut or damaged, a later version made it, or it holds too much. */
export class Unreadable extends Error {
  constructor(readonly why: 'cut' | 'later' | 'large') {
    super(why);
  }
}

async function through(bytes: Uint8Array<ArrayBuffer>, change: CompressionStream | DecompressionStream, most: number): Promise<Uint8Array<ArrayBuffer>> {
  const reader = new Blob([bytes]).stream().pipeThrough(change).getReader();
  const parts: Uint8Array<ArrayBuffer>[] = [];
  let size = 0;
  for (let next = await reader.read(); !next.done; next = await reader.read()) {
    parts.push(next.value);
    size += next.value.length;
    if (size <= most) continue;
    await reader.cancel();
    throw new Unreadable('large');
  }
  return new Uint8Array(await new Blob(parts).arrayBuffer());
}

function encoded(bytes: Uint8Array): string {
  let text = '';
  for (const byte of bytes) text += String.fromCharCode(byte);
  return btoa(text).replaceAll('+', '-').replaceAll('/', '_').replace(/=+$/, '');
}

function decoded(text: string): Uint8Array<ArrayBuffer> {
  return Uint8Array.from(atob(text.replaceAll('-', '+').replaceAll('_', '/')), (c) => c.charCodeAt(0));
}

/** The part of a link from the `#` on. */
export async function packed(parcel: Parcel): Promise<string> {
  const bytes = new TextEncoder().encode(JSON.stringify(parcel));
  return `${BEGIN}${VERSION}.${encoded(await through(bytes, new CompressionStream('deflate'), Infinity))}${END}`;
}

/** True if a part of an address behind its `#` is to carry files. */
export const carries = (hash: string): boolean => hash.startsWith(BEGIN);

/** The files of a link. */
export async function unpacked(hash: string): Promise<Parcel> {
  const version = /^\d+(?=\.)/.exec(hash.slice(BEGIN.length))?.[0] ?? '';
  if (Number(version) > VERSION) throw new Unreadable('later');
  try {
    const data = hash.slice(BEGIN.length + version.length + 1, -END.length);
    if (!hash.endsWith(END)) throw new Unreadable('cut');
    // A code unit has up to three bytes, and JSON writes some with two characters.
    const bytes = await through(decoded(data), new DecompressionStream('deflate'), 6 * MOST);
    return checked(JSON.parse(new TextDecoder('utf-8', { fatal: true }).decode(bytes)));
  } catch (error) {
    throw error instanceof Unreadable ? error : new Unreadable('cut');
  }
}

/** A name that leads to no other folder. */
const isName = (name: unknown) => typeof name === 'string' && name !== '' && name.length < 400 && !/^[/\\]|[\0-\x1f]/.test(name) && !name.split(/[/\\]/).includes('..');

function leaf(found: unknown): Leaf {
  const { file, text } = (found ?? {}) as Partial<Leaf>;
  if (!isName(file) || typeof text !== 'string') throw new Unreadable('cut');
  return { file: file as string, text };
}

/** The files, if a page like this one wrote them. */
function checked(found: unknown): Parcel {
  const { uses, pictures } = (found ?? {}) as Partial<Parcel>;
  if (!Array.isArray(uses) || !Array.isArray(pictures)) throw new Unreadable('cut');
  const parcel = { ...leaf(found), uses: uses.map(leaf), pictures: pictures.map(leaf) };
  if (sizeOf(parcel) > MOST) throw new Unreadable('large');
  return parcel;
}
