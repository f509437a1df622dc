// The messages between the page and the Rust crate `g7-page`, which answers them in the page's
// worker (as wasm) and in the server. Places in texts are UTF-16 code units; geometry is in px at
// 100 % zoom.

export type Box = [x: number, y: number, w: number, h: number];

export interface Splice {
  from: number;
  to: number;
  insert: string;
}

export interface Fix {
  title: string;
  splices: Splice[];
}

export interface Problem {
  code: string;
  title: string;
  severity: 'error' | 'warning';
  what: string;
  help?: string;
  from: number;
  to: number;
  line: number;
  column: number;
  related: { from: number; to: number; what: string }[];
  /** The ids of the symbols that it marks. */
  items: string[];
  fixes: Fix[];
}

export type ChartKind = 'chart' | 'expansion' | 'task';

export interface ChartRow {
  name: string;
  kind: ChartKind;
  comment?: string;
  from: number;
  to: number;
  steps: number;
  transitions: number;
  /** The chart and the step that this chart is the expansion of, or that enclose it. */
  of?: [chart: string, step: string];
}

export interface TestRow {
  name: string;
  from: number;
  to: number;
  plant?: string;
}

/** A switch of the profile: its two words, the profile's own choice, and the choice of the file if
 * any. */
export interface SwitchRow {
  words: [string, string];
  usual: string;
  set?: string;
}

/** The overview of a file. */
export interface Look {
  file: string;
  version: number;
  length: number;
  hash: string;
  /** True if the text has no syntax errors. */
  clean: boolean;
  imported?: boolean;
  can_undo: boolean;
  can_redo: boolean;
  problems: Problem[];
  charts: ChartRow[];
  profile: string;
  switches: SwitchRow[];
  /** The greatest number of passes in a scan. */
  bound: { usual: number; set?: number };
  scan_ms: number;
  plants: string[];
  tests: TestRow[];
}

/** The overview after a change that the page did not type itself. */
export interface Edited extends Look {
  splices: Splice[];
  select?: string[];
  /** The symbol whose text is to be edited next. */
  begin?: string;
  /** Sentences for the user about the change. */
  told?: string[];
}

export type Part = 'step' | 'action' | 'transition' | 'link' | 'connector' | 'comment' | 'text';

/** A part of a drawing that can be pointed at. */
export interface Item {
  id: string;
  part: Part;
  /** The bounding box, texts included. */
  area: Box;
  /** The SVG of the symbol. */
  svg: string;
  /** Path data for zoomed-out views. */
  far: string;
  from: number;
  to: number;
  square?: Box;
  bar?: Box;
  text?: Box;
  name?: string;
  label?: string;
  comment?: string;
  /** The chart that a macro-step opens. */
  macro?: string;
  step?: 'plain' | 'entry' | 'exit' | 'macro' | 'enclosing';
  encloses?: string[];
  initial?: boolean;
  /** The receptivity or the action as typed. */
  source?: string;
  priority?: number;
  /** The names of the preceding and succeeding steps of a transition. */
  steps?: [before: string[], after: string[]];
  /** The two ends of a link. */
  ends?: [string, string];
  /** The anchor. */
  at?: [number, number];
}

export interface Drawing {
  chart: string;
  kind: ChartKind;
  /** True if this is an earlier drawing, because the text has syntax errors. */
  stale: boolean;
  area: Box;
  items: Item[];
}

/** A drawing as its difference from the one with the number `since`, if that is given. */
export interface Redrawn extends Omit<Drawing, 'items'> {
  number?: number;
  since?: number;
  /** A number: the symbol with this number there, but for its places in the text. An object with `as`: a symbol
   * that is drawn as that one. */
  items: (number | (Item & { as?: number }))[];
  /** The first and the last place in the text of each symbol that is a number. */
  places?: number[];
}

/** Two changes of one text, merged; no text if they contradict each other. */
export interface Merged {
  text: string | null;
  conflicts: number;
}

export interface DrawingLook {
  look?: 'iec60848' | 'sfc';
  pages?: 'pl7';
  actions?: boolean;
}

export interface Completion {
  label: string;
  kind: string;
  detail?: string;
  insert?: string;
}

export interface Completions {
  from: number;
  items: Completion[];
}

