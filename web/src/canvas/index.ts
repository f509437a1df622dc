// The panels that belong to the drawing.
import type { Panel } from '../lib/shell.svelte';
import Inspector from './Inspector.svelte';

export const panels: Panel[] = [
  { id: 'inspector', title: 'app.inspector', region: 'right', component: Inspector, order: 10 },
];
