// A running controller as the page knows it. Whatever is older than a moment counts as unknown.
import { link } from '../lib/link.svelte';
import { server } from '../lib/server';
import type { ChartFile, Counts, Description, DeviceState, Event, Forced, Frame, Mode, Quality, Wishes } from './told';

type Wish<N extends keyof Wishes> = { do: N } & Wishes[N]['asked'];

/** Without a frame for so long there is no connection, in ms; 20 frames come in a second. */
const SILENT = 1200;
/** A controller that has shown nothing for so long does not scan any more, in s. */
const STILL = 1;

export interface Cell {
  value: string;
  quality: Quality;
}

export class Station {
  told: Description | null = $state.raw(null);
  mode: Mode | null = $state.raw(null);
  counts: Counts | null = $state.raw(null);
  on: [number, number][] = $state.raw([]);
  enabled: Record<string, 1 | 2> = $state.raw({});
  forced: Forced[] = $state.raw([]);
  devices: DeviceState[] = $state.raw([]);
  events: Event[] = $state.raw([]);
  values: Cell[] = $state.raw([]);
  /** The values of the parts of the picture. */
  view: (boolean | number | string)[] = $state.raw([]);
  file: ChartFile = $state.raw({ differs: false, back: false, busy: false });
  /** The time of the controller, in whole s. */
  now = $state(0);
  /** `none`: the server has no controller; `begin`: not connected yet. */
  link: 'begin' | 'live' | 'silent' | 'gone' | 'none' = $state('begin');
  /** The instant of the wall clock at which the controller's clock showed 0, in ms. */
  zero = $state(0);
  /** Why the last command was refused. */
  refused = $state('');
  readonly live = $derived(this.link === 'live');
  readonly byForce: ReadonlyMap<number, Forced> = $derived(new Map(this.forced.map((f) => [f.signal, f])));

  #came = -Infinity;
  #age = 0;
  #up = false;

  async begin(): Promise<void> {
    await server.begin().catch((error: Error) => (this.refused = error.message));
    if (!server.info?.online) {
      this.link = server.info ? 'none' : 'gone';
      return;
    }
    server.link((up) => (up ? void this.#watch() : this.#lost()));
    server.hear((message) => message.operator && this.#take(message.operator as Frame));
    setInterval(() => this.#judge(), 200);
  }

  async #watch(): Promise<void> {
    try {
      const told = await server.call({ do: 'operator_watch' });
      this.#up = true;
      this.told = told;
      this.values = [];
      this.view = [];
      this.#take(told.frame);
    } catch {
      this.#lost();
    }
  }

  #lost(): void {
    this.#up = false;
    this.#judge();
  }

  #judge(): void {
    // Nothing is lost by it here: the page of another version or folder is loaded.
    if (link.state === 'newer' || link.state === 'other') location.reload();
    if (this.link === 'none' || (this.link === 'begin' && !this.told)) return;
    const heard = this.#up && performance.now() - this.#came < SILENT;
    this.link = !heard ? 'gone' : this.#age > STILL ? 'silent' : 'live';
  }

  #take(frame: Frame): void {
    if (!this.#up) return;
    if (frame.renew) {
      // The numbers of later frames are those of another chart.
      this.#up = false;
      void this.#watch();
      return;
    }
    this.#came = performance.now();
    this.#age = frame.age;
    if (frame.mode) this.mode = frame.mode;
    if (frame.counts) this.counts = frame.counts;
    if (frame.on) this.on = frame.on;
    if (frame.enabled) this.enabled = frame.enabled;
    if (frame.forced) this.forced = frame.forced;
    if (frame.devices) this.devices = frame.devices;
    if (frame.events) this.events = frame.events;
    if (frame.file) this.file = frame.file;
    if (frame.values) {
      const values = [...this.values];
      for (const [signal, value, quality] of frame.values) values[signal] = { value, quality };
      this.values = values;
    }
    if (frame.view) {
      const view = [...this.view];
      for (const [part, value] of frame.view) view[part] = value;
      this.view = view;
    }
    this.now = Math.floor(frame.now);
    const zero = Date.now() - frame.now * 1000;
    if (Math.abs(zero - this.zero) > 1000) this.zero = zero;
    this.link = this.#age > STILL ? 'silent' : 'live';
  }

  /** Gives a command; what is refused is told. */
  async do<N extends keyof Wishes>(message: Wish<N>): Promise<boolean> {
    this.refused = '';
    const answer = await this.ask(message);
    if ('no' in answer) this.refused = answer.no;
    return 'ok' in answer;
  }

  /** Gives a command whose answer its caller shows. */
  async ask<N extends keyof Wishes>(message: Wish<N>): Promise<{ ok: Wishes[N]['told'] } | { no: string }> {
    try {
      return { ok: await server.call(message) };
    } catch (error) {
      return { no: (error as Error).message };
    }
  }
}

export const station = new Station();

/** A duration in words that do not flicker: whole s, minutes, hours, days. */
export function span(seconds: number): string {
  const s = Math.max(0, Math.floor(seconds));
  if (s < 60) return `${s} s`;
  const two = (n: number) => String(n).padStart(2, '0');
  if (s < 3600) return `${Math.floor(s / 60)}:${two(s % 60)} min`;
  if (s < 86_400) return `${Math.floor(s / 3600)}:${two(Math.floor((s % 3600) / 60))} h`;
  return `${Math.floor(s / 86_400)} d ${Math.floor((s % 86_400) / 3600)} h`;
}

/** A duration of the machine, in ms: with tenths as long as they can be read. */
export function brief(ms: number): string {
  return ms < 60_000 ? `${(Math.floor(ms / 100) / 10).toFixed(1)} s` : span(ms / 1000);
}
