// The course beside the editor.
import type { Panel } from '../lib/shell.svelte';
import Reader from './Reader.svelte';

export const panels: Panel[] = [{ id: 'course', title: 'course.title', region: 'reader', component: Reader, order: 10 }];
