// The things on the sheet, read from the text of the picture. A thing is an element that is moved, bound and deleted as a
// whole: a part of the palette, or an element that was drawn elsewhere. Below: `markup.ts`, the text; above: `sheet.svelte.ts`.
import { attribute, indentOf, inside, local, parsed, spliced, Unreadable, wholeOf, withAttribute, type Element, type Splice } from './markup';
import { frameOf, transformOf, type Frame } from './frame';
import { offersOf, type Offer } from './effects';

export interface Thing {
  element: Element;
  /** The frame that the editor gave it; none if it was never moved. */
  frame: Frame | null;
  /** The part of the palette that it is. */
  part: string | null;
  /** The names in it that bindings can have. */
  names: string[];
  offers: Offer[];
  /** The texts in it that its user writes. */
  labels: Element[];
  /** The signals that it lets a hand turn. */
  hands: { element: Element; attribute: 'data-g7-press' | 'data-g7-click'; signal: string }[];
}

export interface Picture {
  text: string;
  root: Element;
  /** The element in which the things stand: the root, or the only layer of a drawing program. */
  layer: Element;
  things: Thing[];
}

/** Elements that are not to be seen by themselves. */
const HIDDEN = new Set(['title', 'desc', 'metadata', 'style', 'defs', 'symbol', 'linearGradient', 'radialGradient', 'clipPath', 'mask', 'pattern', 'marker', 'filter', 'script', 'namedview']);

/** The attributes that the frame of a thing may have. */
const OF_FRAME = new Set(['transform', 'data-g7-part', 'style']);

export const NAME = 'data-g7';
export const PART = 'data-g7-part';
export const STYLE = 'data-g7-style';

/** An element with a prefix belongs to the program that drew the picture. */
const shown = (element: Element): Element[] => element.children.filter((child) => !HIDDEN.has(local(child)) && !child.name.includes(':'));

/** The picture of a text; throws if it is none. */
export function pictureOf(text: string): Picture {
  const root = parsed(text);
  // The editor writes elements without a prefix, which would be no SVG there.
  if (root.name !== 'svg') throw new Unreadable(`<${root.name}`);
  const layer = layerOf(root);
  return { text, root, layer, things: shown(layer).map(thing) };
}

/** Drawing programs put all into one layer, which nobody wants to move as a whole. */
function layerOf(root: Element): Element {
  const [only, ...more] = shown(root);
  const plain = only && more.length === 0 && local(only) === 'g' && !only.attributes.some((a) => a.name === 'transform' || a.name.startsWith('data-g7'));
  return plain && shown(only).length > 1 ? only : root;
}

function thing(element: Element): Thing {
  const frame = framedBy(element);
  const all = [...inside(element)];
  const names = [...new Set(all.flatMap((e) => attribute(e, NAME) || []))];
  const hands = all.flatMap((element) =>
    (['data-g7-press', 'data-g7-click'] as const).flatMap((name) => {
      const signal = attribute(element, name);
      return signal === undefined ? [] : [{ element, attribute: name, signal }];
    }),
  );
  const labels = all.filter((e) => attribute(e, 'data-g7-label') !== undefined || (e === contentOf(element, frame) && local(e) === 'text' && e.children.length === 0));
  return { element, frame, part: attribute(element, PART) ?? null, names, offers: offersOf(all), labels, hands };
}

function framedBy(element: Element): Frame | null {
  if (local(element) !== 'g' || element.children.length !== 1 || !element.attributes.every((a) => OF_FRAME.has(a.name))) return null;
  return frameOf(attribute(element, 'transform'));
}

const contentOf = (element: Element, frame: Frame | null): Element => (frame ? (element.children[0] ?? element) : element);

/** What a binding of a whole thing moves: it has no transform of its own, which the page would turn about the wrong place. */
export const content = (thing: Thing): Element => contentOf(thing.element, thing.frame);

/** The changes that put a thing into a frame. */
export function withFrame(text: string, { element, frame }: Thing, to: Frame): Splice[] {
  const transform = transformOf(to);
  if (frame) return withAttribute(text, element, 'transform', transform);
  return [
    { from: element.from, to: element.from, insert: `<g transform="${transform}">` },
    { from: element.to, to: element.to, insert: '</g>' },
  ];
}

