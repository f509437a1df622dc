// The messages between the page and the Rust crate `g7-page`, which answers them in the page's worker (as wasm)
// and in the server. Made by `make types` of the table in `crates/page/src/request.rs`; a test compares it.
// Places in texts are UTF-16 code units; geometry is in px at 100 % zoom.

/** The kinds of claims. */
export type About = 'step' | 'transition' | 'action' | 'variable' | 'deadlock' | 'conflict' | 'chart' | 'property';

/** An action as typed, and the parts of its head. */
export type ActionForm = {
  text: string;
  qualifier?: string;
  /** Its time as typed. */
  time?: string;
  /** The number and the unit of the time, if it has just one of each. */
  amount?: [string, string];
  /** All qualifiers. */
  qualifiers: Array<QualifierRow>;
  /** The units of times. */
  units: Array<string>;
};

/** How the actions of a step can stand. */
export type ActionsForm = 'column' | 'row';

/** A test with the change that adds it. */
export type Added = { title: string; splices: Array<Splice> };

/** Kinds of alignment. */
export type Alignment = 'left' | 'top' | 'center' | 'distribute_x' | 'distribute_y';

/** A symbol that looks like one of the other drawing. */
export type Alike = {
  /** The number of the symbol in the other drawing. */
  as: number;
  /** The distance from the old symbol to this one, to the right and down. */
  by: Spot;
  id: string;
  part: Part;
  area: Box;
  from: number;
  to: number;
  square?: Box;
  bar?: Box;
  text?: Box;
  /** The anchor: the middle of the upper edge of a step, the middle of the bar of a transition. */
  at?: Spot;
  name?: string;
  label?: string;
  comment?: string;
  /** The receptivity or the action as typed. */
  source?: string;
  priority?: number;
  /** The names of the preceding and the succeeding steps of a transition. */
  steps?: [Array<string>, Array<string>];
  step?: StepKind;
  macro?: string;
  encloses?: Array<string>;
  initial?: boolean;
  ends?: [string, string];
  /** How many segments at the start and at the end of a link no bend moves; absent if none can be moved. */
  held?: [number, number];
  /** The bends that the text gives a link: true if it follows them, false if they do not fit at present. */
  bent?: boolean;
  /** The form that the text gives a link, whatever the drawing could do. */
  form?: LinkForm;
  /** How the actions of a step stand, where it has a choice of its own. */
  stacked?: ActionsForm;
};

/** An answer: its sentences in the order in which they are read, causes behind their effects. */
export type Because = { lines: Array<WhyLine> };

/** The text before the last change; null if there was none. */
export type Before = { text: string | null };

/** A part that is inserted into a link; the step or transition that alternation needs comes with
 * it. */
export type Between = 'step' | 'transition' | 'macro' | 'enclosing';

export type Binding = { element: string; attribute: string };

/** The greatest number of passes in a scan. */
export type Bound = { usual: number; set?: number };

/** A rectangle, sent as its left and upper edge, width, height. */
export type Box = [number, number, number, number];

/** Kinds of branching. */
export type Branching = 'or' | 'and';

/** The breakpoints of a run. */
export type Breaks = {
  /** The ids of their symbols. */
  ids: Array<string>;
};

/** Kinds of chart. */
export type ChartKind = 'chart' | 'expansion' | 'task';

export type ChartRow = {
  name: string;
  kind: ChartKind;
  comment?: string;
  from: number;
  to: number;
  steps: number;
  transitions: number;
  /** The file in which it stands, if that is another one. */
  file?: string;
  /** The names of its parameters. */
  params?: Array<string>;
  /** The function block whose instances have such a chart each. */
  block?: string;
  /** Its instances that have a name of their own. */
  instances?: Array<string>;
  /** The chart and the step that this chart is the expansion of, or that enclose it. */
  of?: [string, string];
};

/** The answer. */
export type ComparedReport = {
  is: Outcome;
  /** The reason: the proof, the first difference, what is in the way, why they cannot be compared. */
  reason: [string, string, string];
  /** The way on; empty if none is known. */
  help: [string, string, string];
  /** More states or time may decide it. */
  more: boolean;
  /** There are assumptions, which the inputs of both keep. */
  assumed: boolean;
  /** The file with errors. */
  side?: number;
  /** Pairs of states. */
  states: number;
  /** Scans of both: all that were made, or those that do not tell them apart. */
  scans: number;
  /** The shortest run that tells them apart, for each of them. */
  runs?: [Array<ProofScan>, Array<ProofScan>];
};

export type Completion = { label: string; kind: string; detail: string; insert: string };

/** The possible words, and the place at which the word begins. */
export type Completions = { from: number; items: Array<Completion> };

/** A change of the text that a refuted claim offers. */
export type Cure = {
  sort: CureSort;
  /** The texts that its title names. */
  with: Array<string>;
  splices: Array<Splice>;
};

/** The kinds of cures. */
export type CureSort = 'exclusive' | 'parallel' | 'priority' | 'assume';

