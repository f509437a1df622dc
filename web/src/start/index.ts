// The components of this folder that have a place in the frame.
import type { Panel } from '../lib/shell.svelte';

export const panels: Panel[] = [];
