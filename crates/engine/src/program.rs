//! The compiled chart: flat tables, checked once.
//!
//! `compile::lower` fills [`Tables`]; [`Program::new`] proves every index and
//! every stack, so that a scan has no bounds to handle. Macro-steps, tasks,
//! enable and mask orders are gone by now: they have become arcs, guards and
//! conditions. What is left is steps, transitions, stored actions, control
//! blocks, watches, forcing orders and enclosures.

use alloc::boxed::Box;
use alloc::vec::Vec;

use crate::{Addr, Code, GroupId, StepId, WatchId};

/// The switches of SEMANTICS section 4; a profile is a set of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Rules {
    /// Passes until nothing changes, else one pass a scan.
    pub stable: bool,
    /// Every clearable transition is cleared, else by priority.
    pub multi_token: bool,
    /// Under `multi_token`: a clearable transition with a written priority keeps
    /// those of a worse one, or of none, that share a step with it from clearing.
    pub numbered_exclusive: bool,
    /// Transitions clear one after the other, actions at once (JGrafchart).
    pub sequential: bool,
    /// Stored actions read the values from before the pass, else in order.
    pub parallel_actions: bool,
    /// Pulse actions of bodies run with the other bodies at the end of the scan
    /// (ACTION_CONTROL), else within the pass.
    pub late_actions: bool,
    /// A body runs once more after its Q has fallen.
    pub final_scan: bool,
    /// Step times keep their value after deactivation, else 0.
    pub keep_step_time: bool,
    /// Step times count scans.
    pub scan_clock: bool,
    /// P1 first and P0 last, else text order (used by `compile` alone).
    pub pulse_first: bool,
    /// Boolean S and R are stored actions, else inputs of control blocks
    /// (used by `compile` alone).
    pub stored_set_reset: bool,
    /// N, D and L on Boolean variables are continuous actions, else inputs of
    /// control blocks (used by `compile` alone).
    pub continuous: bool,
    /// `each scan` actions run before the control blocks, and not in the scan in
    /// which their step was activated.
    pub periodic_first: bool,
    /// Most passes in a scan.
    pub bound: u32,
}

impl Default for Rules {
    fn default() -> Rules {
        Rules::IEC60848
    }
}

impl Rules {
    /// IEC 60848.
    pub const IEC60848: Rules = Rules {
        stable: true,
        multi_token: true,
        numbered_exclusive: false,
        sequential: false,
        parallel_actions: true,
        late_actions: false,
        final_scan: false,
        keep_step_time: true,
        scan_clock: false,
        pulse_first: false,
        stored_set_reset: true,
        continuous: true,
        periodic_first: false,
        bound: 1_000_000,
    };
    /// IEC 61131-3.
    pub const IEC61131: Rules = Rules {
        stable: false,
        multi_token: false,
        parallel_actions: false,
        late_actions: true,
        final_scan: true,
        stored_set_reset: false,
        continuous: false,
        ..Rules::IEC60848
    };
    /// PL7.
    pub const PL7: Rules =
        Rules { stable: false, parallel_actions: false, continuous: false, ..Rules::IEC60848 };
    /// Unity Pro.
    pub const UNITY: Rules = Rules { final_scan: false, pulse_first: true, ..Rules::IEC61131 };
    /// JGrafchart.
    pub const JGRAFCHART: Rules = Rules {
        numbered_exclusive: true,
        sequential: true,
        keep_step_time: false,
        scan_clock: true,
        periodic_first: true,
        ..Rules::PL7
    };
}

/// A run of rows in a side table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Rows {
    /// First row.
    pub start: u32,
    /// One past the last.
    pub end: u32,
}

impl Rows {
    /// Whether there are none.
    pub const fn is_empty(self) -> bool {
        self.start >= self.end
    }
}

/// The receptivity of a transition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guard {
    /// Always true.
    True,
    /// A BOOL word.
    Word(Addr),
    /// The complement of a BOOL word.
    NotWord(Addr),
    /// Anything else; pushes one BOOL.
    Code(Code),
}