/** The file after a change, and the change itself, which the text view makes too. */
export type Edited = {
  splices: Array<Splice>;
  select: Array<ItemId>;
  begin?: ItemId;
  told?: Array<string>;
  file: string;
  version: number;
  length: number;
  hash: string;
  clean: boolean;
  imported: boolean;
  can_undo: boolean;
  can_redo: boolean;
  problems: Array<Problem>;
  /** The names that nothing declares. */
  undeclared: Array<Undeclared>;
  charts: Array<ChartRow>;
  profile: string;
  switches: Array<SwitchRow>;
  bound: Bound;
  scan_ms: number;
  plants: Array<string>;
  /** The files of their pictures, as the text names them: relative to this file. */
  pictures: Array<string>;
  tests: Array<TestRow>;
  /** The names of the files that it uses, and that those use; also of files that are not there. */
  uses: Array<string>;
  /** The names of those whose texts are to be lent. */
  wants: Array<string>;
  /** The names of the parts of the library that they use. */
  parts: Array<string>;
};

/** A locked part that is not as it was. */
export type ExerciseChange = {
  what: string;
  /** Its place; none where the part is missing. */
  from?: number;
  to?: number;
};

/** A checked work. */
export type ExerciseChecked = {
  mark: ExerciseMark;
  /** The errors of the charts; nothing ran then. */
  problems: Array<Problem>;
  changed: Array<ExerciseChange>;
  /** The names that the exercise looks at and that are missing: a sentence for each. */
  missing: Array<string>;
  tests: Array<ExerciseTest>;
  questions: Array<ExerciseQuestion>;
};

/** A mistake of an exercise. */
export type ExerciseFault = {
  /** A path, or `path:line:column`. */
  place: string;
  what: string;
};

/** The part of an exercise that checks a work. */
export type ExerciseGiven = {
  /** The text of the template, which the student gets. */
  template: string;
  /** The files that it uses, by their paths from its folder. */
  uses: Array<Shelved>;
  /** The hidden part. */
  sealed: string;
};

/** The result of a check in one word. */
export type ExerciseMark = 'passed' | 'changed' | 'fitted' | 'failed' | 'unread';

/** An exercise as students get it, or the mistakes of its folder. */
export type ExercisePacked = {
  /** One for each language of the page. */
  texts: Array<ExerciseTexts>;
  given: ExerciseGiven | null;
  faults: Array<ExerciseFault>;
};

/** A question of the exercise. A hidden one has neither claim nor run. */
export type ExerciseQuestion = {
  hidden: boolean;
  verdict: Verdict;
  claim?: string;
  reason?: string;
  /** The run that breaks it. */
  run?: Array<ProofScan>;
};

/** A test of the exercise. Of a hidden one there are only `hidden`, `ok` and the time. */
export type ExerciseTest = {
  hidden: boolean;
  ok: boolean;
  title?: string;
  /** Why it failed. */
  why?: string;
  /** When it failed. */
  time_ms?: number;
  /** The names in the condition that failed, with their values. */
  got: Array<[string, string]>;
  /** The scans up to that moment; none where inputs alone do not lead there. */
  run?: Array<ProofScan>;
};

/** The texts of an exercise in one language. */
export type ExerciseTexts = { language: string; title: string; statement: string; hints: Array<string> };

export type Failure = {
  message: string;
  /** The place of the failed statement. */
  from: number;
  to: number;
  time_ms: number;
  got: Array<[string, string]>;
  situation: string;
  chronogram: string;
};

/** A change that fixes a problem. */
export type Fix = {
  title: string;
  /** The change of the text. A fix that is a gesture has none; the message `mend` executes it. */
  splices?: Array<Splice>;
};

/** The effect that a gesture would have. */
export type Foreseen = {
  /** The text that was probably meant by one that cannot be read. */
  meant?: string;
  /** The names in its symbol that nothing would declare. */
  undeclared: Array<Undeclared>;
};

/** A form in which a chart can be exported. */
export type Form = {
  word: string;
  title: string;
  kind: FormSort;
  /** It is read back as a chart. */
  read: boolean;
};

/** The kinds of forms. */
export type FormSort = 'chart' | 'code' | 'picture';

/** A frame. Steps, transitions, signals and bindings are numbered as in the description of the run. */
export type Frame = {
  run: string;
  now_ms: number;
  scans: number;
  passes: number;
  full: boolean;
  /** Steps that became active. */
  on: Array<number>;
  /** Steps that became inactive. */
  off: Array<number>;
  /** The time since activation of each active step, in ms. */
  times?: { [key in number]: number };
  /** Enabled transitions: 0 not enabled, 1 enabled, 2 enabled and the receptivity is true. */
  enabled: Array<[number, 0 | 1 | 2]>;
  cleared: Array<number>;
  values: Array<[number, string, number]>;
  forced: Array<[number, boolean]>;
  view: Array<[number, Show]>;
  /** True between two passes of a scan. */
  within?: boolean;
  /** True if the frame shows the present and not an earlier scan. */
  live: boolean;
  /** True if the run could not keep up with the requested time. */
  late?: boolean;
  stopped?: Stopped;
  halt?: Halted;
  notes?: Array<string>;
};

