// The effects of values on elements of a plant's picture, as the book describes them:
// docs/book/src/language/plants.md.

type Value = boolean | number | string;

const NUMBERS = new Set(['x', 'y', 'width', 'height', 'cx', 'cy', 'r', 'rx', 'ry', 'x1', 'y1', 'x2', 'y2', 'opacity']);
const SIZES = new Set(['width', 'height', 'r', 'rx', 'ry']);
const COLOUR = /^[#\w\s.,%()+/-]*$/;

interface Moved {
  dx: number;
  dy: number;
}

const moved = new WeakMap<Element, Moved>();

function move(element: SVGElement, by: Partial<Moved>): void {
  const now = { dx: 0, dy: 0, ...moved.get(element), ...by };
  moved.set(element, now);
  element.style.translate = `${now.dx}px ${now.dy}px`;
}

/** Rotates about the middle of the element, unless the picture says otherwise. */
function turn(element: SVGElement, origin: string): void {
  if (!element.style.transformBox) element.style.transformBox = 'fill-box';
  if (!element.style.transformOrigin) element.style.transformOrigin = origin;
}

/** One child element for each letter: the letter becomes its class; children beyond the text are
 * hidden. */
function items(element: SVGElement, text: string): void {
  [...element.children].forEach((child, i) => {
    const letter = text[i];
    (child as SVGElement).style.display = letter === undefined ? 'none' : '';
    const before = (child as SVGElement).dataset.letter;
    if (before === letter) return;
    if (before) child.classList.remove(before);
    if (letter && /\S/.test(letter)) child.classList.add(letter);
    (child as SVGElement).dataset.letter = letter ?? '';
  });
}

export function bind(element: SVGElement, attribute: string, value: Value): void {
  const number = typeof value === 'number' ? value : Number(value);
  if (attribute === 'text') element.textContent = String(value);
  else if (attribute === 'visible') element.style.display = value ? '' : 'none';
  else if (attribute === 'items') items(element, String(value));
  else if (attribute === 'count') items(element, '+'.repeat(Math.max(0, Math.min(number, 1000))));
  else if (attribute === 'dx' || attribute === 'dy') move(element, { [attribute]: number });
  else if (attribute === 'rotate') {
    turn(element, 'center');
    element.style.rotate = `${number}deg`;
  } else if (attribute === 'level') {
    turn(element, 'bottom');
    element.style.scale = `1 ${Math.min(1, Math.max(0, number))}`;
  } else if (attribute === 'fill' || attribute === 'stroke') {
    if (COLOUR.test(String(value)) && !/url/i.test(String(value))) element.style.setProperty(attribute, String(value));
  } else if (NUMBERS.has(attribute) && Number.isFinite(number)) {
    element.setAttribute(attribute, String(SIZES.has(attribute) ? Math.max(0, number) : number));
  } else if (typeof value === 'boolean') element.classList.toggle(attribute, value);
  else if (typeof value === 'number') element.style.setProperty(`--${attribute}`, String(value));
  else element.setAttribute(`data-${attribute.toLowerCase().replace(/[^a-z0-9-]/g, '-')}`, value);
}