export interface Hover {
  from: number;
  to: number;
  markdown: string;
}

export interface VariableRow {
  name: string;
  class: 'input' | 'output' | 'var' | 'const';
  type: string;
  init?: string;
  address?: string;
  inverted?: boolean;
  retain?: boolean;
  safe?: string;
  comment?: string;
  chart?: string;
  from: number;
  to: number;
  uses?: number;
}

export interface StepSymbol {
  id: string;
  name: string;
  chart: string;
  comment?: string;
  from: number;
  to: number;
}

export interface Symbols {
  stale?: boolean;
  variables: VariableRow[];
  steps: StepSymbol[];
}

export interface SearchHit {
  from: number;
  to: number;
  line: number;
  text: string;
  chart?: string;
  /** The symbol that shows it. */
  id?: string;
}

/** A gesture; the ids name symbols of one chart. */
export type Gesture =
  | { g: 'add_step'; chart: string; at?: [number, number]; kind?: string }
  | { g: 'next'; id: string }
  | { g: 'before'; id: string }
  | { g: 'connect'; from: string; to: string }
  | { g: 'insert'; link: string; what: string }
  | { g: 'branch'; id: string; how: 'or' | 'and' }
  | { g: 'converge'; ids: string[]; how: 'or' | 'and'; to?: string }
  | { g: 'jump'; id: string; to: string }
  | { g: 'parallel'; ids: string[] }
  | { g: 'delete'; ids: string[]; heal: boolean }
  | { g: 'rename'; id?: string; name?: string; to: string }
  | { g: 'receptivity'; id: string; text: string }
  | { g: 'action'; id: string; index?: number; text: string }
  | { g: 'comment'; id: string; text: string }
  | { g: 'comment_at'; chart: string; text: string; at: [number, number] }
  | { g: 'ends'; id: string; before?: string[]; after?: string[] }
  | { g: 'label'; id: string; text: string }
  | { g: 'priority'; id: string; n: number | null }
  | { g: 'initial'; id: string; on: boolean }
  | { g: 'kind'; id: string; kind: 'plain' | 'macro' | 'enclosing' | 'entry' | 'exit' }
  | { g: 'move'; ids: string[]; dx: number; dy: number }
  | { g: 'align'; ids: string[]; how: 'left' | 'top' | 'center' | 'distribute_x' | 'distribute_y' }
  | { g: 'tidy'; chart: string }
  | { g: 'paste'; chart: string; text: string; at?: [number, number] }
  | { g: 'cut'; ids: string[] }
  | { g: 'add_chart'; kind: ChartKind; name?: string }
  | { g: 'delete_chart'; chart: string }
  | { g: 'macro'; ids: string[] }
  | { g: 'variable'; name: string | null; row: Partial<VariableRow> }
  | { g: 'delete_variable'; name: string }
  | { g: 'profile'; name: string }
  | { g: 'switch'; name: string; on: boolean }
  | { g: 'bound'; n: number | null }
  | { g: 'scan'; ms: number };

export type SignalRole = 'input' | 'output' | 'variable' | 'plant';
export type SignalType = 'bool' | 'int' | 'real' | 'time' | 'text';

export interface SignalRow {
  name: string;
  role: SignalRole;
  type: SignalType;
  declared: string;
  comment?: string;
  address?: string;
  driven: boolean;
}

export interface RunStep {
  id: string;
  name: string;
  chart: string;
  /** The name of the signal of its activity. */
  activity: string;
  macro: boolean;
  inner: boolean;
}

export interface Started {
  run: string;
  file: string;
  profile: string;
  period_ms: number;
  signals: SignalRow[];
  steps: RunStep[];
  transitions: { id: string }[];
  plant?: string;
  view?: { file: string; svg?: string; bindings: { element: string; attribute: string }[] };
  /** The fingerprint of the text that runs, as in the overview of a file. */
  hash: string;
  /** The ids of the breakpoints. */
  breaks: string[];
  frame: Frame;
}

