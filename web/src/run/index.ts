// The components of this folder that have a place in the window.
import type { Panel } from '../lib/shell.svelte';
import Chronogram from './Chronogram.svelte';
import Operate from './Operate.svelte';
import RunBar from './RunBar.svelte';
import Why from './Why.svelte';

export const panels: Panel[] = [
  { id: 'run', title: 'run.bar', region: 'top', component: RunBar, order: 10 },
  { id: 'operate', title: 'run.panel', region: 'right', component: Operate, order: 10 },
  { id: 'chronogram', title: 'run.chronogram', region: 'bottom', component: Chronogram, order: 20 },
  { id: 'why', title: 'why.title', region: 'bottom', component: Why, order: 22 },
];
