// The signals of the chronograms of a comparison: inputs and outputs, and the steps that both charts have.
import type { SignalType } from '../lib/protocol';
import type { Run } from '../lib/runs.svelte';

export interface Row {
  name: string;
  lane: number;
  type: SignalType;
  step: boolean;
}

/** Most rows of one chronogram. */
const MOST = 14;

/** The outputs and steps whose values differ at the instant that both runs show. */
export function differences(run: Run, other: Run): ReadonlySet<string> {
  void [run.frames, other.frames];
  const shows = new Map(other.started.signals.map((s, i) => [s.name, other.shows[i]]));
  const found = new Set<string>();
  run.started.signals.forEach((s, i) => {
    if (s.role === 'output' && shows.has(s.name) && shows.get(s.name) !== run.shows[i]) found.add(s.name);
  });
  const on = new Set([...other.active].map((i) => other.started.steps[i]?.activity));
  run.started.steps.forEach((s, i) => {
    if (run.active.has(i) !== on.has(s.activity)) found.add(s.activity);
  });
  return found;
}

/** The rows of one side; if there are too many, those that differ stay. */
export function rows(run: Run, other: Run): Row[] {
  const differing = differences(run, other);
  const there = new Set(other.started.steps.map((s) => s.activity));
  const from = run.started.signals.length;
  const signals = run.started.signals.map((s, lane): Row & { shown: boolean } => ({ name: s.name, lane, type: s.type, step: false, shown: s.role === 'input' || s.role === 'output' }));
  const steps = run.started.steps.map((s, i) => ({ name: s.activity, lane: from + i, type: 'bool' as const, step: true, shown: there.has(s.activity) && !s.inner }));
  const all = [...signals, ...steps].filter((r) => r.shown);
  const chosen = new Set([...all.filter((r) => differing.has(r.name)), ...all].slice(0, MOST));
  return all.filter((r) => chosen.has(r));
}
