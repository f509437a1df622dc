// The history of a running controller as the page shows it: chosen signals over a span of the record.
// Times are ms of the record, which never goes back; what the wall clock showed then is told by marks.
import { server } from '../lib/server';
import { prefs } from '../lib/prefs.svelte';
import type { Busy, Edge, Lane, Span } from '../run/lanes';

export interface Recorded {
  id: number;
  name: string;
  class: string;
  type: string;
  comment?: string | null;
  bool: boolean;
  real: boolean;
  time: boolean;
}

interface Overview {
  title: string;
  signals: Recorded[];
  from: number;
  until: number;
}

type Piece =
  | [ms: number, value: number | null, text?: string]
  | [from: number, to: number, count: number, low: number, high: number, behind: number];

interface Lanes {
  until: number;
  spans: [from: number, to: number, lost: number][];
  clock: [ms: number, utc: number][];
  lanes: { id: number; pieces: Piece[] }[];
}

/** The signals that are shown at first. */
const FIRST = 10;
/** The height of a curve, in px. */
const TALL = 54;
const HOUR = 3_600_000;
/** The part of a window that follows the present and lies behind it. */
const AHEAD = 0.02;
/** Steps between two times that are written, in ms. */
const STEPS = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1e3, 2e3, 5e3, 1e4, 1.5e4, 3e4, 6e4, 12e4, 3e5, 6e5, 9e5, 18e5, HOUR, 2 * HOUR, 3 * HOUR, 6 * HOUR, 12 * HOUR, 24 * HOUR, 48 * HOUR, 168 * HOUR];

class Past {
  /** `null` until the server has said whether it keeps a history. */
  there: boolean | null = $state(null);
  signals: Recorded[] = $state.raw([]);
  #names: readonly string[] = $state.raw([]);
  from = $state(0);
  until = $state(0);
  span: Span = $state.raw({ from: 0, to: HOUR });
  following = $state(true);
  cursor: number | null = $state(null);
  lanes: Lane[] = $state.raw([]);
  spans: Lanes['spans'] = $state.raw([]);
  clock: Lanes['clock'] = $state.raw([]);
  refused = $state('');
  #title = '';
  #busy = false;
  #again = false;

  readonly picked: readonly Recorded[] = $derived(this.#names.flatMap((name) => this.signals.find((s) => s.name === name) ?? []));

  /** Asks what the record has; a changed chart has other signals. */
  async begin(): Promise<void> {
    try {
      const told = await server.ask<Overview>('api/history');
      const first = this.there === null;
      this.there = true;
      this.signals = told.signals;
      [this.from, this.until, this.#title] = [told.from, told.until, told.title];
      if (first) {
        this.#names = this.#kept() ?? this.#first();
        this.show(HOUR);
      }
    } catch {
      this.there ??= false;
    }
  }

  #kept(): readonly string[] | null {
    try {
      const kept = JSON.parse(localStorage.getItem(`g7-history:${this.#title}`) ?? 'null') as unknown;
      return Array.isArray(kept) && kept.every((name) => typeof name === 'string') ? kept : null;
    } catch {
      return null;
    }
  }

  #first(): string[] {
    const of = (what: string) => this.signals.filter((s) => s.class === what).map((s) => s.name);
    return [...of('outputs'), ...of('inputs'), ...of('steps')].slice(0, FIRST);
  }

  pick(names: readonly string[]): void {
    this.#names = names;
    try {
      localStorage.setItem(`g7-history:${this.#title}`, JSON.stringify(names));
    } catch {
      // The choice is not kept then.
    }
  }

  /** The latest part of so many ms. */
  show(ms: number): void {
    this.following = true;
    this.span = { from: 0, to: ms };
    this.along();
  }

  whole(): void {
    this.following = false;
    const width = Math.max(1000, this.until - this.from);
    this.span = { from: this.from - width * AHEAD, to: this.until + width * AHEAD };
  }

  /** Keeps the present near the right end. */
  along(): void {
    if (!this.following) return;
    const width = this.span.to - this.span.from;
    const to = this.until + width * AHEAD;
    this.span = { from: to - width, to };
  }

  zoom(by: number, about: number): void {
    const { from, to } = this.span;
    const width = Math.min(Math.max((to - from) * by, 1), 1e11);
    const share = (about - from) / (to - from);
    this.span = { from: about - width * share, to: about + width * (1 - share) };
    this.along();
  }

