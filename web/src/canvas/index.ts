// The panels that belong to the drawing.
import type { Panel } from '../lib/shell.svelte';
import Inspector from './Inspector.svelte';
import Palette from './Palette.svelte';

export const panels: Panel[] = [
  { id: 'palette', title: 'app.palette', region: 'left', component: Palette, order: 30 },
  { id: 'inspector', title: 'app.inspector', region: 'right', component: Inspector, order: 10 },
];