/** The text with a mark round each thing, by which the page finds it. */
export function marked(picture: Picture): string {
  return spliced(
    picture.text,
    picture.things.flatMap(({ element, frame }, n) =>
      frame
        ? withAttribute(picture.text, element, 'data-thing', String(n))
        : [
            { from: element.from, to: element.from, insert: `<g data-thing="${n}">` },
            { from: element.to, to: element.to, insert: '</g>' },
          ],
    ),
  );
}

/** A name of the picture that nothing has yet: `lamp1`, or the first free one behind it. */
export function freeName(picture: Picture, base: string, also: ReadonlySet<string> = new Set()): string {
  const taken = new Set([...inside(picture.root)].flatMap((e) => attribute(e, NAME) ?? []));
  const free = (name: string) => ![...taken, ...also].some((t) => t === name || t.startsWith(`${name}_`));
  for (let n = 1; ; n++) if (free(`${base}${n}`)) return `${base}${n}`;
}

/** The changes that put a text behind the last thing of the picture. */
export function appended(picture: Picture, written: string): Splice[] {
  const { text, layer } = picture;
  const last = layer.children.at(-1);
  const indent = last ? indentOf(text, last.from) : `${indentOf(text, layer.from)}  `;
  if (layer.close === layer.to) {
    // The picture is one tag that closes itself.
    const slash = text.lastIndexOf('/', layer.to);
    return [{ from: slash, to: layer.to, insert: `>\n${indent}${written}\n</${layer.name}>` }];
  }
  const at = last?.to ?? layer.open;
  const follows = text.slice(at, layer.close).includes('\n') ? '' : '\n';
  return [{ from: at, to: at, insert: `\n${indent}${written}${follows}` }];
}

/** The changes that put a style before everything that is seen. */
export function withStyle(picture: Picture, part: string, style: string): Splice[] {
  const { text, root } = picture;
  if (!style || [...inside(root)].some((e) => attribute(e, STYLE) === part)) return [];
  const title = root.children.find((child) => local(child) === 'title');
  const at = title?.to ?? root.open;
  const indent = root.children[0] ? indentOf(text, root.children[0].from) : '  ';
  return [{ from: at, to: at, insert: `\n${indent}<style ${STYLE}="${part}">${style}</style>` }];
}

/** The changes that take things away, and the styles that only they needed. */
export function without(picture: Picture, gone: ReadonlySet<number>): Splice[] {
  const { text, root, things } = picture;
  const left = new Set(things.filter((_, n) => !gone.has(n)).map((t) => t.part));
  const lost = new Set(things.filter((t, n) => gone.has(n) && t.part !== null && !left.has(t.part)).map((t) => t.part));
  const styles = root.children.filter((e) => lost.has(attribute(e, STYLE) ?? null));
  const elements = [...styles, ...things.filter((_, n) => gone.has(n)).map((t) => t.element)];
  return elements.map((e) => ({ ...wholeOf(text, e), insert: '' }));
}

/** The text of an element under new names, each of them by `rename`. */
export function renamed(text: string, element: Element, rename: (name: string) => string): string {
  const splices = [...inside(element)].flatMap((e) => {
    const name = attribute(e, NAME);
    return name === undefined ? [] : withAttribute(text, e, NAME, rename(name));
  });
  const own = text.slice(element.from, element.to);
  return spliced(own, splices.map((s) => ({ ...s, from: s.from - element.from, to: s.to - element.from })));
}

/** The size of the sheet: its `viewBox`, or width and height where it has none. */
export function sizeOf({ root }: Picture): { x: number; y: number; width: number; height: number } {
  const box = (attribute(root, 'viewBox') ?? '').trim().split(/[\s,]+/).map(Number);
  const [x = NaN, y = NaN, width = NaN, height = NaN] = box;
  if ([x, y].every(Number.isFinite) && width > 0 && height > 0) return { x, y, width, height };
  const length = (name: string, usual: number) => {
    const n = parseFloat(attribute(root, name) ?? '');
    return n > 0 ? n : usual;
  };
  return { x: 0, y: 0, width: length('width', 300), height: length('height', 150) };
}
