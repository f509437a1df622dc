// A canvas in the colours of the page and the resolution of the screen.
import { MediaQuery } from 'svelte/reactivity';
import { prefs } from '../lib/prefs.svelte';
import type { Colours } from './lanes';

const dark = new MediaQuery('prefers-color-scheme: dark');

/** The colours of the theme; other ones as soon as the user or the system changes it. */
export const themed = (): Colours => (void [prefs.theme, dark.current], colours());

/** The colours of the theme, as a canvas needs them: computed. */
function colours(): Colours {
  const probe = document.body.appendChild(document.createElement('i'));
  const of = (name: string) => {
    probe.style.color = `var(${name})`;
    return getComputedStyle(probe).color;
  };
  const found: Colours = {
    ink: of('--ink'),
    soft: of('--soft'),
    line: of('--line-strong'),
    grid: of('--grid'),
    accent: of('--accent'),
    accentSoft: of('--accent-soft'),
    green: of('--green'),
    greenSoft: of('--green-soft'),
    amber: of('--amber'),
    violet: of('--violet'),
    paper: of('--surface'),
    font: 'sans-serif',
  };
  probe.remove();
  return found;
}

/** Gives a canvas the resolution of the screen; its size is in px of the page. */
export function sharpened(of: HTMLCanvasElement, width: number, height: number): CanvasRenderingContext2D | null {
  const sharp = devicePixelRatio || 1;
  const w = Math.max(1, Math.round(width * sharp));
  const h = Math.max(1, Math.round(height * sharp));
  if (of.width !== w) of.width = w;
  if (of.height !== h) of.height = h;
  const g = of.getContext('2d');
  g?.setTransform(sharp, 0, 0, sharp, 0, 0);
  return g;
}
