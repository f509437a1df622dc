// A canvas in the colours of the page and the resolution of the screen.
import type { Colours } from './lanes';

/** The colours of the theme, as a canvas needs them: computed. */
export function colours(): Colours {
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