/** One gesture of the editor. */
export type Gesture =
  | {
    g: 'add_step';
    /** The chart. */
    chart: string;
    /** Its place, in pixels of the drawing. */
    at?: [number, number] | null;
    /** Its kind; a plain step if absent. */
    kind?: StepKind | null;
  }
  | {
    g: 'next';
    /** The step or transition. */
    id: ItemId;
  }
  | {
    g: 'before';
    /** The step or transition. */
    id: ItemId;
  }
  | {
    g: 'connect';
    /** The start of the link. */
    from: ItemId;
    /** The end of the link. */
    to: ItemId;
  }
  | {
    g: 'relink';
    /** The link, or one end of a broken one. */
    link: ItemId;
    /** The end that moves. */
    end: LinkEnd;
    /** The step or transition at which it ends then. */
    to: ItemId;
  }
  | {
    g: 'insert';
    /** The link. */
    link: ItemId;
    /** The part to insert. */
    what?: Between;
  }
  | {
    g: 'branch';
    /** The step or transition at which it begins. */
    id: ItemId;
    /** A selection (or) or simultaneous sequences (and). */
    how: Branching;
  }
  | {
    g: 'converge';
    /** The ends of the branches. */
    ids: Array<ItemId>;
    /** The end of a selection (or) or of simultaneous sequences (and). */
    how: Branching;
    /** The step they lead to; a new one if absent. */
    to?: ItemId | null;
  }
  | {
    g: 'jump';
    /** The step or transition at which it starts. */
    id: ItemId;
    /** The step to which it leads. */
    to: ItemId;
  }
  | {
    g: 'parallel';
    /** The steps and transitions of the sequence. */
    ids: Array<ItemId>;
  }
  | {
    g: 'delete';
    /** The parts. */
    ids: Array<ItemId>;
    /** Join what was before the parts to what was after them. */
    heal?: boolean;
  }
  | {
    g: 'rename';
    /** The step or chart. */
    id?: ItemId | null;
    /** A variable instead, as `Chart.name` if it belongs to a chart. */
    name?: string | null;
    /** The new name. */
    to: string;
  }
  | {
    g: 'receptivity';
    /** The transition. */
    id: ItemId;
    /** The receptivity as typed. */
    text: string;
  }
  | {
    g: 'action';
    /** The step, or one of its actions. */
    id: ItemId;
    /** The number of the action, from 0; a new action if absent. */
    index?: number | null;
    /** The action as typed; empty to delete it. */
    text: string;
  }
  | {
    g: 'comment';
    /** The commented part, or the comment of the layout section. */
    id: ItemId;
    /** The text without quotes. Empty removes the comment. */
    text: string;
  }
  | {
    g: 'comment_at';
    /** The chart. */
    chart: string;
    /** The text without quotes. */
    text: string;
    /** Its upper left corner, in pixels. */
    at: [number, number];
  }
  | {
    g: 'label';
    /** The transition. */
    id: ItemId;
    /** The label; empty for none. */
    text: string;
  }
  | {
    g: 'priority';
    /** The transition. */
    id: ItemId;
    /** The priority, 1 being the first; absent for none. */
    n?: number | null;
  }
  | {
    g: 'ends';
    /** The transition. */
    id: ItemId;
    /** The names of the preceding steps; unchanged if absent. */
    before?: Array<string> | null;
    /** The names of the succeeding steps; unchanged if absent. */
    after?: Array<string> | null;
  }
  | {
    g: 'initial';
    /** The step. */
    id: ItemId;
    /** True if the step is initial. */
    on: boolean;
  }
  | {
    g: 'kind';
    /** The step. */
    id: ItemId;
    /** The kind. */
    kind: StepKind;
  }
  | {
    g: 'move';
    /** Steps and transitions. */
    ids: Array<ItemId>;
    /** Distance to the right, in pixels. */
    dx: number;
    /** Distance downward, in pixels. */
    dy: number;
  }
  | {
    g: 'align';
    /** Steps and transitions. */
    ids: Array<ItemId>;
    /** The kind of alignment. */
    how: Alignment;
  }
  | {
    g: 'bend';
    /** The link. */
    link: ItemId;
    /** For each height at which it goes sideways, that height, and the place from which it goes on; in pixels,
     * from its start. Without any the link goes the way of the layout again. */
    points: Array<[number, number]>;
  }
  | {
    g: 'link_form';
    /** The link, or one end of a broken one. */
    link: ItemId;
    /** The form; the layout decides if absent. */
    form?: LinkForm | null;
  }
  | {
    g: 'action_form';
    /** The step, one of its actions, or the chart. */
    id: ItemId;
    /** The form; if absent, a step follows its chart and a chart has them one below the other. */
    form?: ActionsForm | null;
  }
  | {
    g: 'sheet';
    /** The chart; every chart of the file if absent, which then gets no place. */
    chart?: string | null;
    /** The place of the origin of its drawing, in pixels; without one it stands in the rows of the sheet. */
    at?: [number, number] | null;
  }
  | {
    g: 'tidy';
    /** The chart. */
    chart: string;
  }
  | {
    g: 'paste';
    /** The chart. */
    chart: string;
    /** The text. */
    text: string;
    /** The place of its first step, in pixels. */
    at?: [number, number] | null;
  }
  | {
    g: 'cut';
    /** The parts. */
    ids: Array<ItemId>;
  }
  | {
    g: 'add_chart';
    /** The kind of chart. */
    kind?: ChartKind;
    /** Its name; a new one is found if absent. */
    name?: string | null;
  }
  | {
    g: 'delete_chart';
    /** The chart. */
    chart: string;
  }
  | {
    g: 'macro';
    /** Its steps and transitions. */
    ids: Array<ItemId>;
  }
  | {
    g: 'variable';
    /** The variable to change, `Chart.name` if it belongs to a chart; a new one if absent. */
    name?: string | null;
    /** The new contents of the row. */
    row: VariableEdit;
  }
  | {
    g: 'declare';
    /** Their rows. */
    rows: Array<VariableEdit>;
    /** The gesture, which is undone with them. */
    with?: Gesture | null;
  }
  | {
    g: 'delete_variable';
    /** Its name, `Chart.name` if it belongs to a chart. */
    name: string;
  }
  | {
    g: 'profile';
    /** Its name. */
    name: string;
  }
  | {
    g: 'switch';
    /** The word of the switch, for instance `one-pass`. */
    name: string;
    /** True to write the switch, false to leave it to the profile. */
    on: boolean;
  }
  | {
    g: 'bound';
    /** The number; the profile decides if absent. */
    n?: number | null;
  }
  | {
    g: 'scan';
    /** The time in milliseconds. */
    ms: number;
  }
  | {
    g: 'view';
    /** The plant. */
    plant: string;
    /** The SVG file, relative to the file of the plant. */
    file: string;
    /** All bindings that the picture has then. */
    bindings: Array<PictureBinding>;
  };