/// A step, what every pass needs of it. 24 bytes, two to three in a cache line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// Transitions watched by this step: rows of [`Tables::outs`]. Each
    /// transition is watched by its first preceding step, in order of rank.
    pub out: Rows,
    /// An output that follows this step alone and that no receptivity reads:
    /// written as it is activated and deactivated. `Addr(u32::MAX)` for none.
    pub direct: Addr,
    /// Row of [`Tables::extras`], or `u32::MAX`.
    pub extra: u32,
    /// Its chart (the outermost: an expansion counts to its macro-step's).
    pub chart: u32,
}

/// No output, no row.
pub const NONE: u32 = u32::MAX;

/// What few steps have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extra {
    /// Stored actions run on activation: rows of [`Tables::action_lists`].
    pub on: Rows,
    /// Stored actions run on deactivation: rows of [`Tables::action_lists`].
    pub off: Rows,
    /// Stored actions on event: rows of [`Tables::events`], watched while active.
    pub events: Rows,
    /// Actions of each scan: rows of [`Tables::periodics`].
    pub periodics: Rows,
    /// Inputs of control blocks: rows of [`Tables::contributions`].
    pub contributions: Rows,
    /// Groups whose activity this step counts in: rows of [`Tables::group_lists`].
    pub groups: Rows,
    /// Rows of [`Tables::orders`] that tell, while the step is active, that there
    /// are orders: one of its own is enough.
    pub orders: Rows,
    /// Groups emptied when it is deactivated: rows of [`Tables::group_lists`].
    pub encloses: Rows,
    /// Steps activated when it is activated: rows of [`Tables::arcs`].
    pub links: Rows,
    /// Watches that read its activity or time: rows of [`Tables::watch_lists`].
    pub watches: Rows,
    /// No step of the text but the stand-in of a macro-step: `%SW20` and the
    /// target's limit do not count it.
    pub uncounted: bool,
}

/// A transition. Index = rank: the order of priority, then of the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Transition {
    /// The receptivity.
    pub guard: Guard,
    /// First preceding step, `StepId(NONE)` for a source transition.
    pub from: StepId,
    /// First succeeding step, `StepId(NONE)` for a sink transition.
    pub to: StepId,
    /// Further preceding steps: rows of [`Tables::arcs`].
    pub more_from: Rows,
    /// Further succeeding steps: rows of [`Tables::arcs`].
    pub more_to: Rows,
    /// Its chart (the outermost).
    pub chart: u32,
    /// Stored action on clearing, or `NONE`.
    pub on_clearing: u32,
    /// Shares a preceding step with another transition.
    pub shares: bool,
    /// The written priority, 1 first; `NONE` without one.
    pub priority: u32,
    /// Has rows in [`Tables::drops`].
    pub drops: bool,
    /// No transition of the text: `%SW21` and the target's limit do not count it.
    pub uncounted: bool,
    /// The step watched has only transitions with that one preceding step, so
    /// that under single-token the first clearable one settles it.
    pub simple: bool,
}

/// A chart as far as the engine knows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chart {
    /// Its steps, expansions included.
    pub group: GroupId,
    /// Its period: row of [`Tables::periods`].
    pub period: u32,
}

/// Contiguous steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Group {
    /// `start..end` of the steps.
    pub steps: Rows,
    /// Its initial situation: rows of [`Tables::arcs`].
    pub initial: Rows,
    /// Watches that read its activity: rows of [`Tables::watch_lists`].
    pub watches: Rows,
}

/// An action's code. Index = rank: the order in which actions of one moment run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Action {
    /// `if …`; empty when there is none. Pushes one BOOL.
    pub condition: Code,
    /// What it does.
    pub body: Code,
    /// It runs only in scans in which this row of [`Tables::periods`] is due.
    pub period: u32,
}

/// A stored action on event; of its action's period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    /// Pushes one BOOL.
    pub event: Code,
    /// Row of [`Tables::actions`].
    pub action: u32,
}

