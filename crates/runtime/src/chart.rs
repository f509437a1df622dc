//! The items that the runtime asks of a chart: facts, tables, functions, types. Here they are
//! those of a chart without anything in it.
//!
//! `codegen` reads this file while it is built. A `bool` or an integer is a fact: it
//! has to give each one a value, and prints only the branches that are left. A
//! `static` is a table and a function is a part of the chart: it prints its own. The
//! samples put their own items over these.

/// A number of a step, a transition, an action: the smallest integer that holds all.
pub(crate) type Row = u8;

/// A time as the clock gives it: nanoseconds in 64 bits; with [`NARROW`] ticks in 32 bits.
pub(crate) type Tick = i64;

// How the chart evolves.

/// Passes go on until one changes nothing.
pub const STABLE: bool = false;
/// A step may be left by several transitions in one pass.
pub const MULTI: bool = false;
/// Of transitions that share a step, those of the best written priority clear.
pub const EXCLUSIVE: bool = false;
/// Transitions clear one after the other, each with its actions at once.
pub const SEQUENTIAL: bool = false;
/// Stored actions run at the end of the scan.
pub const LATE: bool = false;
/// An inactive step keeps the time for which it was active.
pub const KEEP: bool = false;
/// Step times count scans.
pub const SCAN_CLOCK: bool = false;
/// Times are kept as ticks of 32 bits that begin again at 0.
pub const NARROW: bool = false;
/// Some step has a time.
pub const HAS_TIMES: bool = true;
/// Only some steps have a time.
pub const FEW_TIMES: bool = false;
/// Times of steps stand beside the memory, which a search for stability compares.
pub const TIMES_APART: bool = true;
/// A body runs once more in the scan after its last.
pub const FINAL_SCAN: bool = false;
/// Actions of each scan run before the control blocks, on the situation before the evolution.
pub const PERIODIC_FIRST: bool = false;

// The parts of the chart.

/// Forcing orders.
pub const HAS_ORDERS: bool = false;
/// Charts that evolve in a period of their own.
pub const HAS_PERIODS: bool = false;
/// Steps that enclose charts or bring other steps with them.
pub const HAS_HIERARCHY: bool = false;
/// A mark can be taken away again before the change is made.
pub const UNMARKS: bool = false;
/// Stored actions on activation or deactivation.
pub const HAS_LISTS: bool = false;
/// Stored actions that run within a pass.
pub const HAS_STORED: bool = false;
/// Stored actions all read the values from before the pass.
pub const DEFERS: bool = false;
/// Actions on clearing.
pub const HAS_CLEARING: bool = false;
/// Transitions that keep each other from clearing.
pub const HAS_CONTESTS: bool = false;
/// Transitions behind several steps.
pub const HAS_JOINS: bool = false;
/// Each transition has one step before it and one behind.
pub const ONE_TO_ONE: bool = false;
/// Steps change as their transitions clear: nothing asks which changes come together.
pub const BARE: bool = false;
/// One word holds the set of all steps.
pub const ONE_WORD: bool = false;
/// Behind a step, a transition that clears ends the search.
pub const HAS_SETTLED: bool = false;
/// Several transitions have the same receptivity.
pub const SAME_RECEPTIVITIES: bool = false;
/// Outputs that follow a step.
pub const HAS_FOLLOWERS: bool = false;
/// Groups of steps whose activity counts.
pub const HAS_GROUPS: bool = false;
/// Actions on event.
pub const HAS_EVENTS: bool = false;
/// Actions of each scan.
pub const HAS_PERIODICS: bool = false;
/// Control blocks.
pub const HAS_BLOCKS: bool = false;
/// Control blocks with memory.
pub const HAS_FULL: bool = false;
/// Inputs of control blocks with a condition or a time.
pub const HAS_CONDITIONS: bool = false;
/// Edges and timers.
pub const HAS_WATCHES: bool = false;
/// Services that set, reset, initialise or clear.
pub const HAS_REQUESTS: bool = false;
/// System words that count steps and transitions.
pub const HAS_COUNTS: bool = false;
/// Limits of active steps and enabled transitions.
pub const HAS_LIMITS: bool = false;
/// Transitions that deactivate more than the steps before them.
pub const HAS_DROPS: bool = false;
/// Transitions without a step before them.
pub const HAS_SOURCES: bool = false;
/// A section PRE.
pub const HAS_PRE: bool = false;
/// System bits and services.
pub const HAS_SERVICES: bool = false;
/// A section POST.
pub const HAS_POST: bool = false;
/// System bits that fall back.
pub const HAS_TAIL: bool = false;
/// Something runs at the end of the scan.
pub const HAS_LATE: bool = false;
/// Something comes and goes with steps.
pub const HAS_ON: bool = false;
/// The situation from before the pass is asked for.
pub const LOOKS_BACK: bool = false;
/// A change is found by comparison: an action may undo another.
pub const COMES_AND_GOES: bool = false;
/// A change of steps is noted.
pub const NOTES_STEPS: bool = false;
/// P1 and P0 see the situation from before the evolution.
pub const LOOKS_EARLY: bool = false;
/// A receptivity can end in a fault.
pub const GUARDS_FAIL: bool = false;
/// Transitions behind steps.
pub const HAS_OUTS: bool = false;