  pan(ms: number): void {
    this.following = false;
    this.span = { from: this.span.from + ms, to: this.span.to + ms };
  }

  /** Loads what is in sight; requests during the loading are combined into one. */
  async fetch(width: number): Promise<void> {
    if (this.#busy) {
      this.#again = true;
      return;
    }
    this.#busy = true;
    const picked = this.picked;
    const { from, to } = this.span;
    try {
      const ids = picked.map((s) => s.id).join(',');
      const told = await server.ask<Lanes>(`api/history/lanes?signals=${ids}&from=${from}&to=${to}&columns=${Math.ceil(Math.max(width, 100))}`);
      [this.until, this.spans, this.clock] = [told.until, told.spans, told.clock];
      this.lanes = picked.map((signal, k) => lane(signal, told.lanes[k]?.pieces ?? []));
      this.refused = '';
    } catch (error) {
      this.refused = (error as Error).message;
    } finally {
      this.#busy = false;
      if (this.#again) {
        this.#again = false;
        void this.fetch(width);
      }
    }
  }

  /** A file of what is in sight. */
  async file(as: 'csv' | 'parquet'): Promise<ArrayBuffer | null> {
    try {
      this.refused = '';
      const ids = this.picked.map((s) => s.id).join(',');
      return await server.bytes(`api/history/export?as=${as}&signals=${ids}&from=${this.span.from}&to=${this.span.to}`);
    } catch (error) {
      this.refused = (error as Error).message;
      return null;
    }
  }

  /** The wall clock at a time of the record. */
  utc(ms: number): number {
    let mark = this.clock[0];
    for (const other of this.clock) if (other[0] <= ms) mark = other;
    return mark ? mark[1] + ms - mark[0] : ms;
  }

  /** The time of day, as finely as a step of so many ms needs it. */
  time(ms: number, step: number): string {
    const at = new Date(this.utc(ms));
    if (step >= 24 * HOUR) return new Intl.DateTimeFormat(prefs.language, { day: '2-digit', month: 'short' }).format(at);
    const seconds = step < 60_000 ? ({ second: '2-digit' } as const) : {};
    const digits = step >= 1000 ? {} : { fractionalSecondDigits: step >= 100 ? 1 : step >= 10 ? 2 : 3 } as const;
    return new Intl.DateTimeFormat(prefs.language, { hour: '2-digit', minute: '2-digit', hourCycle: 'h23', ...seconds, ...digits }).format(at);
  }

  /** Round times of day within the span, so far apart that there is room for them. */
  ticks(width: number): [ms: number, text: string][] {
    const { from, to } = this.span;
    const least = ((to - from) / Math.max(width, 1)) * 84;
    const step = STEPS.find((s) => s >= least) ?? 336 * HOUR;
    const middle = this.utc((from + to) / 2);
    // Hours are those of the place of the page.
    const local = middle - (from + to) / 2 - new Date(middle).getTimezoneOffset() * 60_000;
    const found: [number, string][] = [];
    for (let at = Math.ceil((from + local) / step) * step - local; at <= to; at += step) found.push([at, this.time(at, step)]);
    return found;
  }

  /** The spans in sight of which nothing is known, up to the present. */
  gaps(): Span[] {
    const gaps: Span[] = [];
    let known = this.from;
    for (const [from, to] of this.spans) {
      if (from > known) gaps.push({ from: known, to: from });
      known = Math.max(known, to);
    }
    return gaps;
  }
}

function lane(signal: Recorded, pieces: Piece[]): Lane {
  const edges: Edge[] = [];
  const busy: Busy[] = [];
  for (const piece of pieces) {
    if (piece.length === 6) {
      const [from, to, count, low, high, behind] = piece;
      busy.push({ from, to, count, low, high });
      edges.push([from, NaN, ''], [to, behind, shown(signal, behind)]);
    } else {
      const [ms, value, text] = piece;
      edges.push(value === null ? [ms, NaN, text ?? ''] : [ms, value, shown(signal, value)]);
    }
  }
  return { name: signal.name, type: signal.bool ? 'bool' : 'real', step: signal.class === 'steps', edges, busy, height: signal.bool ? undefined : TALL };
}

export function shown(signal: Recorded, value: number): string {
  if (signal.bool) return value === 0 ? '0' : '1';
  const text = signal.real || signal.time ? String(Number(value.toPrecision(6))) : String(value);
  return signal.time ? `${text} s` : text;
}

export const past = new Past();
