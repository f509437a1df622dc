// The regions on a telephone: each is a sheet over the drawing, and one at a time is open.
import { prefs } from '../lib/prefs.svelte';
import type { Region } from '../lib/shape.svelte';

const OPEN = { left: 'leftOpen', right: 'rightOpen', bottom: 'bottomOpen' } as const;
const ALL = Object.keys(OPEN) as Region[];

/** The open region. */
export const sheet = (): Region | null => ALL.find((region) => prefs[OPEN[region]]) ?? null;

/** Opens a region and closes the others; null closes all. */
export function openSheet(region: Region | null): void {
  for (const one of ALL) prefs[OPEN[one]] = one === region;
}
