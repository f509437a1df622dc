// The effects that a variable can have: those that a part offers, those that every thing has, and the value that makes a variable
// fit one. The effects themselves are those of `run/bindings.ts`; nothing here is new to the language.
import type { PictureBinding, PictureName } from '../lib/protocol';
import { attribute, type Element } from './markup';

export type Kind = 'bool' | 'number' | 'any' | 'press' | 'click';

export interface Offer {
  /** The element by its name; null for the thing as a whole, which may not have a name yet. */
  element: string | null;
  attribute: string;
  kind: Kind;
  /** What the attribute is at the two ends of the range of its variable. */
  from: number;
  to: number;
}

/** The attribute of an element of a part that names its effects: `on:bool dx:number:0:40`. */
export const EFFECTS = 'data-g7-effects';

const KINDS = new Set<string>(['bool', 'number', 'any']);

/** The effects that the elements of a thing say they have, then those of every thing. */
export function offersOf(elements: readonly Element[]): Offer[] {
  const own = elements.flatMap((e) =>
    (attribute(e, EFFECTS) ?? '').split(/\s+/).flatMap((word): Offer[] => {
      const [name = '', kind = '', from = '0', to = '1'] = word.split(':');
      if (name === 'press' || name === 'click') return [{ element: attribute(e, 'data-g7') ?? null, attribute: name, kind: name, from: 0, to: 1 }];
      const element = attribute(e, 'data-g7');
      return name && element && KINDS.has(kind) ? [{ element, attribute: name, kind: kind as Kind, from: Number(from), to: Number(to) }] : [];
    }),
  );
  const whole = GENERAL.filter((g) => !own.some((o) => o.attribute === g.attribute && (g.kind === 'press' || g.kind === 'click')));
  return [...own, ...whole];
}

const general = (attribute: string, kind: Kind, to = 1): Offer => ({ element: null, attribute, kind, from: 0, to });

const GENERAL: Offer[] = [
  general('visible', 'bool'),
  general('on', 'bool'),
  general('dx', 'number', 100),
  general('dy', 'number', -100),
  general('rotate', 'number', 360),
  general('opacity', 'number'),
  general('press', 'press'),
  general('click', 'click'),
];

/** True if the effect can follow this variable. */
export function fits(offer: Offer, name: PictureName): boolean {
  if (offer.kind === 'press' || offer.kind === 'click') return name.hand;
  if (name.value === '') return false;
  if (offer.kind === 'any') return true;
  return offer.kind === 'bool' ? name.type === 'bool' : name.type === 'int' || name.type === 'real';
}

/** The ends of a variable's range. */
export type Range = [from: number, to: number];

export const USUAL: Range = [0, 100];

/** The range that the limits of a state say, if they are numbers. */
export function rangeOf(name: PictureName): Range | null {
  const [a = NaN, b = NaN] = (name.limits ?? []).map((text) => Number(text.replaceAll('_', '')));
  return Number.isFinite(a) && Number.isFinite(b) && a !== b ? [a, b] : null;
}

/** A number as a REAL of the text. */
function real(n: number): string {
  const text = String(Math.round(n * 1e6) / 1e6);
  return /[.e]/.test(text) ? text : `${text}.0`;
}

const plus = (n: number): string => (n < 0 ? ` - ${real(-n)}` : ` + ${real(n)}`);

/** The name, or the expression in parentheses where it is more than a name. */
const term = (value: string): string => (/^[\w.`]+$/.test(value) ? value : `(${value})`);

/** The value that takes the attribute from one end of its range to the other as the variable goes through its own. */
export function scaled(value: string, { from, to }: Offer, [a, b]: Range): string {
  const [span, range] = [to - from, b - a];
  const shifted = a === 0 ? term(value) : `(${term(value)}${plus(-a)})`;
  const times = span === range ? '' : span === 1 ? '' : ` * ${real(span)}`;
  const over = span === range || range === 1 ? '' : ` / ${real(range)}`;
  return `${shifted}${times}${over}${from === 0 ? '' : plus(from)}`;
}

/** The range for which [`scaled`] makes this value; null if someone wrote another one. */
export function unscaled(written: string, value: string, offer: Offer): Range | null {
  const at = term(value);
  const shift = written.startsWith(at) ? 0 : Number(/^ ([+-]) ([\d.e+-]+)\)/.exec(written.slice(at.length + 1))?.slice(1).join('') ?? NaN);
  const range = Number(/ \/ ([\d.e+-]+)/.exec(written)?.[1] ?? (written.includes(' * ') ? 1 : offer.to - offer.from));
  const found: Range[] = [[-shift + 0, -shift + range], [-shift + 0, -shift + 1]];
  return found.find((r) => Number.isFinite(r[0]) && Number.isFinite(r[1]) && scaled(value, offer, r) === written) ?? null;
}

/** The value of a binding of this effect to a variable. */
export function valueFor(offer: Offer, name: PictureName, range: Range = rangeOf(name) ?? USUAL): string {
  if (offer.kind === 'number') return scaled(name.value, offer, range);
  if (offer.kind !== 'any' || name.type !== 'real') return name.value;
  // A number with all its digits flickers, and nobody can read it.
  return range[1] - range[0] >= 50 ? `TRUNC(${name.value})` : `TRUNC(${term(name.value)} * 10.0) / 10.0`;
}

/** The name of a variable that a value shows. */
export const shownBy = (value: string, names: readonly PictureName[]): PictureName | undefined =>
  names.filter((n) => n.value !== '' && (value === n.value || value.includes(term(n.value)))).sort((a, b) => b.value.length - a.value.length)[0];

export const sameBinding = (a: Pick<PictureBinding, 'element' | 'attribute'>, b: Pick<PictureBinding, 'element' | 'attribute'>): boolean => a.element === b.element && a.attribute === b.attribute;
