// The panels of the frame itself.
import type { Panel } from '../lib/shell.svelte';
import ChartList from './ChartList.svelte';
import FileList from './FileList.svelte';
import Problems from './Problems.svelte';

export const panels: Panel[] = [
  { id: 'files', title: 'app.files', region: 'left', component: FileList, order: 10 },
  { id: 'charts', title: 'app.charts', region: 'left', component: ChartList, order: 20 },
  { id: 'problems', title: 'app.problems', region: 'bottom', component: Problems, order: 10 },
];