/** What changed in a run since its last frame; a full frame contains everything. */
export interface Frame {
  run: string;
  now_ms: number;
  scans: number;
  passes: number;
  full: boolean;
  on: number[];
  off: number[];
  times?: Record<string, number>;
  /** 0 not enabled, 1 enabled, 2 enabled and the receptivity is true. */
  enabled: [number, 0 | 1 | 2][];
  cleared: number[];
  values: [number, string, number][];
  forced: [number, boolean][];
  view: [number, boolean | number | string][];
  within?: boolean;
  late?: boolean;
  live?: boolean;
  stopped?: { id: string };
  halt?: { what: string; ids: string[]; from?: number; to?: number };
  notes?: string[];
}

export interface Lane {
  signal: number;
  edges: [ms: number, value: number, show: string][];
}

export interface TestResult {
  name: string;
  ok: boolean;
  from: number;
  to: number;
  simulated_ms: number;
  scans: number;
  notes?: string[];
  failure?: { message: string; from: number; to: number; time_ms: number; got: [string, string][]; situation: string; chronogram?: string };
}

export interface TestAnswer {
  passed: number;
  failed: number;
  tests: TestResult[];
  coverage: { sort: string; total: number; reached: number; missed: string[] }[];
  problems: Problem[];
}

/** A sentence in each language of the page. */
export type Said = [en: string, fr: string, pt: string];

/** A scan of a run: the inputs that change, by the number of their word; values as decimal texts. */
export interface ProofScan {
  wait_ns: number;
  set: [number, string][];
}

/** The answer to one question about all runs. */
export interface ProofRow {
  /** The number of the question. */
  number: number;
  claim: Said;
  /** True if the author asks it in the file. */
  own: boolean;
  about: 'step' | 'transition' | 'action' | 'variable' | 'deadlock' | 'conflict' | 'chart' | 'property';
  verdict: 'proved' | 'refuted' | 'open';
  reason: Said;
  /** The way out; empty if none is known. */
  help: Said;
  from: number;
  to: number;
  line: number;
  /** The symbol that is asked about. */
  id?: string;
  /** The symbols that take part in what the last scan of the run shows. */
  blame?: string[];
  /** The run that shows the answer. */
  run?: ProofScan[];
  /** The ways in which the plant of the run ticked, where it draws random numbers. */
  chance?: number[];
}

export interface ProofReport {
  /** The fingerprint of the text that was asked. */
  hash: string;
  /** True where errors stand in the way of all questions. */
  refused: boolean;
  rows: ProofRow[];
}

/** The ways on from a refuted claim, each a change of the text. */
export interface ProofWays {
  cures: { sort: 'exclusive' | 'parallel' | 'priority' | 'assume'; with: string[]; splices: Splice[] }[];
  test?: { title: string; splices: Splice[] };
  /** Why there is no test. */
  untested?: Said;
}

/** The answer to a comparison of two charts for every sequence of inputs. */
export interface ComparedReport {
  is: 'equal' | 'apart' | 'open' | 'unlike' | 'errors';
  /** The first difference, what is in the way, or why they cannot be compared. */
  reason: Said;
  help: Said;
  /** More states may decide it. */
  more: boolean;
  /** There are assumptions, which the inputs of both keep. */
  assumed: boolean;
  /** The number of the chart with errors. */
  side?: number;
  /** Pairs of states. */
  states: number;
  scans: number;
  /** The run of each chart up to the first difference. */
  runs?: [ProofScan[], ProofScan[]];
}

/** A language of logic: Structured Text, Instruction List, Ladder. */
export type Tongue = 'st' | 'il' | 'ld';

/** A receptivity, a condition or a body in each language. */
export interface LogicPiece {
  part: 'receptivity' | 'condition' | 'event' | 'body';
  /** The number of the action in its step. */
  index?: number;
  /** The text is null if the language cannot express the piece; Ladder comes with its picture in
   * SVG. */
  forms: { tongue: Tongue; text: string | null; picture?: string }[];
}

/** A form in which a chart can be exported. */
export interface Form {
  word: string;
  title: string;
  kind: 'chart' | 'code' | 'picture';
  /** G7 reads it back as a chart. */
  read: boolean;
}

export interface OutFile {
  name: string;
  text: string;
  /** The lines, from 0, that belong to a symbol. */
  marks: { id: string; lines: number[] }[];
}

/** An exported chart. */
export interface Out {
  files: OutFile[];
  /** Parts of the chart that the export does not contain; places are those of the chart. */
  problems: Problem[];
  /** True if the export has another meaning than the chart. */
  lossy: boolean;
}
