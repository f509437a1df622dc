// The messages of a running controller, as `crates/g7/src/operator/board.rs` writes them. Times are
// seconds of the controller's clock.
import type { Part as RunPart } from '../lib/instances.svelte';
import type { Shelved } from '../lib/protocol';

export interface Signal {
  name: string;
  role: 'input' | 'output' | 'variable';
  bool: boolean;
  type: string;
  comment?: string | null;
  address?: string | null;
  device?: string | null;
  point?: string | null;
  forcible: boolean;
  /** The part of a panel that it is. */
  panel?: Part | null;
}

/** A part of a panel: what a person finds on this page. */
export interface Part {
  is: 'button' | 'switch' | 'number' | 'choice' | 'page' | 'lamp' | 'value';
  min: number | null;
  max: number | null;
  words?: string[];
  colour?: 'green' | 'red' | 'yellow' | 'blue' | 'white';
}

/** The picture of the plant. A part that is not known is not measured at the machine. */
export interface View {
  file: string;
  simulated: boolean;
  bindings: { element: string; attribute: string; known: boolean }[];
}

export interface Step extends RunPart {
  name: string;
  chart: string;
  comment?: string | null;
  macro: boolean;
}

export interface Description {
  /** The name of the machine. */
  title: string;
  file: string;
  text: string;
  /** The files that it uses. */
  uses: Shelved[];
  profile: string;
  period_ms: number;
  plant?: string | null;
  signals: Signal[];
  steps: Step[];
  transitions: RunPart[];
  devices: { name: string; kind: string; place: string }[];
  picture?: View | null;
  force: { usual_s: number; longest_s: number; most: number };
  frame: Frame;
}

export type Quality = 'good' | 'bad' | 'substituted' | 'unread' | 'simulated' | 'free' | 'safe' | '';

export interface Reason {
  kind: 'watchdog' | 'input' | 'halt';
  name?: string;
  why?: string;
}

export interface Mode {
  is: 'stop' | 'run' | 'fault';
  since: number;
  reason: Reason | null;
  /** True until the devices have given their first values. */
  waits: boolean;
}

export interface Spread {
  p50_us: number;
  p99_us: number;
  most_us: number;
}

export interface Counts {
  scans: number;
  missed: number;
  lost: number;
  late: Spread;
  took: Spread;
}

export interface Forced {
  signal: number;
  value: string;
  until: number;
}

export interface DeviceState {
  up: boolean | null;
  since: number;
  why: string;
}

/** How the chart that runs and its file are to each other. */
export interface ChartFile {
  differs: boolean;
  /** There is a chart before the latest change. */
  back: boolean;
  /** A change is being made. */
  busy: boolean;
}

export type Kind =
  | 'changed' | 'back' | 'run' | 'stop' | 'fault' | 'missed' | 'forced' | 'released' | 'ended' | 'no-priority' | 'unsaved' | 'unrecorded' | 'recorded'
  | 'no-events' | 'events'
  | 'pressed' | 'set' | 'up' | 'down' | 'no-input' | 'input' | 'no-output' | 'output' | 'limited' | 'note';

export interface Event {
  n: number;
  at: number;
  kind: Kind;
  level: 'note' | 'warning' | 'alarm';
  /** Its cause is gone. */
  over: boolean;
  /** A person has seen it. */
  seen: boolean;
  reason?: Reason;
  name?: string;
  value?: string;
  device?: string;
  master?: boolean;
  /** Who did it, where that is known. */
  who?: string | null;
  why?: string | null;
  count?: number;
}

/** What has changed since the frame before, or all. */
export interface Frame {
  full: boolean;
  now: number;
  /** The age of all this. */
  age: number;
  /** It runs another chart from here on: its names are to be asked for. */
  renew?: true;
  file?: ChartFile;
  mode?: Mode;
  counts?: Counts;
  on?: [step: number, ms: number][];
  enabled?: Record<string, 1 | 2>;
  forced?: Forced[];
  devices?: DeviceState[];
  events?: Event[];
  values?: [signal: number, value: string, quality: Quality][];
  view?: [part: number, value: boolean | number | string][];
}

/** The wishes of a person, and what is told of each (`crates/g7/src/operator/order.rs`). */
export interface Wishes {
  operator_watch: { asked: object; told: Description };
  operator_run: { asked: object; told: null };
  operator_stop: { asked: object; told: null };
  operator_ack: { asked: object; told: null };
  operator_cold: { asked: object; told: null };
  operator_force: { asked: { name: string; value: string; seconds?: number }; told: null };
  operator_release: { asked: { name: string }; told: null };
  operator_release_all: { asked: object; told: null };
  operator_change: { asked: { anyway?: boolean }; told: Changed };
  operator_back: { asked: { anyway?: boolean }; told: Changed };
  operator_press: { asked: { name: string; down: boolean }; told: null };
  operator_set: { asked: { name: string; value: string }; told: null };
  operator_seen: { asked: { event: number; all: boolean }; told: null };
}

/** A change of the chart that was made, or what it would lose. */
export type Changed = { lost: string[] } | { asks: string[] };
