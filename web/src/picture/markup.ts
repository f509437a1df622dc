// The text of a picture, read only as far as the editor changes it: where each element and each of its attributes stands.
// It stands below everything else of the picture editor. Every change is a splice of the text, so what nobody changed
// stays to the byte, whatever it means.

/** An attribute; `from` and `to` are the places of its name and of its end. */
export interface Attribute {
  name: string;
  value: string;
  from: number;
  to: number;
}

export interface Element {
  name: string;
  from: number;
  to: number;
  /** The end of its start tag, behind the `>`. */
  open: number;
  /** The start of its end tag; that of its end if it has none. */
  close: number;
  attributes: Attribute[];
  children: Element[];
}

export interface Splice {
  from: number;
  to: number;
  insert: string;
}

/** The text is no picture, or not one that can be read. */
export class Unreadable extends Error {}

const ENTITIES: Record<string, string> = { lt: '<', gt: '>', amp: '&', quot: '"', apos: "'" };

const decoded = (text: string): string =>
  text.replace(/&(?:#x([\da-f]+)|#(\d+)|(\w+));/gi, (whole, hex?: string, decimal?: string, name?: string) => {
    if (name !== undefined) return ENTITIES[name] ?? whole;
    const code = parseInt(hex ?? decimal ?? '', hex === undefined ? 10 : 16);
    return code > 0 && code <= 0x10ffff ? String.fromCodePoint(code) : whole;
  });

/** A text as it stands in an attribute or between tags. */
export const encoded = (text: string): string => text.replace(/[&<>"]/g, (c) => ({ '&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;' })[c] ?? c);

const ATTRIBUTE = /\s*([^\s=>/"'<]+)\s*=\s*("[^"]*"|'[^']*')/y;
const NAME = /<([^\s/>"'=<]+)/y;
/** What is no element: its start and its end. */
const APART: [string, string][] = [
  ['<!--', '-->'],
  ['<![CDATA[', ']]>'],
  ['<?', '?>'],
];

/** The end of a declaration of the document's type, which may have brackets with others in it. */
function endOfDoctype(text: string, at: number): number {
  const bracket = text.indexOf('[', at);
  const end = text.indexOf('>', at);
  if (bracket < 0 || bracket > end) return end + 1;
  return text.indexOf('>', text.indexOf(']', bracket)) + 1;
}

/** The outermost element of a text; throws [`Unreadable`] where the tags do not fit. */
export function parsed(text: string): Element {
  const open: Element[] = [];
  let root: Element | null = null;
  let at = 0;
  for (;;) {
    at = text.indexOf('<', at);
    if (at < 0) break;
    const apart = APART.find(([start]) => text.startsWith(start, at));
    if (apart) {
      const end = text.indexOf(apart[1], at + apart[0].length);
      if (end < 0) throw new Unreadable(apart[0]);
      at = end + apart[1].length;
    } else if (text.startsWith('<!', at)) {
      const end = endOfDoctype(text, at);
      if (end <= at) throw new Unreadable('<!');
      at = end;
    } else if (text.startsWith('</', at)) {
      const element = open.pop();
      const end = text.indexOf('>', at);
      if (!element || end < 0 || text.slice(at + 2, end).trim() !== element.name) throw new Unreadable(text.slice(at, at + 40));
      element.close = at;
      element.to = at = end + 1;
    } else {
      const element = startTag(text, at);
      const within = open.at(-1);
      if (within) within.children.push(element);
      else if (root) throw new Unreadable(`<${element.name}`);
      else root = element;
      at = element.open;
      if (element.to === 0) open.push(element);
    }
  }
  if (!root || open.length > 0 || local(root) !== 'svg') throw new Unreadable(open.at(-1)?.name ?? 'svg');
  return root;
}

/** The element of a start tag; one that is not closed there has the end 0. */
function startTag(text: string, from: number): Element {
  NAME.lastIndex = from;
  const name = NAME.exec(text)?.[1];
  if (name === undefined) throw new Unreadable(text.slice(from, from + 40));
  const attributes: Attribute[] = [];
  let at = from + 1 + name.length;
  for (;;) {
    ATTRIBUTE.lastIndex = at;
    const found = ATTRIBUTE.exec(text);
    if (!found) break;
    const [whole, key = '', value = ''] = found;
    at += whole.length;
    attributes.push({ name: key, value: decoded(value.slice(1, -1)), from: at - whole.trimStart().length, to: at });
  }
  const end = /\s*(\/?)>/y;
  end.lastIndex = at;
  const found = end.exec(text);
  if (!found) throw new Unreadable(text.slice(from, from + 40));
  const open = at + found[0].length;
  return { name, from, open, close: found[1] ? open : 0, to: found[1] ? open : 0, attributes, children: [] };
}

/** The name without its prefix. */
export const local = (element: Element): string => element.name.slice(element.name.indexOf(':') + 1);

export const attribute = (element: Element, name: string): string | undefined => element.attributes.find((a) => a.name === name)?.value;

/** An element and all in it, in the order of the text. */
export function* inside(element: Element): Generator<Element> {
  yield element;
  for (const child of element.children) yield* inside(child);
}

/** The change that gives an attribute a value, or takes the attribute away. */
export function withAttribute(text: string, element: Element, name: string, value: string | null): Splice[] {
  const there = element.attributes.find((a) => a.name === name);
  if (value === null) {
    if (!there) return [];
    const before = text.slice(0, there.from);
    return [{ from: there.from - (before.length - before.trimEnd().length), to: there.to, insert: '' }];
  }
  if (there?.value === value) return [];
  const written = `${name}="${encoded(value)}"`;
  if (there) return [{ from: there.from, to: there.to, insert: written }];
  const at = element.attributes.at(-1)?.to ?? element.from + 1 + element.name.length;
  return [{ from: at, to: at, insert: ` ${written}` }];
}

/** The text after changes, which do not overlap. */
export function spliced(text: string, splices: readonly Splice[]): string {
  let out = '';
  let at = 0;
  const sorted = splices.map((s, i) => ({ s, i })).sort((a, b) => a.s.from - b.s.from || a.i - b.i);
  for (const { s } of sorted) {
    out += text.slice(at, s.from) + s.insert;
    at = Math.max(at, s.to);
  }
  return out + text.slice(at);
}

/** The place of an element with the white space before it, so that a line of its own goes as a whole. */
export function wholeOf(text: string, { from, to }: { from: number; to: number }): { from: number; to: number } {
  const before = text.slice(0, from);
  const line = /\r?\n[ \t]*$/.exec(before);
  return { from: line ? line.index : from, to };
}

/** The white space with which the line of a place begins. */
export const indentOf = (text: string, at: number): string => /(?:^|\n)([ \t]*)[^\n]*$/.exec(text.slice(0, at))?.[1] ?? '';