// How many there are of each.

/// Steps.
pub const STEPS: usize = 0;
/// Steps that have a time.
pub const TIMED: usize = 0;
/// Nanoseconds of a tick.
pub const TICK: u32 = 1;
/// Words of a set of steps.
pub const WORDS: usize = 1;
/// Words of a set of those words.
pub const TOP: usize = 1;
/// Transitions.
pub const TRANSITIONS: usize = 0;
/// Most transitions that can clear in one pass, before priority.
pub const FIRED: usize = 0;
/// Most steps that are marked to come on at once.
pub const MARKED_ON: usize = 0;
/// Most steps that are marked to go off at once.
pub const MARKED_OFF: usize = 0;
/// Transitions without a step before them.
pub const SOURCES: usize = 0;
/// Groups of steps.
pub const GROUPS: usize = 0;
/// Words of a set of groups.
pub const GROUP_WORDS: usize = 1;
/// Charts.
pub const CHARTS: usize = 0;
/// Edges and timers.
pub const WATCHES: usize = 0;
/// Actions on event.
pub const EVENTS: usize = 0;
/// Words of a set of them.
pub const EVENT_WORDS: usize = 1;
/// Actions of each scan.
pub const PERIODICS: usize = 0;
/// Words of a set of them.
pub const PERIODIC_WORDS: usize = 1;
/// Inputs of control blocks.
pub const CONDITIONS: usize = 0;
/// Words of a set of them.
pub const CONDITION_WORDS: usize = 1;
/// Control blocks.
pub const BLOCKS: usize = 0;
/// Words of a set of them.
pub const BLOCK_WORDS: usize = 1;
/// Counters of the inputs of all control blocks.
pub const COUNTS: usize = 0;
/// Control blocks with memory.
pub const FULL: usize = 0;
/// Their timers.
pub const FULL_TIMES: usize = 0;
/// Periods.
pub const PERIODS: usize = 0;
/// Actions.
pub const ACTIONS: usize = 0;
/// Words of a set of actions.
pub const ACTION_WORDS: usize = 1;
/// Most actions that wait in a pass.
pub const RUNS: usize = 1;
/// Forcing orders.
pub const ORDERS: usize = 0;
/// The number that stands for no order.
pub const NO_ORDER: usize = 0;
/// Most steps that follow one another through enclosures.
pub const CHAIN: usize = 1;
/// Most steps that are left, or entered, in one pass.
pub const ENTERED: usize = 1;
/// Most passes of a scan.
pub const BOUND: u32 = 1;
/// Most active steps.
pub const MOST_ACTIVE: u32 = 0;
/// Most enabled transitions.
pub const MOST_ENABLED: u32 = 0;

// Tables: rows one behind the other, and where each row begins (`_AT`).

