// The text view in the middle of the window.
import type { Panel } from '../lib/shell.svelte';
import TextView from './TextView.svelte';

export const panels: Panel[] = [{ id: 'text', title: 'app.view.text', region: 'text', component: TextView, order: 10 }];
