// Filters a picture from a file before it becomes part of the page: no scripts, no handlers, no
// external references. Unknown elements are removed.
import { inside } from './css';

const SVG = 'http://www.w3.org/2000/svg';
const XLINK = 'http://www.w3.org/1999/xlink';

const ELEMENTS = new Set(
  `svg g path rect circle ellipse line polyline polygon text tspan textPath title desc defs symbol use
  linearGradient radialGradient stop clipPath mask pattern marker style filter feGaussianBlur feOffset
  feFlood feBlend feColorMatrix feComposite feMerge feMergeNode feDropShadow`.split(/\s+/),
);

/** Attributes that no browser reads as CSS. */
const PLAIN = /^(data-|aria-|id$|class$|role$|lang$|tabindex$)/;

function clean(from: Element): SVGElement | null {
  if (from.namespaceURI !== SVG || !ELEMENTS.has(from.localName)) return null;
  if (from.localName === 'style' && (from.children.length > 0 || !inside(from.textContent ?? ''))) return null;
  const made = document.createElementNS(SVG, from.localName) as SVGElement;
  for (const { name, localName, namespaceURI, value } of from.attributes) {
    if (/^on/i.test(localName) || name.startsWith('xmlns')) continue;
    if (localName === 'href') {
      if (value.startsWith('#') && (namespaceURI === null || namespaceURI === XLINK)) made.setAttribute('href', value);
      continue;
    }
    if (namespaceURI !== null || (!PLAIN.test(name) && !inside(value))) continue;
    made.setAttribute(name, value);
  }
  for (const child of from.childNodes) {
    if (child.nodeType === Node.TEXT_NODE) made.append(child.textContent ?? '');
    else if (child instanceof Element) {
      const kept = clean(child);
      if (kept) made.append(kept);
    }
  }
  return made;
}

/** The picture in a file; throws if there is none. */
export function picture(text: string): SVGElement {
  const parsed = new DOMParser().parseFromString(text, 'image/svg+xml');
  const wrong = parsed.querySelector('parsererror');
  const root = wrong ? null : clean(parsed.documentElement);
  if (!root || root.localName !== 'svg') throw new Error(wrong?.textContent?.split('\n')[1] ?? 'no SVG');
  return root;
}
