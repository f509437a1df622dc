// The marks of a run on the drawing, updated at most 25 times a second.
import { live } from '../lib/live.svelte';
import type { Item } from '../lib/protocol';
import { chartOf, kindOf, transitionNumber } from '../lib/ids';
import { choices, isShown, shownOf, type Chosen } from '../lib/instances.svelte';
import type { Run } from './state.svelte';
import { Transitions } from './transitions';

const GAP = 40;
/** A frame that comes less than this before the next update is shown at once, in ms; this saves one
 * painting. */
const EARLY = 12;
/** A time that changes faster than this cannot be read, in ms of the wall clock. */
const READABLE = 100;
/** How long a cleared transition flashes, in ms; and the number of flashes at which none stands
 * out. */
const FLASH = 300;
const BRIEF = 60;
const MANY = 40;

/** The signals that a symbol names, by the id of the symbol. */
export type Named = ReadonlyMap<string, readonly number[]>;

/** A word of a text, in back-ticks or not, and the index behind it. */
const WORD = /`([^`]+)`|([\p{L}_][\p{L}\p{N}_.]*)(\[[^\]]*\])?/gu;

/** The words of a text: an element of an array with its index, and the words within the index. */
function* wordsOf(text: string): Generator<string> {
  for (const [, ticked, word = '', index] of text.matchAll(WORD)) {
    yield ticked ?? word + (index ?? '');
    if (index) yield* wordsOf(index.slice(1));
  }
}

/** The symbols of a drawing by the names of their charts: a sheet has several. */
export function byChart(items: readonly Item[]): Map<string, Item[]> {
  const found = new Map<string, Item[]>();
  for (const item of items) {
    const chart = chartOf(item.id);
    const own = found.get(chart);
    if (own) own.push(item);
    else found.set(chart, [item]);
  }
  return found;
}

/** Finds the names of signals in the texts of symbols. `chart` is the name of the chart in the program: that of an
 * instance is `Axis[3]`, that of an instance of a function block `left.Cycle`; `parameter` is the first parameter of the
 * chart. */
export function named(signals: readonly { name: string }[], chart: string, items: readonly Item[], parameter?: string): Named {
  const byName = new Map(signals.map((s, i) => [s.name, i]));
  const found = new Map<string, number[]>();
  // The index of an element can be the parameter that has the number of the instance.
  const number = parameter ? /\[(-?\d+)\]$/.exec(chart)?.[1] : undefined;
  // The variables of a function block are those of its instance.
  const home = chart.slice(0, Math.max(chart.lastIndexOf('.'), 0));
  for (const item of items) {
    if (!item.source) continue;
    const signals = new Set<number>();
    for (const word of wordsOf(item.source)) {
      const name = number === undefined ? word : word.replace(`[${parameter}]`, `[${number}]`);
      const signal = byName.get(`${chart}.${name}`) ?? (home ? byName.get(`${home}.${name}`) : undefined) ?? byName.get(name);
      if (signal !== undefined) signals.add(signal);
    }
    if (signals.size > 0) found.set(item.id, [...signals]);
  }
  return found;
}

/** A time beside a step: short, in units that do not flicker. While the time advances, unreadable
 * digits are left out. */
export function age(ms: number, grain = 0): string {
  if (ms < grain) return '';
  if (grain > 1) ms = Math.floor(ms / grain + 1e-6) * grain;
  if (ms < 1000) return `${Math.round(ms)}ms`;
  if (ms < 60_000) return `${(ms / 1000).toFixed(1)}s`;
  const minutes = Math.floor(ms / 60_000);
  if (minutes < 60) return `${minutes}m${Math.floor((ms % 60_000) / 1000)}s`;
  return `${Math.floor(minutes / 60)}h${minutes % 60}m`;
}

/** The visible symbols. */
interface Shown {
  items: readonly Item[];
  names: Named;
  same: boolean;
}

/** What is known of each run outlives its marks, which end when another run is looked at. */
const kept = new WeakMap<Run, Transitions>();

function transitionsOf(run: Run): Transitions {
  const found = kept.get(run) ?? new Transitions();
  kept.set(run, found);
  return found;
}

export class Marks {
  readonly #run: Run;
  readonly #chosen: Chosen = (chart) => choices.of(this.#run.file, chart, this.#run.instances);
  readonly #transitions: Transitions;
  #names: Named = new Map();
  /** For each step its actions that name signals. */
  #actions = new Map<string, string[]>();
  #other: Run | null = null;
  #unwatchOther: (() => void) | null = null;
  #told = 0;
  /** The time of the latest frame. */
  #came = 0;
  #timer = 0;
  #unwatch: () => void;
  #flashes = new Map<string, number>();

  constructor(run: Run) {
    this.#run = run;
    this.#transitions = transitionsOf(run);
    this.#unwatch = run.watch(() => this.soon());
    live.running = true;
    this.tell();
  }

  /** Sets the visible symbols with the signals that they name; `same` says that their text is that of the run. */
  show({ items, names, same }: Shown, other: Run | null): void {
    byChart(items).forEach((own, chart) => this.#transitions.show(chart, own, same));
    this.#names = names;
    this.#actions = new Map();
    for (const id of names.keys()) {
      if (!id.includes('/a/')) continue;
      const step = stepOf(id);
      this.#actions.set(step, [...(this.#actions.get(step) ?? []), id]);
    }
    if (this.#other !== other) {
      this.#unwatchOther?.();
      this.#unwatchOther = other?.watch(() => this.soon()) ?? null;
      this.#other = other;
    }
    this.tell();
  }

  end(): void {
    this.#unwatch();
    this.#unwatchOther?.();
    clearTimeout(this.#timer);
    live.clear();
  }

  soon(): void {
    const now = performance.now();
    const since = now - this.#came;
    this.#came = now;
    if (this.#timer !== 0) return;
    const wait = GAP - (now - this.#told);
    if (Math.min(wait, GAP - since) <= EARLY) {
      this.tell();
      return;
    }
    this.#timer = window.setTimeout(() => this.tell(), wait);
  }

  tell(): void {
    clearTimeout(this.#timer);
    this.#timer = 0;
    this.#told = performance.now();
    const run = this.#run;
    const { steps, transitions } = run.started;
    const on = new Set<string>();
    const times = new Map<string, string>();
    const grain = run.playing ? READABLE * Math.min(1, run.speed) : 0;
    for (const i of run.active) {
      const step = steps[i];
      if (!isShown(step, this.#chosen)) continue;
      const id = step.id;
      if (!id) continue;
      on.add(id);
      const ms = run.times.get(i);
      if (ms !== undefined) times.set(id, age(ms, grain));
    }
    const enabled = new Map<string, 0 | 1 | 2>();
    for (const [was, state] of shownOf(transitions, run.enabled, this.#chosen)) {
      const id = this.#transitions.of(was);
      if (id !== null) enabled.set(id, state);
    }
    live.on = on;
    live.times = times;
    live.enabled = enabled;
    const stopped = run.halt?.ids?.[0] ?? run.stopped;
    live.stopped = stopped && kindOf(stopped) === 't' ? this.#transitions.of(stopped) : stopped;
    this.#flash();
    this.#beside(on, enabled);
  }

  /** Lets cleared transitions flash for a moment. */
  #flash(): void {
    const now = performance.now();
    for (const i of this.#run.cleared) {
      const transition = this.#run.started.transitions[i];
      const id = isShown(transition, this.#chosen) ? this.#transitions.of(transition.id) : null;
      if (id !== null) this.#flashes.set(id, now + (this.#flashes.size < MANY ? FLASH : BRIEF));
    }
    this.#run.cleared.clear();
    for (const [id, until] of this.#flashes) if (until < now) this.#flashes.delete(id);
    const shown = [...this.#flashes.keys()];
    if (shown.length > 0 || live.cleared.length > 0) live.cleared = shown;
    if (shown.length > 0 && !this.#run.playing && this.#timer === 0) {
      this.#timer = window.setTimeout(() => this.tell(), FLASH);
    }
  }

  /** Values beside names, lit actions, and locks; they are computed only where something is active.
   * */
  #beside(on: ReadonlySet<string>, enabled: ReadonlyMap<string, number>): void {
    const run = this.#run;
    const { signals } = run.started;
    const values = new Map<string, string>();
    const lit = new Set<string>();
    const forced = new Set<string>();
    const tell = (id: string) => {
      const all = this.#names.get(id) ?? [];
      const numbers = all.filter((s) => signals[s]?.type !== 'bool');
      // If there is only one signal, its value needs no name.
      const short = (s: number) => (all.length === 1 ? '' : `${brief(signals[s]?.name ?? '')} `);
      if (numbers.length > 0) values.set(id, numbers.map((s) => `${short(s)}= ${run.shows[s]}`).join('   '));
    };
    for (const step of on) {
      for (const id of this.#actions.get(step) ?? []) {
        tell(id);
        if (this.#names.get(id)?.some((s) => signals[s]?.role === 'output' && run.shows[s] === 'TRUE')) lit.add(id);
      }
    }
    for (const id of enabled.keys()) tell(id);
    if (run.forced.includes(true)) {
      for (const [id, names] of this.#names) if (names.some((s) => run.forced[s])) forced.add(id);
    }
    const others = new Set<string>();
    for (const i of this.#other?.active ?? []) {
      const step = this.#other?.started.steps[i];
      if (isShown(step, this.#chosen) && step.id && !on.has(step.id)) others.add(step.id);
    }
    if (others.size > 0 || live.others.size > 0) live.others = others;
    live.otherName = this.#other?.started.profile ?? '';
    live.values = values;
    live.lit = lit;
    live.forced = forced;
  }
}

/** A name without its prefix, shortened to a glance. */
function brief(name: string): string {
  const last = name.slice(name.lastIndexOf('.') + 1);
  return last.length <= 16 ? last : `${last.slice(0, 9)}…${last.slice(-6)}`;
}

function stepOf(action: string): string {
  return action.replace('/a/', '/s/').replace(/\/\d+$/, '');
}

/** A short name of a step or transition for lists. */
export function shortName(id: string): string {
  const [chart, kind, name] = id.split('/').map((part) => decodeURIComponent(part));
  return kind === 't' ? `${chart} (${transitionNumber(id) + 1})` : `${chart}.${name}`;
}
