// The wiring of a chart to the devices of a machine, over the other parts of the window.
import type { Panel } from '../lib/shell.svelte';
import Wiring from './Wiring.svelte';

export const panels: Panel[] = [{ id: 'wiring', title: 'wire.title', region: 'over', component: Wiring, order: 30 }];
