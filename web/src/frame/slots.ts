// All panels of the page, collected from the folders that define them.
import { panels as canvas } from '../canvas';
import { panels as course } from '../course';
import type { Panel } from '../lib/shell.svelte';
import { panels as exercise } from '../exercise';
import { panels as out } from '../export';
import { panels as tables } from '../panels';
import { panels as prove } from '../prove';
import { panels as run } from '../run';
import { panels as start } from '../start';
import { panels as text } from '../text';
import { panels as wires } from '../wiring';
import { panels as frame } from './index';

const all: Panel[] = [...frame, ...canvas, ...course, ...exercise, ...tables, ...prove, ...run, ...start, ...text, ...out, ...wires];

export function slots(region: Panel['region']): Panel[] {
  return all.filter((p) => p.region === region && (p.shown?.() ?? true)).sort((a, b) => a.order - b.order);
}