/// The inputs of a control block, in the order of [`Contribution::input`].
pub const INPUTS: [&str; 11] = ["N", "S", "R", "L", "D", "P", "P1", "P0", "SD", "DS", "SL"];

/// One step's input to a control block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contribution {
    /// Row of [`Tables::blocks`].
    pub block: u32,
    /// Which input: place in [`INPUTS`].
    pub input: u8,
    /// `if …`; empty when there is none. Pushes one BOOL.
    pub condition: Code,
    /// TIME of a timed qualifier; empty when there is none. Pushes I64; taken
    /// when the input comes true.
    pub time: Code,
    /// The condition is looked at only when this row of [`Tables::periods`] is due.
    pub period: u32,
}

/// A control block (IEC 61131-3:2003, 2.6.4.5; SEMANTICS section 5).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ControlBlock {
    /// Takes Q, or `Addr(NONE)`.
    pub output: Addr,
    /// Runs while A holds: row of [`Tables::actions`], or `NONE`.
    pub action: u32,
    /// Only N comes in, and there is no body: Q is "some N is true".
    pub plain: bool,
    /// Holds Q back while false; empty when there is none. Pushes one BOOL.
    pub gate: Code,
    /// Evaluated only when this row of [`Tables::periods`] is due; 0 where its
    /// inputs come from charts of several periods.
    pub period: u32,
}

/// A watched expression.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Watch {
    /// Pushes one BOOL.
    pub code: Code,
    /// For a timer: codes that push the two TIMEs (I64).
    pub times: Option<(Code, Code)>,
    /// Looked at in every scan (reads a time), not just when something it reads changed.
    pub always: bool,
    /// Its period: row of [`Tables::periods`].
    pub period: u32,
    /// Watches (of higher index) that read this one: rows of [`Tables::watch_lists`].
    pub watches: Rows,
}

/// A forcing order. Index order is the partial order of the charts: an order
/// given by a step of a chart comes behind every order that acts on that chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Order {
    /// The step that gives it.
    pub step: StepId,
    /// The chart forced.
    pub chart: u32,
    /// What is imposed.
    pub situation: Situation,
}

/// What a forcing order imposes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Situation {
    /// The present situation.
    Current,
    /// Just these steps: rows of [`Tables::arcs`].
    Steps(Rows),
}

/// Limits of a PLC's tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Most steps active at once.
    pub active: u32,
    /// Most transitions enabled at once.
    pub enabled: u32,
}

