// The palette: the files of `examples/parts` as the page was built, and files of the user that are put on the sheet as parts.
import { t, type Key } from '../lib/i18n';
import { attribute, local, parsed, type Element } from './markup';
import { PART, renamed } from './things';

// The picture of the chart that uses them all is no part.
const files = import.meta.glob<string>(['../../../examples/parts/*.svg', '!../../../examples/parts/gallery.svg'], { query: '?raw', import: 'default', eager: true });

export interface Part {
  id: string;
  text: string;
  width: number;
  height: number;
  style: string;
  /** Only a part of the user's own has one; the others are named in the language of the page. */
  title: string | null;
  body: Element;
}

/** The order of the palette, by what is drawn first; a part that is not named here comes last. */
const ORDER = 'rectangle circle line arrow text lamp traffic-light number gauge button switch sensor motor pump valve cylinder cylinder-single conveyor tank'.split(' ');

/** The part in a file: what is seen in it, as one element. Throws if the file is no picture. */
export function partOf(id: string, text: string, title: string | null): Part {
  const root = parsed(text);
  const [, , width = NaN, height = NaN] = (attribute(root, 'viewBox') ?? '').trim().split(/[\s,]+/).map(Number);
  const size = (n: number, name: string) => (n > 0 ? n : parseFloat(attribute(root, name) ?? '') || 100);
  const style = root.children.filter((e) => local(e) === 'style').map((e) => text.slice(e.open, e.close)).join('\n');
  return { id, text, width: size(width, 'width'), height: size(height, 'height'), style, title, body: root };
}

const base = (path: string): string => path.slice(path.lastIndexOf('/') + 1).replace(/\.svg$/, '');
const rank = (id: string): number => (ORDER.includes(id) ? ORDER.indexOf(id) : ORDER.length);

export const parts: Part[] = Object.entries(files)
  .map(([path, text]) => ({ id: base(path), text }))
  .map(({ id, text }) => partOf(id, text, null))
  .sort((a, b) => rank(a.id) - rank(b.id));

export const partName = (part: Part): string => part.title ?? t(`picture.part.${part.id}` as Key);

/** What a name of the language can be made of: `cylinder-single` gives `cylinder`. */
export const stem = (id: string): string => /^[A-Za-z]+/.exec(id)?.[0].toLowerCase() ?? 'part';

/** What a part file has that is not seen. */
const UNSEEN = new Set(['title', 'style', 'desc', 'metadata']);

/** A part as it is written into a picture, under a name of its own; the names in it begin with that. */
export function written(part: Part, name: string, transform: string): string {
  const elements = part.body.children.filter((e) => !UNSEEN.has(local(e)));
  const inner = elements.map((e) => renamed(part.text, e, (old) => (old === '' ? name : `${name}_${old}`))).join('');
  return `<g ${PART}="${part.id}" transform="${transform}">${elements.length === 1 ? inner : `<g>${inner}</g>`}</g>`;
}
