// The code that shows a chart in another page: a frame with a link, or an element that makes this frame (`src/embed.ts`).

import { escaped } from '../lib/escape';
import { base } from '../lib/paths';

/** The address of this page, without what is said to it. */
export const ownPlace = (): string => new URL('.', location.href).href;

/** The address of the page that opens links; null if the wish is no such address. */
export function placeOf(wish: string): string | null {
  if (wish.trim() === '') return ownPlace();
  try {
    const url = new URL(wish.trim());
    if (!/^https?:$/.test(url.protocol)) return null;
    url.hash = url.search = '';
    return url.href;
  } catch {
    return null;
  }
}

/** The frame as HTML. */
export const asFrame = (place: string, hash: string, name: string): string =>
  `<iframe src="${escaped(`${place}?embed${hash}`)}" title="${escaped(name)}" width="100%" height="480" loading="lazy" style="border: 1px solid #ccc"></iframe>`;

/** The element as HTML, with the text of the chart in it. */
export const asElement = (place: string, text: string, name: string): string =>
  `<script src="${escaped(place)}embed.js" defer></script>\n<g7-chart file="${escaped(base(name))}">\n${escaped(text.trimEnd())}\n</g7-chart>`;
