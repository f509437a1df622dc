// One run as the page sees it: the frames that came, merged. Frames say only what
// changed; what the tables show is kept by signal and by step, so that a change of
// one value touches one row.
import type { Answers } from '../lib/page';
import type { Frame, SignalRow, Started } from '../lib/protocol';

/** While it runs, its time is told in words no more often than can be read, ms. */
const READ = 100;

type Watcher = (frame: Frame) => void;

export interface Halt {
  what: string;
  ids?: string[];
}

export class Run {
  readonly name: string;
  readonly file: string;
  /** Held by the server, and seen by all that watch it. */
  readonly shared: boolean;
  readonly answers: Answers;
  started: Started = $state.raw(undefined as unknown as Started);

  /** By signal. */
  shows: string[] = $state([]);
  numbers: number[] = $state([]);
  forced: boolean[] = $state([]);
  /** By step. */
  on: boolean[] = $state([]);

  /** Active steps, what of transitions is enabled, times of active steps. */
  readonly active = new Set<number>();
  readonly enabled = new Map<number, 0 | 1 | 2>();
  readonly times = new Map<number, number>();
  /** Transitions cleared since the drawing was told. */
  readonly cleared = new Set<number>();
  view: (boolean | number | string | undefined)[] = [];
  /** Pictures of the plant that are in view. */
  pictures = 0;

  now = $state(0);
  /** The latest instant that there is. */
  end = $state(0);
  #told: { now: number; end: number } = $state.raw({ now: 0, end: 0 });
  #toldAt = 0;
  scans = $state(0);
  passes = $state(0);
  within = $state(false);
  /** The present, and no earlier scan that is looked at. */
  live = $state(true);
  late = $state(false);
  halt: Halt | null = $state.raw(null);
  stopped: string | null = $state(null);
  playing = $state(false);
  speed = $state(1);
  /** The time as it is told in words. */
  readonly clock: { now: number; end: number } = $derived(this.playing ? this.#told : { now: this.now, end: this.end });
  /** The version of the text that runs. */
  hash = $state('');
  /** A shared run of another text than the one here, which others look at: it is changed only on demand. */
  foreign = $state(false);
  /** What an on-line change would lose, while that is asked. */
  losing: string[] | null = $state.raw(null);
  /** A changed text that cannot be taken over, and why. */
  refused: string | null = $state.raw(null);
  /** What the run has to say: outputs that two actions write against each other, and the like. */
  note: string | null = $state(null);
  /** When the latest frame came, by the clock of the page. */
  heard = 0;
  /** Counts frames: for what is drawn anew as a whole. */
  frames = $state(0);

  #watchers = new Set<Watcher>();

  constructor(started: Started, answers: Answers, shared: boolean) {
    this.name = started.run;
    this.file = started.file;
    this.answers = answers;
    this.shared = shared;
    this.begin(started);
  }

  /** Takes over a start, or a changed chart: the numbers of frames have new meanings. */
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

  /** Told of every frame, after it was merged. */
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

  /** A full frame says what is; whatever it does not name is not. */
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