/** The fault that ended a run, with its place in the text from which the run was started. */
export type Halted = { what: string; ids: Array<string>; from?: number; to?: number };

/** An explanation of a piece of the text. */
export type Hover = { from: number; to: number; markdown: string };

/** A symbol with its drawing. */
export type Item = {
  /** The SVG of the symbol. */
  svg: string;
  /** Path data for zoomed-out views. */
  far: string;
  id: string;
  part: Part;
  area: Box;
  from: number;
  to: number;
  square?: Box;
  bar?: Box;
  text?: Box;
  /** The anchor: the middle of the upper edge of a step, the middle of the bar of a transition. */
  at?: Spot;
  name?: string;
  label?: string;
  comment?: string;
  /** The receptivity or the action as typed. */
  source?: string;
  priority?: number;
  /** The names of the preceding and the succeeding steps of a transition. */
  steps?: [Array<string>, Array<string>];
  step?: StepKind;
  macro?: string;
  encloses?: Array<string>;
  initial?: boolean;
  ends?: [string, string];
  /** How many segments at the start and at the end of a link no bend moves; absent if none can be moved. */
  held?: [number, number];
  /** The bends that the text gives a link: true if it follows them, false if they do not fit at present. */
  bent?: boolean;
  /** The form that the text gives a link, whatever the drawing could do. */
  form?: LinkForm;
  /** How the actions of a step stand, where it has a choice of its own. */
  stacked?: ActionsForm;
};

/** The id of a part of a chart. */
export type ItemId = string;

/** Steps that healing joins: those that stand before and behind a transition that it changes. */
export type Joined = {
  /** The preceding steps. */
  before: Array<string>;
  /** The succeeding steps. */
  behind: Array<string>;
};

/** A run of symbols that look the same and stand in the same order in the other drawing. */
export type Kept = {
  /** The number of the first of them in the other drawing. */
  as: number;
  count: number;
  /** How far they have moved. */
  by: Spot;
  /** By how many code units their places in the text have moved. */
  along: number;
  /** Their ids, if they have changed: an id contains the number of its transition. */
  ids?: Array<string>;
  /** With `ids`: the ends of the links among them. */
  ends?: Array<[string, string]>;
};

/** The lanes of a chronogram. */
export type Lanes = {
  start_ms: number;
  end_ms: number;
  /** For each signal its edges: instant (ms), number, value as text. */
  lanes: Array<Array<[number, number, string]>>;
};

/** The two ends of a link. */
export type LinkEnd = 'from' | 'to';

/** The forms in which a link can be drawn. */
export type LinkForm = 'line' | 'jump';

/** The part of a symbol that a piece of logic is. */
export type LogicPart = 'receptivity' | 'condition' | 'event' | 'body';

/** A piece of logic: the part of the symbol that it is, the number of the action in its step, and its text in the language
 * that was asked for. */
export type LogicPiece = {
  part: LogicPart;
  index?: number;
  /** Null if the language cannot express it. */
  text: string | null;
  /** Ladder has one. */
  picture?: string;
};

/** The overview of a file. */
export type Look = {
  file: string;
  version: number;
  length: number;
  hash: string;
  clean: boolean;
  imported: boolean;
  can_undo: boolean;
  can_redo: boolean;
  problems: Array<Problem>;
  /** The names that nothing declares. */
  undeclared: Array<Undeclared>;
  charts: Array<ChartRow>;
  profile: string;
  switches: Array<SwitchRow>;
  bound: Bound;
  scan_ms: number;
  plants: Array<string>;
  /** The files of their pictures, as the text names them: relative to this file. */
  pictures: Array<string>;
  tests: Array<TestRow>;
  /** The names of the files that it uses, and that those use; also of files that are not there. */
  uses: Array<string>;
  /** The names of those whose texts are to be lent. */
  wants: Array<string>;
  /** The names of the parts of the library that they use. */
  parts: Array<string>;
};

