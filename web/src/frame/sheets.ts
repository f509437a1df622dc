// The window of a telephone: it shows drawing or text, and each region is a sheet over that; one sheet at a time is open.
import { prefs } from '../lib/prefs.svelte';
import { shape, type Region } from '../lib/shape.svelte';

const OPEN = { left: 'leftOpen', right: 'rightOpen', bottom: 'bottomOpen' } as const;
const ALL = Object.keys(OPEN) as Region[];

/** The part of the editor that the window shows. A telephone has no room for drawing and text at once. */
export const shownView = () => (shape.phone && prefs.view === 'both' ? 'text' : prefs.view);

/** The open region. */
export const sheet = (): Region | null => ALL.find((region) => prefs[OPEN[region]]) ?? null;

/** Opens a region and closes the others; null closes all. */
export function openSheet(region: Region | null): void {
  for (const one of ALL) prefs[OPEN[one]] = one === region;
}
