// The panels that belong to the drawing.
import type { Panel } from '../lib/shell.svelte';

export const panels: Panel[] = [];