/** The lines of a text, from 0, that belong to a symbol. */
export type Mark = { id: string; lines: Array<number> };

/** The result of a merge. */
export type Merged = {
  /** The text with both changes; absent if they contradict each other. */
  text: string | null;
  /** The number of places at which they do. */
  conflicts: number;
};

export type NameRole = 'state' | 'const' | 'parts' | 'output' | 'input';

/** How a value is shown; an enumeration and what has a type of the file's own is `other`. */
export type NameType = 'bool' | 'int' | 'real' | 'text' | 'other';

/** An exported chart. */
export type Out = {
  files: Array<OutFile>;
  /** Problems: parts of the chart that the export does not contain; places are those of the
   * chart. */
  problems: Array<Problem>;
  /** True if the export has another meaning than the chart. */
  lossy: boolean;
};

/** One exported file. */
export type OutFile = {
  name: string;
  text: string;
  /** The lines that belong to each symbol. */
  marks: Array<Mark>;
};

/** The outcomes of a comparison. */
export type Outcome = 'equal' | 'apart' | 'open' | 'unlike' | 'errors';

/** The pages on which a chart is drawn. */
export type Pages = 'pl7';

/** The kinds of symbols. */
export type Part = 'step' | 'action' | 'transition' | 'link' | 'connector' | 'comment' | 'title' | 'text';

/** A binding of a picture: an attribute of an element follows a value. */
export type PictureBinding = {
  /** The element, by its name in the picture. */
  element: string;
  /** The attribute. */
  attribute: string;
  /** The value, an expression in the terms of the plant. */
  value: string;
};

/** A state, a constant or a queue of the plant, an output or an input of the charts. */
export type PictureName = {
  name: string;
  role: NameRole;
  type: NameType;
  /** The value of a binding to it: the name, or what the plant drives an input with. Empty if a picture cannot show it. */
  value: string;
  /** True if a part of the picture can turn it. */
  hand: boolean;
  /** The limits of a state as written. */
  limits?: [string, string];
  comment?: string;
};

/** The picture of a plant, and the names that it can show. */
export type PlantPicture = {
  /** The SVG file, if the plant has a picture. */
  file?: string;
  bindings: Array<PictureBinding>;
  names: Array<PictureName>;
};

/** Sheets as SVG, all of one size. */
export type Printed = {
  /** The width of a sheet in mm. */
  width: number;
  /** The height of a sheet in mm. */
  height: number;
  pages: Array<string>;
};

/** One problem. */
export type Problem = {
  code: string;
  title: string;
  severity: Severity;
  what: string;
  help?: string;
  from: number;
  to: number;
  line: number;
  column: number;
  related: Array<Related>;
  /** The ids of the symbols that it marks. */
  items: Array<string>;
  fixes: Array<Fix>;
  /** The name whose declaration solves the problem. The first fix without splices declares it in the likely way. */
  declares?: string;
};

/** All answers to the questions of a file. */
export type ProofReport = {
  /** The fingerprint of the text that was asked, as in the overview of a file. */
  hash: string;
  /** True where errors stand in the way of all questions. */
  refused: boolean;
  rows: Array<ProofRow>;
};

/** The answer to one question. */
export type ProofRow = {
  /** The number of the question. */
  number: number;
  claim: [string, string, string];
  /** True if the author asks it in the file. */
  own: boolean;
  /** The kind of claim, for the panel. */
  about: About;
  verdict: Verdict;
  reason: [string, string, string];
  /** The way out; empty if none is known. */
  help: [string, string, string];
  /** The place of what is asked about. */
  from: number;
  to: number;
  line: number;
  /** The symbol that is asked about. */
  id?: string;
  /** The symbols that take part in what the last scan of the run shows. */
  blame?: Array<string>;
  /** The run that shows the answer. */
  run?: Array<ProofScan>;
  /** The ways in which its plant ticked, for each scan; empty unless it draws random numbers. */
  chance?: Array<number>;
};

/** A scan of a run. */
export type ProofScan = {
  /** The time since the scan before, ns. */
  wait_ns: number;
  /** The input words that are not as in the scan before (in the first scan: not 0): number and value.
   * The value is a text, because numbers of the page have 53 bits. */
  set: Array<[number, string]>;
};

/** The ways on from a refuted claim. */
export type ProofWays = {
  cures: Array<Cure>;
  /** The change that adds a test to the file, which fails as long as the claim does. */
  test?: Added;
  /** Why there is no test. */
  untested?: [string, string, string];
};

/** A qualifier of actions. */
export type QualifierRow = {
  name: string;
  /** A time stands behind it. */
  timed: boolean;
  /** In a few words. */
  does: string;
};

/** The coverage of one kind of element. */
export type Reached = {
  sort: string;
  total: number;
  reached: number;
  /** The ids of the symbols that no test reached. */
  missed: Array<string>;
};

/** An answer: a whole drawing, or its difference from another. */
export type Redrawn = {
  /** The number of this drawing; none if it is not kept. */
  number?: number;
  /** The number of the drawing to which `items` refer. */
  since?: number;
  items: Array<Sent>;
  chart: string;
  kind: ChartKind;
  /** True if the drawing shows an earlier text, because the present one has syntax errors. */
  stale: boolean;
  area: Box;
  /** How the actions of steps without a choice of their own stand. */
  actions: ActionsForm;
};

