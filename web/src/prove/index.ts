// The panels *Prove* and *Compare*, and the component that asks the questions of *Prove* while the user types.
import type { Panel } from '../lib/shell.svelte';
import Compare from './Compare.svelte';
import Follow from './Follow.svelte';
import Prove from './Prove.svelte';

export const panels: Panel[] = [
  { id: 'prove', title: 'prove.title', region: 'bottom', component: Prove, order: 17 },
  { id: 'compare', title: 'compare.title', region: 'bottom', component: Compare, order: 18 },
  { id: 'prove-follow', title: 'prove.title', region: 'over', component: Follow, order: 20 },
];
