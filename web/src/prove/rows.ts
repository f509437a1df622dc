// The signals of the chronograms of a comparison: inputs and outputs, and the steps that both charts have.
import type { Told } from '../lib/compared.svelte';
import type { Run } from '../lib/runs.svelte';
import type { Lane } from '../run/lanes';

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

/** The rows of one side: steps that change in one of the runs, inputs and outputs that are ever other than 0.
 * If there are too many, those that differ stay. */
export function rows(told: Told, other: Told): Lane[] {
  const differing = differences(told.run, other.run);
  const there = new Set(other.lanes.map((l) => l.name));
  const moves = (lane: Lane) => lane.edges.length > 1 || (!lane.step && lane.edges.some((e) => e[1] !== 0));
  const moving = new Set([...told.lanes, ...other.lanes].filter(moves).map((l) => l.name));
  const all = told.lanes.filter((l) => there.has(l.name) && (moving.has(l.name) || differing.has(l.name)));
  const chosen = new Set([...all.filter((l) => differing.has(l.name)), ...all].slice(0, MOST));
  return all.filter((l) => chosen.has(l));
}
