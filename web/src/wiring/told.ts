// The wiring of a chart as the server tells it: `crates/g7/src/serve/wiring`.

export type Json = string | number | boolean | null | { [key: string]: Json };
export type Settings = Record<string, Json>;

export interface Setting {
  key: string;
  form:
    | { is: 'text' | 'number' | 'flag' | 'bad' }
    | { is: 'whole'; least: number; most: number }
    | { is: 'duration'; least: string; most: string }
    | { is: 'words'; words: string[] }
    | { is: 'table' | 'flag-or-table'; settings: Setting[] };
  /** `needed`: the file must say it; `is`: the default; `none`: there is none. */
  usual: 'needed' | 'is' | 'none';
  example: string;
  about: string;
}

export type Argument =
  | { is: 'nothing' }
  | { is: 'address' | 'bit'; most: number }
  | { is: 'text' | 'name' | 'list' | 'alone'; example: string }
  | { is: 'word'; words: string[] };

export interface PointKind {
  word: string;
  argument: Argument;
  carries: 'bit' | 'number' | 'whole' | 'any';
  input: boolean;
  output: boolean;
  of_input: Setting[];
  of_output: Setting[];
  about: string;
}

export interface Kind {
  word: string;
  about: string;
  shows: boolean;
  /** The program has it: not every build has all kinds. */
  there: boolean;
  settings: Setting[];
  points: PointKind[];
}

export interface Signal {
  name: string;
  role: 'input' | 'output' | 'variable' | 'step';
  carries: 'bit' | 'whole' | 'number' | 'text';
  type: string;
  comment?: string | null;
  address?: string | null;
  inverted?: boolean;
  safe?: string | null;
}

export interface Device {
  name: string;
  kind: string | null;
  settings: Settings;
}

export type Table = 'inputs' | 'outputs' | 'shown';

export interface Channel {
  key: string;
  /** The variable that the key names, by its name or its address. */
  variable: string | null;
  at: string | null;
  /** It is a point alone, not a table. */
  short: boolean;
  settings: Settings;
}

export interface Problem {
  code: string;
  path: string[] | null;
  line: number;
  what: string;
  help: string | null;
  related: string[];
  error: boolean;
}

export interface Sight {
  io: string;
  hash: string | null;
  text: string;
  read_only: boolean;
  asks: boolean;
  online: boolean;
  chart: string[];
  signals: Signal[];
  devices: Device[];
  channels: Record<Table, Channel[]>;
  problems: Problem[];
  kinds: Kind[];
}

export type Change =
  | { do: 'set'; path: string[]; value: Json }
  | { do: 'remove'; path: string[] }
  | { do: 'rename'; from: string; to: string };

export interface Reading {
  value?: string;
  raw?: string;
  why?: string;
}

export interface DeviceLive {
  is: 'answers' | 'silent' | 'server' | 'panel';
  took_ms?: number;
  why?: string;
}

export interface Live {
  no?: 'online' | 'reached';
  hash?: string | null;
  devices?: Record<string, DeviceLive>;
  values?: Record<string, Reading>;
}