export type Related = { from: number; to: number; what: string };

/** A symbol of a drawing in a run. */
export type RunPart = {
  /** The id of the symbol. */
  id: string;
  /** The instance that it belongs to, `Axis[3]`, if its chart has parameters: then several parts have one symbol. */
  instance?: string;
};

export type RunStep = {
  id: string;
  instance?: string;
  name: string;
  chart: string;
  /** The name of the signal of its activity. */
  activity: string;
  macro: boolean;
  inner: boolean;
};

/** A result of a search. */
export type SearchHit = { from: number; to: number; line: number; text: string; id?: string; chart?: string };

export type Sent = Kept | Alike | Item;

/** How grave a problem is. */
export type Severity = 'error' | 'warning';

/** An answer that the page has, in its language. */
export type SheetsAnswer = {
  claim: string;
  verdict: Verdict;
  reason: string;
  help: string;
  line: number;
  /** The author asks it. */
  own: boolean;
};

/** The texts of the title block. */
export type SheetsHead = { title: string; author: string; company: string; revision: string; date: string };

/** A file that another one uses. */
export type Shelved = {
  /** Its name; where that one is given as well, its path from the folder of that one. */
  file: string;
  /** Its text; none if it is not there. */
  text?: string | null;
};

/** A value of the plant's picture. */
export type Show = boolean | number | string;

/** The part that a signal plays. */
export type SignalRole = 'input' | 'output' | 'variable' | 'plant';

export type SignalRow = {
  name: string;
  role: SignalRole;
  type: SignalType;
  declared: string;
  /** Of an enumeration: the names of its values. */
  choices?: Array<string>;
  comment?: string;
  address?: string;
  driven: boolean;
};

/** The kinds of values. */
export type SignalType = 'bool' | 'int' | 'real' | 'time' | 'text';

/** The format of a file of signals. */
export type SignalsForm = 'csv' | 'vcd' | 'svg';

/** A replacement in a text; places are in code units. */
export type Splice = { from: number; to: number; insert: string };

/** A point or a vector, sent as its two lengths. */
export type Spot = [number, number];

/** The standard whose symbols are drawn. */
export type Standard = 'iec60848' | 'sfc';

/** The description of a run: the names of the numbers in its frames. */
export type Started = {
  run: string;
  file: string;
  profile: string;
  period_ms: number;
  signals: Array<SignalRow>;
  steps: Array<RunStep>;
  transitions: Array<RunPart>;
  plant?: string;
  view?: View;
  /** The fingerprint of the text that runs, as in the overview of a file. */
  hash: string;
  /** The ids of the breakpoints. */
  breaks: Array<string>;
  frame: Frame;
};

/** Kinds of step. */
export type StepKind = 'plain' | 'macro' | 'enclosing' | 'entry' | 'exit';

export type StepSymbol = {
  id: string;
  name: string;
  chart: string;
  comment: string;
  initial: boolean;
  from: number;
  to: number;
};

/** The breakpoint at which a run stopped. */
export type Stopped = { id: string };

/** A style sheet. */
export type Style = { css: string };

/** The answer to an on-line change. */
export type Swapped = Started | { lost: Array<string> };

/** A switch of the profile. */
export type SwitchRow = {
  /** The words for its two positions. */
  words: [string, string];
  /** The position that the profile implies. */
  usual: string;
  /** The position that the file sets beside the profile, if any. */
  set?: string;
};

/** The tables of variables and steps. */
export type Symbols = { stale: boolean; variables: Array<VariableRow>; steps: Array<StepSymbol> };

/** The results of the tests of a file. */
export type TestAnswer = {
  passed: number;
  failed: number;
  tests: Array<TestResult>;
  coverage: Array<Reached>;
  /** The problems because of which no test could run. */
  problems: Array<Problem>;
};

export type TestResult = {
  name: string;
  ok: boolean;
  from: number;
  to: number;
  simulated_ms: number;
  scans: number;
  notes?: Array<string>;
  failure?: Failure;
};

export type TestRow = { name: string; from: number; to: number; plant?: string };

/** Why a test failed. */
export type TestWhy = {
  /** Why the names in the condition have their values. */
  lines: Array<WhyLine>;
  /** The scans up to the failure; none if the test also forces, writes or restarts. */
  run?: Array<ProofScan>;
};

/** A text. */
export type Text = { text: string };

/** A language of controllers. */
export type Tongue = 'st' | 'il' | 'ld';

/** A name that nothing declares, with the declaration that its uses ask for. */
export type Undeclared = {
  name: string;
  /** `input`, `output` or `var`. */
  class: string;
  type: string;
  /** The ids of the symbols that use it. */
  items: Array<string>;
};

/** The classes of variables. */
export type VariableClass = 'input' | 'output' | 'var' | 'const';

/** A variable as the table shows it; a field is empty if the variable has no such part. */
export type VariableEdit = {
  /** Its name. */
  name?: string | null;
  /** `input`, `output`, `var` or `const`; `var` if empty. */
  class?: string | null;
  /** Its type; BOOL if empty. */
  type?: string | null;
  /** Its initial value. */
  init?: string | null;
  /** Its address or channel. */
  address?: string | null;
  /** True if the channel carries the complement. */
  inverted?: boolean;
  /** True if the value is kept over a restart. */
  retain?: boolean;
  /** For an output: its value after a fault. */
  safe?: string | null;
  /** Its comment, without quotes. */
  comment?: string | null;
  /** The chart to which it belongs; the file if absent. */
  chart?: string | null;
};

