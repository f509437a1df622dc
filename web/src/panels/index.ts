// The panels with tables and tests, at the bottom of the page.
import type { Panel } from '../lib/shell.svelte';
import Io from './Io.svelte';
import Tests from './Tests.svelte';
import Variables from './Variables.svelte';

export const panels: Panel[] = [
  { id: 'variables', title: 'vars.title', region: 'bottom', component: Variables, order: 12 },
  { id: 'io', title: 'io.title', region: 'bottom', component: Io, order: 14 },
  { id: 'tests', title: 'text.tests', region: 'bottom', component: Tests, order: 16 },
];
