// One run as the page knows it: the merged frames. Frames contain only changes; the data of the
// tables is kept by signal and by step, so that a changed value affects one row only.
import { instancesOf } from '../lib/instances.svelte';
import type { Door } from '../lib/page';
import type { Frame, SignalRow, Started } from '../lib/protocol';

/** While it runs, the time in the bar changes at most this often, in ms, so that it can be read. */
const READ = 100;

type Watcher = (frame: Frame) => void;

export interface Halt {
  what: string;
  ids?: string[];
}

export class Run {
  readonly name: string;
  readonly file: string;
  /** True if the server holds the run, so that all watching pages see it. */
  readonly shared: boolean;
  readonly answers: Door;
  started: Started = $state.raw(undefined as unknown as Started);
  /** The instances of each chart with parameters. */
  readonly instances = $derived(instancesOf(this.started.steps));

  /** The shown values, by signal. */
  shows: string[] = $state([]);
  numbers: number[] = $state([]);
  forced: boolean[] = $state([]);
  /** The activity of the steps, by number. */
  on: boolean[] = $state([]);

  /** The active steps, the marks of enabled transitions, and the times of active steps. */
  readonly active = new Set<number>();
  readonly enabled = new Map<number, 0 | 1 | 2>();
  readonly times = new Map<number, number>();
  /** Transitions cleared since the drawing was updated. */
  readonly cleared = new Set<number>();
  view: (boolean | number | string | undefined)[] = [];
  /** Number of visible pictures of the plant. */
  pictures = 0;

  now = $state(0);
  /** The latest instant of the run. */
  end = $state(0);
  #told: { now: number; end: number } = $state.raw({ now: 0, end: 0 });
  #toldAt = 0;
  scans = $state(0);
  passes = $state(0);
  within = $state(false);
  /** True if the present is shown, and not an earlier scan. */
  live = $state(true);
  late = $state(false);
  halt: Halt | null = $state.raw(null);
  stopped: string | null = $state(null);
  playing = $state(false);
  speed = $state(1);
  /** The time in the bar. */
  readonly clock: { now: number; end: number } = $derived(this.playing ? this.#told : { now: this.now, end: this.end });
  /** The fingerprint of the text that runs. */
  hash = $state('');
  /** True for a shared run of another text than ours, which other clients watch: it is changed only
   * on request. */
  foreign = $state(false);
  /** True for a shared run while there is no connection: its state is the one that was heard last. */
  away = $state(false);
  /** The losses of an on-line change, while the user is asked about them. */
  losing: string[] | null = $state.raw(null);
  /** The reason why a changed text cannot be taken over. */
  refused: string | null = $state.raw(null);
  /** A message of the run, for instance that two actions write different values to an output. */
  note: string | null = $state(null);
  /** The time of the latest frame, by the clock of the page. */
  heard = 0;
  /** A counter of frames, for parts that are redrawn as a whole. */
  frames = $state(0);

  #watchers = new Set<Watcher>();

  constructor(started: Started, answers: Door, shared: boolean) {
    this.name = started.run;
    this.file = started.file;
    this.answers = answers;
    this.shared = shared;
    this.begin(started);
  }

  /** Takes over a start or a changed chart: the numbers in frames get new meanings. */
  begin(started: Started): void {
    this.started = started;
    this.hash = started.hash;
    this.shows = started.signals.map(() => '');
    this.numbers = started.signals.map(() => 0);
    this.forced = started.signals.map(() => false);
    this.on = started.steps.map(() => false);
    this.view = [];
    this.halt = null;
    this.note = null;
    this.take({ ...started.frame, full: true });
  }

  /** Calls a watcher after every merged frame. */
  watch(watcher: Watcher): () => void {
    this.#watchers.add(watcher);
    return () => this.#watchers.delete(watcher);
  }

  take(frame: Frame): void {
    if (frame.full) this.#forget(frame);
    for (const step of frame.off) {
      this.active.delete(step);
      this.on[step] = false;
    }
    for (const step of frame.on) {
      this.active.add(step);
      this.on[step] = true;
    }
    if (frame.times) {
      this.times.clear();
      for (const [step, ms] of Object.entries(frame.times)) this.times.set(Number(step), ms);
    }
    for (const [transition, how] of frame.enabled) {
      if (how === 0) this.enabled.delete(transition);
      else this.enabled.set(transition, how);
    }
    for (const transition of frame.cleared) this.cleared.add(transition);
    for (const [signal, show, number] of frame.values) {
      this.shows[signal] = show;
      this.numbers[signal] = number;
    }
    for (const [signal, held] of frame.forced) this.forced[signal] = held;
    for (const [binding, value] of frame.view) this.view[binding] = value;
    this.now = frame.now_ms;
    this.live = frame.live ?? true;
    if (this.live) this.end = frame.now_ms;
    this.scans = frame.scans;
    this.passes = frame.passes;
    this.within = frame.within ?? false;
    this.late = frame.late ?? false;
    this.halt = frame.halt ?? null;
    this.stopped = frame.stopped?.id ?? null;
    if (this.halt || this.stopped) this.playing = false;
    if (frame.notes && frame.notes.length > 0) this.note = frame.notes.at(-1) ?? null;
    this.heard = performance.now();
    if (this.heard - this.#toldAt >= READ) {
      this.#toldAt = this.heard;
      this.#told = { now: this.now, end: this.end };
    }
    this.frames++;
    this.#watchers.forEach((watcher) => watcher(frame));
  }

  /** Before a full frame: everything that it does not name is reset. */
  #forget(frame: Frame): void {
    const on = new Set(frame.on);
    for (const step of this.active) if (!on.has(step)) this.on[step] = false;
    this.active.clear();
    this.enabled.clear();
    const held = new Set(frame.forced.map(([signal]) => signal));
    this.forced.forEach((was, signal) => {
      if (was && !held.has(signal)) this.forced[signal] = false;
    });
  }

  signal(name: string): number {
    return this.started.signals.findIndex((s) => s.name === name);
  }

  row(signal: number): SignalRow | undefined {
    return this.started.signals[signal];
  }

  get situation(): string[] {
    return [...this.active].sort((a, b) => a - b).map((i) => this.started.steps[i]?.name ?? '');
  }
}
