// The gallery, and the parts for beginners that lie over the page.
import type { Panel } from '../lib/shell.svelte';
import Over from './Over.svelte';
import Start from './Start.svelte';

export const panels: Panel[] = [
  { id: 'start', title: 'app.gallery', region: 'start', component: Start, order: 10 },
  { id: 'over', title: 'start.tour', region: 'over', component: Over, order: 10 },
];