/// Everything a program consists of, before it is checked.
#[derive(Clone, Debug, Default)]
pub struct Tables {
    /// The switches.
    pub rules: Rules,
    /// Initial value of each word of the variable area.
    pub init: Vec<u64>,
    /// Words copied in at the start of a scan: `start..end` of the variable area.
    pub inputs: Rows,
    /// Words of outputs: `start..end` of the variable area.
    pub outputs: Rows,
    /// Values of the outputs' words after a fault.
    pub safe: Vec<u64>,
    /// Words that code writes before it reads them: `start..end` of the variable
    /// area, up to its end. Writing them changes nothing, and every scan leaves
    /// them zero, so that states differ only where their futures can.
    pub locals: Rows,
    /// Steps.
    pub steps: Vec<Step>,
    /// What few steps have.
    pub extras: Vec<Extra>,
    /// Transitions, by rank.
    pub transitions: Vec<Transition>,
    /// Steps that go off with a transition (rank) without having to be active for
    /// it, sorted by rank: what stands for a macro-step that is left.
    pub drops: Vec<(u32, StepId)>,
    /// Transitions (rank) by the step that watches them.
    pub outs: Vec<u32>,
    /// Source transitions (rank).
    pub sources: Vec<u32>,
    /// Steps active at the start.
    pub initial: Vec<StepId>,
    /// Lists of steps.
    pub arcs: Vec<StepId>,
    /// Charts, outermost ones.
    pub charts: Vec<Chart>,
    /// Groups.
    pub groups: Vec<Group>,
    /// Lists of groups.
    pub group_lists: Vec<GroupId>,
    /// Actions, by rank.
    pub actions: Vec<Action>,
    /// Lists of actions.
    pub action_lists: Vec<u32>,
    /// Stored actions on event.
    pub events: Vec<Event>,
    /// Actions (rank) of each scan.
    pub periodics: Vec<u32>,
    /// Inputs of control blocks.
    pub contributions: Vec<Contribution>,
    /// Control blocks.
    pub blocks: Vec<ControlBlock>,
    /// Watches; each reads only watches of lower index.
    pub watches: Vec<Watch>,
    /// Lists of watches.
    pub watch_lists: Vec<WatchId>,
    /// For each word of the variable area that some watch reads, the watches:
    /// sorted by word.
    pub word_watches: Vec<(Addr, WatchId)>,
    /// Forcing orders.
    pub orders: Vec<Order>,
    /// Periods in nanoseconds; 0 is each scan. Row 0 is always 0.
    pub periods: Vec<i64>,
    /// Run before the evolution.
    pub pre: Code,
    /// Run after PRE, before requests are carried out (system bits).
    pub services: Code,
    /// Run after the evolution and the actions.
    pub post: Code,
    /// Run at the very end of a scan (system bits fall back).
    pub tail: Code,
    /// `%SW20` and `%SW21`, where something reads them.
    pub counts: Option<(Addr, Addr)>,
    /// `%S25` and the limits of the target.
    pub limits: Option<(Addr, Limits)>,
    /// All code.
    pub code: Vec<crate::Op>,
}

/// Why tables are not a program. The place says which row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LoadError {
    /// A row of the named table points to a row that is not there.
    Index {
        /// The table.
        table: &'static str,
        /// The row.
        row: u32,
    },
    /// Code at this instruction pops what is not there, or leaves something behind.
    Stack {
        /// The instruction.
        at: u32,
    },
    /// Code needs more than [`crate::STACK`] words of stack.
    Deep {
        /// The instruction.
        at: u32,
    },
    /// A table that must be sorted is not.
    Order {
        /// The table.
        table: &'static str,
        /// The row.
        row: u32,
    },
    /// A table is larger than `2^31` rows.
    Large {
        /// The table.
        table: &'static str,
    },
}

/// A checked, immutable compiled chart. Only [`Program::new`] makes one.
#[derive(Clone, Debug)]
pub struct Program {
    pub(crate) t: Tables,
    /// For each word, where its watches begin in `word_watches`; one more at the end.
    pub(crate) word_index: Box<[u32]>,
    pub(crate) layout: crate::state::Layout,
    pub(crate) has_orders: bool,
    /// Some code asks for the situation as the pass began.
    pub(crate) looks_back: bool,
    /// First word of the locals, or past all words.
    pub(crate) locals: u32,
    /// Within a pass of a search for stability a variable can change and change back.
    pub(crate) comes_and_goes: bool,
    pub(crate) has_hierarchy: bool,
    pub(crate) has_periods: bool,
    /// Some transitions share a preceding step and are not settled by their place.
    pub(crate) has_contests: bool,
    /// Nothing but steps, transitions and outputs that follow one step.
    pub(crate) bare: bool,
    /// No code reads a time, and nothing runs in every scan.
    pub(crate) timeless: bool,
    /// There is PRE, POST or code for system bits.
    pub(crate) frame: bool,
    /// Number of references to stored actions.
    pub(crate) stored: usize,
    /// Most words that the stored actions of one pass can write.
    pub(crate) commit_room: usize,
    /// Room for strings at work, in bytes.
    pub(crate) text_room: usize,
    /// For bare programs, what their passes need of steps.
    pub(crate) hot: Box<[crate::bare::Hot]>,
    /// For bare programs, what their passes need of transitions.
    pub(crate) moves: Box<[crate::bare::Move]>,
    /// Watches looked at in every scan.
    pub(crate) always: Box<[u32]>,
}