export type VariableRow = {
  name: string;
  class: VariableClass;
  type: string;
  init: string;
  address: string;
  inverted: boolean;
  retain: boolean;
  safe: string;
  comment: string;
  chart?: string;
  from: number;
  to: number;
  uses: number;
};

/** The present knowledge of a claim. */
export type Verdict = 'proved' | 'refuted' | 'open';

export type View = { file: string; bindings: Array<Binding> };

/** A sentence of an answer. */
export type WhyLine = {
  /** How many effects stand above it, one above the other. */
  depth: number;
  said: string;
  /** A word for the kind of the sentence: `input`, `step`, `transition`, `time` and so on. */
  fact: string;
  at_ms: number;
  /** It holds as well, but did not begin the change. */
  aside: boolean;
  /** The symbols of which it speaks. */
  items: Array<string>;
};

/** The contents of each message, beside its name in `do`. */
export interface Requests {
  /** Opens a text under a name; a file that is imported gets another name. `uses` are texts of files that it uses, by
   * their paths from its folder; those that are missing are wanted. */
  open: { file: string; text: string; uses?: Array<Shelved> | null };
  /** The texts of the files that a file uses, by their paths from its folder. */
  used: { file: string };
  /** Forgets a file. */
  close: { file: string };
  /** Gives the texts of files that open files use; without a text, it is not there. */
  lend: { files: Array<Shelved> };
  /** Chooses the language of the answers: `en`, `fr`, `pt`. A program without the texts in it is given them. */
  speak: { language: string; words?: string | null };
  look: { file: string };
  text: { file: string };
  /** Changes the text as it is typed. A unit is undone alone; a change of others is not undone here. */
  splice: { file: string; splices: Array<Splice>; unit?: boolean; others?: boolean };
  /** Executes a gesture. */
  edit: { file: string; gesture: Gesture };
  /** The effect that a gesture would have. */
  foresee: { file: string; gesture: Gesture };
  /** Executes a fix, by the number of its problem in the overview of this version and its own number there. */
  mend: { file: string; version: number; problem: number; fix: number };
  /** The parts of an action as typed, with another qualifier or time where one is given; an empty qualifier takes it
   * away. */
  action_form: { text: string; qualifier?: string | null; time?: string | null };
  undo: { file: string };
  redo: { file: string };
  /** The steps that would be joined if these parts were deleted and the chart healed. */
  joins: { file: string; ids: Array<ItemId> };
  /** Copies symbols as text, to be pasted elsewhere. */
  copy: { file: string; ids: Array<ItemId> };
  /** Merges two changes of one text. */
  merge: { base: string; mine: string; theirs: string };
  format: { file: string };
  /** The places that name the same part as the word at a place. */
  references: { file: string; at: number };
  drawing: {
    file: string;
    chart: string;
    look?: Standard | null;
    pages?: Pages | null;
    actions?: boolean | null;
    /** The steps whose expansions and enclosed charts are drawn beside the chart, by their ids. */
    open?: Array<string>;
    /** The number of the drawing that the page has, 0 if none; absent if this one is not to be kept. */
    since?: number | null;
  };
  /** Lists the forms in which a chart can be exported. */
  forms: object;
  /** Exports a file in one of them. */
  export: { file: string; to: string };
  /** Sheets of paper: of the named charts or, with `dossier`, all that is known of the file. */
  sheets: {
    file: string;
    /** `a4`, `a4-landscape`, `a3` or `a3-landscape`. */
    paper: string;
    /** The names of the charts. */
    charts: Array<string>;
    /** All that is known of the file, whatever `charts` names. */
    dossier: boolean;
    head: SheetsHead;
    /** The answers to the questions that the page has asked; none if it has asked nothing. */
    answers?: Array<SheetsAnswer> | null;
    /** The pictures of the plants. */
    pictures: Array<Shelved>;
  };
  /** The picture of a plant, and what can be bound in it. */
  plant_picture: { file: string; plant: string };
  /** The logic of a symbol in one of the languages of controllers. */
  logic: { file: string; id: string; tongue: Tongue };
  /** Converts logic in one of these languages to an expression of the text. */
  logic_read: { tongue: Tongue; text: string };
  /** The style sheet of the drawings. */
  style: { dark?: boolean };
  /** Runs the tests whose titles contain `name`, or all. */
  test: { file: string; name?: string | null };
  /** Why a test of this title failed. */
  test_why: { file: string; name: string };
  /** Answers all questions about the file, as far as the limits go. */
  prove: {
    file: string;
    /** Most states kept. */
    states: number;
    /** Most memory for them, in MiB. */
    mib: number;
  };
  /** The ways on from a refuted claim. */
  prove_ways: {
    file: string;
    /** The fingerprint of the text that was asked. */
    hash: string;
    /** The number of the question. */
    question: number;
    run: Array<ProofScan>;
    /** The ways in which the plant ticked. */
    chance?: Array<number>;
  };
  /** Compares two files for every sequence of inputs, as far as the limits go. */
  compare: {
    /** The names of the two files, which may be one. */
    files: [string, string];
    /** For each of them the profile, if it is not its own. */
    profiles?: [string | null, string | null];
    /** Situations are compared too. */
    situations?: boolean;
    /** Most states kept. */
    states: number;
    /** Most memory for them, in MiB. */
    mib: number;
  };
  /** Makes of the files of an exercise what students get. The names of the files are their paths in its folder. */
  exercise_pack: { folder: string; files: Array<Shelved> };
  /** Checks the work of a student by the tests and questions of an exercise. */
  exercise_check: {
    /** The name of the student's file. */
    name: string;
    text: string;
    /** The files that it uses. */
    uses?: Array<Shelved> | null;
    exercise: ExerciseGiven;
    /** Most states of the search for the answers to questions. */
    states: number;
  };
  /** The text before the last change. */
  before: { file: string };
  /** The classes of the tokens in a part of the text. */
  tokens: { file: string; from?: number; to?: number };
  complete: { file: string; at: number };
  hover: { file: string; at: number };
  /** The tables of variables and steps. */
  symbols: { file: string };
  search: { file: string; text: string };
  run_start: {
    file: string;
    run: string;
    profile?: string | null;
    scan_ms?: number | null;
    plant?: string | null;
    seed?: number;
    /** A run to be repeated from the start, without the user. */
    moves?: Array<ProofScan> | null;
  };
  run_advance: { run: string; ms: number; most_scans?: number | null; times?: boolean };
  run_scan: { run: string; times?: boolean };
  run_pass: { run: string; times?: boolean };
  run_set: { run: string; signal: number; value: string };
  run_toggle: { run: string; signal: number };
  run_force: { run: string; signal: number; value: string };
  /** Releases one signal, or all if none is named. */
  run_release: { run: string; signal?: number | null };
  run_restart: { run: string; warm?: boolean };
  /** Shows the run as it was at an instant. */
  run_seek: { run: string; ms: number };
  /** Shows the present again, or goes on from the shown instant. */
  run_live: { run: string; here?: boolean };
  run_breaks: { run: string; ids: Array<string> };
  /** Continues a run with a changed text; what would be lost is lost only by force. */
  run_swap: { run: string; file: string; force?: boolean };
  run_stop: { run: string };
  run_frame: { run: string; full?: boolean; times?: boolean };
  /** Asks again for the description of a run that its start returned. */
  run_signals: { run: string };
  run_lanes: { run: string; signals: Array<number>; from_ms: number; to_ms: number; most?: number };
  /** The record of a run from its start: all that entered the charts. The message `why` needs it. */
  run_tape: { run: string };
  /** Why something happened in a run, of which this is the record. */
  why: {
    /** The text that runs, and those that it uses. */
    text: string;
    uses?: Array<Shelved> | null;
    /** The answer of `run_tape`. */
    tape: string;
    /** The id of a symbol, or a name; without one it is asked what happened in the scan. */
    about?: string | null;
    /** The instance that is asked about, if the chart of the symbol has parameters. */
    instance?: string | null;
    /** The instant of the scan; without one, that of the last. */
    ms?: number | null;
    file: string;
    run: string;
    profile?: string | null;
    scan_ms?: number | null;
    plant?: string | null;
    seed?: number;
    /** A run to be repeated from the start, without the user. */
    moves?: Array<ProofScan> | null;
  };
  /** The signals as a file; all of them if none is named. */
  run_export: {
    run: string;
    signals?: Array<number>;
    as: SignalsForm;
    from_ms?: number | null;
    to_ms?: number | null;
  };
}

