// A plant's picture in the page: its file is filtered, and its parts follow values.
import { t } from '../lib/i18n';
import { bind } from './bindings';
import { picture } from './sanitize';

export interface Bound {
  element: string;
  attribute: string;
}

const INSIDE = `
  :host { display: block; }
  svg { display: block; width: 100%; height: 100%; overflow: visible; font-family: var(--font-draw); }
  [data-g7-click], [data-g7-press] { cursor: pointer; outline: none; touch-action: manipulation; }
  [data-g7-click]:hover, [data-g7-press]:hover { filter: brightness(1.12); }
  [data-g7-click]:focus-visible, [data-g7-press]:focus-visible { outline: 2px solid var(--accent); outline-offset: 2px; }
  .g7-still { cursor: default !important; filter: none !important; }
  .g7-unknown { opacity: 0.22; filter: grayscale(1); }
  @media (prefers-reduced-motion: reduce) { * { transition: none !important; animation: none !important; } }`;

/** Hangs a picture into an element: the picture, its parts by name, and what gives a binding its value.
 * Throws if the text is no picture. */
export function hung(at: HTMLElement, text: string, bindings: readonly Bound[]) {
  const made = picture(text);
  const root = at.shadowRoot ?? at.attachShadow({ mode: 'open' });
  root.replaceChildren(Object.assign(document.createElement('style'), { textContent: INSIDE }), made);
  made.removeAttribute('width');
  made.removeAttribute('height');
  made.setAttribute('role', 'group');
  made.setAttribute('aria-label', t('run.picture'));
  const named = new Map<string, SVGElement[]>();
  for (const element of made.querySelectorAll<SVGElement>('[data-g7]')) {
    const name = element.dataset.g7 as string;
    named.set(name, [...(named.get(name) ?? []), element]);
  }
  const put = (i: number, value: boolean | number | string | undefined) => {
    const binding = bindings[i];
    if (!binding || value === undefined) return;
    named.get(binding.element)?.forEach((element) => bind(element, binding.attribute, value));
  };
  return { made, named, put };
}
