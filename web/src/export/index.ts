// Exports: charts for other tools, code for controllers, pictures.
import type { Panel } from '../lib/shell.svelte';
import Export from './Export.svelte';

export const panels: Panel[] = [{ id: 'export', title: 'out.title', region: 'bottom', component: Export, order: 18 }];