/** The answer to each message. */
export interface Answers {
  open: Look;
  used: Array<Shelved>;
  close: null;
  lend: null;
  speak: null;
  look: Look;
  text: Text;
  splice: Look;
  edit: Edited;
  foresee: Foreseen;
  mend: Edited;
  action_form: ActionForm;
  undo: Edited;
  redo: Edited;
  joins: Array<Joined>;
  copy: Text;
  merge: Merged;
  format: Edited;
  references: Array<[number, number]>;
  drawing: Redrawn;
  forms: Array<Form>;
  export: Out;
  sheets: Printed;
  plant_picture: PlantPicture;
  logic: Array<LogicPiece>;
  logic_read: Text;
  style: Style;
  test: TestAnswer;
  test_why: TestWhy;
  prove: ProofReport;
  prove_ways: ProofWays;
  compare: ComparedReport;
  exercise_pack: ExercisePacked;
  exercise_check: ExerciseChecked;
  before: Before;
  tokens: Array<[number, number, string]>;
  complete: Completions;
  hover: Hover | null;
  symbols: Symbols;
  search: Array<SearchHit>;
  run_start: Started;
  run_advance: Frame;
  run_scan: Frame;
  run_pass: Frame;
  run_set: Frame;
  run_toggle: Frame;
  run_force: Frame;
  run_release: Frame;
  run_restart: Frame;
  run_seek: Frame;
  run_live: Frame;
  run_breaks: Breaks;
  run_swap: Swapped;
  run_stop: null;
  run_frame: Frame;
  run_signals: Started;
  run_lanes: Lanes;
  run_tape: Text;
  why: Because;
  run_export: Text;
}