pub static WHEN: [u8; 0] = [];
pub static FROM: [u8; 0] = [];
pub static FROM_AT: [u8; 1] = [0];
pub static TO: [u8; 0] = [];
pub static TO_AT: [u8; 1] = [0];
pub static OUT: [u8; 0] = [];
pub static OUT_AT: [u8; 1] = [0];
pub static TIME_OF: [u8; 0] = [];
pub static STEP_CHART: [u8; 0] = [];
pub static SOURCE: [u8; 0] = [];
pub static SOURCE_CHART: [u8; 0] = [];
pub static SETTLES: [bool; 0] = [];
pub static ON_CLEARING: [u8; 0] = [];
pub static DROPS: [u8; 0] = [];
pub static DROPS_AT: [u8; 1] = [0];
pub static ENCLOSES: [u8; 0] = [];
pub static ENCLOSES_AT: [u8; 1] = [0];
pub static LINKS: [u8; 0] = [];
pub static LINKS_AT: [u8; 1] = [0];
pub static INITIAL: [u8; 0] = [];
pub static INITIAL_AT: [u8; 1] = [0];
pub static GROUP_FIRST: [u8; 0] = [];
pub static GROUP_END: [u8; 0] = [];
pub static CHART_GROUP: [u8; 0] = [];
pub static CHART_PERIOD: [u8; 0] = [];
pub static PERIOD: [i64; 0] = [];
pub static SHARES: [bool; 0] = [];
pub static COUNTED: [bool; 0] = [];
pub static STEP_COUNTED: [bool; 0] = [];
pub static PRIORITY: [u32; 0] = [];
pub static PERIODIC_ACTION: [u8; 0] = [];
pub static FULL_BLOCK: [u8; 0] = [];
pub static FULL_AT: [u8; 0] = [];
pub static FULL_PERIOD: [u8; 0] = [];
pub static ORDER_SITUATION: [u8; 0] = [];
pub static ORDER_STEPS: [u8; 0] = [];
pub static ORDER_STEPS_AT: [u8; 1] = [0];
pub static ORDER_STEP: [u8; 0] = [];
pub static ORDER_CHART: [u8; 0] = [];

// Functions. They take any state: each chart has its own.

/// The initial situation.
pub fn start<S>(_: &mut S) {}
/// The receptivity of a transition.
pub fn receptivity<S>(_: &mut S, _transition: usize) -> bool {
    false
}
/// Outputs that follow a step, for all steps of a word.
pub fn follow<S>(_: &mut S, _word: usize) {}
/// The parts that come with a step.
pub fn step_on<S>(_: &mut S, _step: usize) {}
/// The parts that go with a step.
pub fn step_off<S>(_: &mut S, _step: usize) {}
/// Collects the actions of a step that comes on.
pub fn gather_on<S>(_: &mut S, _step: usize) {}
/// Collects the actions of a step that goes off.
pub fn gather_off<S>(_: &mut S, _step: usize) {}
/// Runs the actions of a step that comes on.
pub fn run_on<S>(_: &mut S, _step: usize) {}
/// Runs the actions of a step that goes off.
pub fn run_off<S>(_: &mut S, _step: usize) {}
/// Runs an action.
pub fn run_action<S>(_: &mut S, _action: usize) {}
/// Runs an action on the values from before the pass and keeps what it writes.
pub fn defer_action<S>(_: &mut S, _action: usize) {}
/// Makes what a deferred action wrote true.
pub fn write_action<S>(_: &mut S, _action: usize) {}
/// Looks at an action on event.
pub fn event<S>(_: &mut S, _row: usize) {}
/// Looks at an input of a control block that has a condition or a time.
pub fn condition<S>(_: &mut S, _row: usize, _pulses: bool) {}
/// Evaluates a control block.
pub fn evaluate_block<S>(_: &mut S, _block: usize) {}
/// Brings edges and timers up to date.
pub fn watch<S>(_: &mut S, _fresh: bool) {}
/// The section PRE.
pub fn pre<S>(_: &mut S) {}
/// System bits and services.
pub fn services<S>(_: &mut S) {}
/// The section POST.
pub fn post<S>(_: &mut S) {}
/// System bits that fall back.
pub fn tail<S>(_: &mut S) {}
/// Outputs to their safe values.
pub fn to_safety<S>(_: &mut S) {}
/// Writes the system words of [`HAS_COUNTS`].
pub fn write_counts<S>(_: &mut S, _steps: i64, _transitions: i64) {}
/// Sets the system bit of [`HAS_LIMITS`].
pub fn write_overflow<S>(_: &mut S) {}
/// The equations before the passes.
pub fn sections_before<S>(_: &mut S) {}
/// The equations of a pass.
pub fn sections_of_pass<S>(_: &mut S) {}
/// The equations behind the passes.
pub fn sections_behind<S>(_: &mut S) {}
/// True if two memories are the same.
pub fn same_memory<M: PartialEq>(a: &M, b: &M) -> bool {
    a == b
}
/// True if variables are the same; NaN is the same as NaN.
pub fn same_variables<V: PartialEq>(a: &V, b: &V) -> bool {
    a == b
}
/// True if outputs are the same; NaN is the same as NaN.
pub fn same_outputs<O: PartialEq>(a: &O, b: &O) -> bool {
    a == b
}
