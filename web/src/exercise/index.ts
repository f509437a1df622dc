// The panel *Exercise* of a file that belongs to one, and what keeps the student's progress.
import type { Panel } from '../lib/shell.svelte';
import Exercise from './Exercise.svelte';
import Keep from './Keep.svelte';
import { exercises } from './exercises.svelte';

export const panels: Panel[] = [
  { id: 'exercise', title: 'exercise.title', region: 'right', component: Exercise, order: 5, shown: () => exercises.id !== null },
  { id: 'exercise-keep', title: 'exercise.title', region: 'over', component: Keep, order: 30 },
];
