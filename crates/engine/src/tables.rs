//! The tables that a compiled chart consists of, as `compile::lower` fills them.
//!
//! Macro-steps, tasks, enable and mask orders are gone by now: they have become
//! arcs, receptivities and conditions. What is left is steps, transitions, stored
//! actions, control blocks, watches, forcing orders and enclosures. In here an
//! absent row is [`NONE`]: the tables are read in every scan, and an `Option`
//! would make their rows longer.

use alloc::vec::Vec;

use crate::ops::{Addr, Code, GroupId, Op, StepId, WatchId};
use crate::rules::Rules;

/// Stands for an absent row, step or word in a table.
pub const NONE: u32 = u32::MAX;

/// A run of rows in a side table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Rows {
    /// First row.
    pub start: u32,
    /// One past the last.
    pub end: u32,
}

impl Rows {
    /// True if there is no row.
    pub const fn is_empty(self) -> bool {
        self.start >= self.end
    }
}

/// The receptivity of a transition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Receptivity {
    /// Always true.
    True,
    /// A BOOL word.
    Word(Addr),
    /// The complement of a BOOL word.
    NotWord(Addr),
    /// Any other expression; pushes one BOOL.
    Code(Code),
}

/// A step, with the data that every pass needs. It has 24 bytes, so that two or
/// three lie in a cache line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Step {
    /// The transitions whose first preceding step it is, in order of rank: rows of
    /// [`Tables::outs`].
    pub out: Rows,
    /// An output that follows this step alone and that no receptivity reads: it is
    /// written as the step is activated and deactivated. `Addr(NONE)` without one.
    pub direct: Addr,
    /// Row of [`Tables::extras`], or `NONE`.
    pub extra: u32,
    /// Its chart: row of [`Tables::charts`]. The steps of an expansion belong to the
    /// chart of their macro-step.
    pub chart: u32,
}

/// The data of a step that few steps have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Extra {
    /// Stored actions run on activation: rows of [`Tables::action_lists`].
    pub on: Rows,
    /// Stored actions run on deactivation: rows of [`Tables::action_lists`].
    pub off: Rows,
    /// Stored actions on event: rows of [`Tables::events`], looked at while the step
    /// is active.
    pub events: Rows,
    /// Actions of each scan: rows of [`Tables::periodics`].
    pub periodics: Rows,
    /// Inputs of control blocks: rows of [`Tables::contributions`].
    pub contributions: Rows,
    /// Groups whose activity this step counts in: rows of [`Tables::group_lists`].
    pub groups: Rows,
    /// Rows of [`Tables::orders`] that stand in the set of active orders while the
    /// step is active. The set only tells whether some order acts at all, so one row
    /// is enough for all the orders of a step.
    pub orders: Rows,
    /// Groups whose steps are deactivated when it is deactivated: rows of [`Tables::group_lists`].
    pub encloses: Rows,
    /// Steps activated when it is activated: rows of [`Tables::arcs`].
    pub links: Rows,
    /// Watches that read its activity or time: rows of [`Tables::watch_lists`].
    pub watches: Rows,
    /// The step stands for a macro-step and is no step of the text: `%SW20` and the
    /// target's limit do not count it.
    pub uncounted: bool,
}

/// A transition. Its index is its rank: the order of priority, then of the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Transition {
    /// The receptivity.
    pub receptivity: Receptivity,
    /// First preceding step, `StepId(NONE)` for a source transition.
    pub from: StepId,
    /// First succeeding step, `StepId(NONE)` for a sink transition.
    pub to: StepId,
    /// Further preceding steps: rows of [`Tables::arcs`].
    pub more_from: Rows,
    /// Further succeeding steps: rows of [`Tables::arcs`].
    pub more_to: Rows,
    /// Its chart: row of [`Tables::charts`].
    pub chart: u32,
    /// Stored action on clearing, or `NONE`.
    pub on_clearing: u32,
    /// It shares a preceding step with another transition.
    pub shares: bool,
    /// The written priority, 1 first; `NONE` without one.
    pub priority: u32,
    /// It has rows in [`Tables::drops`].
    pub drops: bool,
    /// The transition does not stand in the text: `%SW21` and the target's limit do
    /// not count it.
    pub uncounted: bool,
    /// All transitions behind its first preceding step have only that one preceding
    /// step, so that under single-token the first clearable one decides.
    pub simple: bool,
}

/// A chart that no other one contains.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Chart {
    /// Its steps, expansions included.
    pub group: GroupId,
    /// Its period: row of [`Tables::periods`].
    pub period: u32,
}

/// Contiguous steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Group {
    /// The steps, `start..end`.
    pub steps: Rows,
    /// Its initial situation: rows of [`Tables::arcs`].
    pub initial: Rows,
    /// Watches that read its activity: rows of [`Tables::watch_lists`].
    pub watches: Rows,
}

/// An action's code. Its index is its rank: actions of one moment run in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Action {
    /// The condition `if …`, which pushes one BOOL; empty without one.
    pub condition: Code,
    /// The statements.
    pub body: Code,
    /// The action runs only in scans in which this row of [`Tables::periods`] is due.
    pub period: u32,
}

/// A stored action on event. It has the period of its action.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Event {
    /// The event; pushes one BOOL.
    pub event: Code,
    /// Row of [`Tables::actions`].
    pub action: u32,
}

/// The inputs of a control block, in the order of [`Contribution::input`].
pub const INPUTS: [&str; 11] = ["N", "S", "R", "L", "D", "P", "P1", "P0", "SD", "DS", "SL"];

/// One step's input to a control block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Contribution {
    /// Row of [`Tables::blocks`].
    pub block: u32,
    /// The input: place in [`INPUTS`].
    pub input: u8,
    /// The condition `if …`, which pushes one BOOL; empty without one.
    pub condition: Code,
    /// The TIME of a timed qualifier in ns, which pushes one I64 and is taken when
    /// the input comes true; empty without one.
    pub time: Code,
    /// The condition is evaluated only when this row of [`Tables::periods`] is due.
    pub period: u32,
}

/// A control block: the inputs that all actions on one variable or body give, and
/// the output Q (IEC 61131-3:2003, 2.6.4.5; SEMANTICS section 5).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ControlBlock {
    /// The variable that takes Q, or `Addr(NONE)`.
    pub output: Addr,
    /// The body that runs while Q is true: row of [`Tables::actions`], or `NONE`.
    pub action: u32,
    /// Only N inputs come in and there is no body, so Q is true while some N is true.
    pub plain: bool,
    /// Keeps Q false while it is false; pushes one BOOL; empty without one.
    pub gate: Code,
    /// The block is evaluated only when this row of [`Tables::periods`] is due; 0
    /// where its inputs come from charts of several periods.
    pub period: u32,
}

/// A watched expression: the memory behind `↑e`, `↓e` and `t1/e/t2`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Watch {
    /// The expression; pushes one BOOL.
    pub code: Code,
    /// For a timer: codes that push the two TIMEs (I64, ns).
    pub times: Option<(Code, Code)>,
    /// Evaluated in every scan, because it reads a time. Otherwise it is evaluated
    /// when something that it reads has changed.
    pub always: bool,
    /// Its period: row of [`Tables::periods`].
    pub period: u32,
    /// Watches of higher index that read this one: rows of [`Tables::watch_lists`].
    pub watches: Rows,
}

/// A forcing order. Rows follow the partial order of the charts: an order that a
/// step of a chart gives comes behind every order that acts on that chart. Of those
/// on one chart the ones that keep the present situation come first, so that the
/// others are compared with a situation that no order has touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Order {
    /// The step that gives the order.
    pub step: StepId,
    /// The chart forced.
    pub chart: u32,
    /// The situation that is imposed.
    pub situation: Situation,
}

/// The situation that a forcing order imposes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Situation {
    /// The present situation.
    Current,
    /// These steps and no others: rows of [`Tables::arcs`].
    Steps(Rows),
}

/// Limits of a PLC's tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Limits {
    /// Most steps active at once.
    pub active: u32,
    /// Most transitions enabled at once.
    pub enabled: u32,
}

/// All tables of a program, before they are checked.
#[derive(Clone, Debug, Default, Hash)]
pub struct Tables {
    /// The rules of evolution.
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
    /// area, up to its end. A write to them is no change of the state, and every scan
    /// leaves them zero, so that two states do not differ in them.
    pub locals: Rows,
    /// Steps.
    pub steps: Vec<Step>,
    /// The data that few steps have.
    pub extras: Vec<Extra>,
    /// Transitions, by rank.
    pub transitions: Vec<Transition>,
    /// Steps that are deactivated when a transition (rank) clears, but that need not
    /// be active for it, sorted by rank: they stand for a macro-step that is left.
    pub drops: Vec<(u32, StepId)>,
    /// Transitions (rank), by the first step that precedes them.
    pub outs: Vec<u32>,
    /// Source transitions (rank).
    pub sources: Vec<u32>,
    /// Steps active at the start.
    pub initial: Vec<StepId>,
    /// Lists of steps.
    pub arcs: Vec<StepId>,
    /// Charts that no other one contains.
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
    /// Periods in nanoseconds; 0 stands for each scan. Row 0 is always 0.
    pub periods: Vec<i64>,
    /// Code that runs before the evolution.
    pub pre: Code,
    /// Code for system bits that runs after PRE, before requests are carried out.
    pub services: Code,
    /// Code that runs after the evolution and the actions.
    pub post: Code,
    /// Code at the very end of a scan, which resets system bits.
    pub tail: Code,
    /// The words of `%SW20` and `%SW21`, where something reads them.
    pub counts: Option<(Addr, Addr)>,
    /// The word of `%S25` with the limits of the target, where there are any.
    pub limits: Option<(Addr, Limits)>,
    /// All code.
    pub code: Vec<Op>,
    /// Only the times of steps that some code reads are kept; the others are 0 for who asks.
    pub lean: bool,
}

impl Tables {
    /// The steps of a list; empty where there is no such list.
    pub(crate) fn arcs(&self, rows: Rows) -> &[StepId] {
        self.arcs.get(rows.start as usize..rows.end as usize).unwrap_or(&[])
    }

    /// Calls `f` with each preceding step of a transition.
    #[inline(always)]
    pub(crate) fn each_from(&self, t: &Transition, mut f: impl FnMut(u32)) {
        if t.from.0 != NONE {
            f(t.from.0);
        }
        if !t.more_from.is_empty() {
            self.arcs(t.more_from).iter().for_each(|s| f(s.0));
        }
    }

    /// Calls `f` with each succeeding step of a transition.
    #[inline(always)]
    pub(crate) fn each_to(&self, t: &Transition, mut f: impl FnMut(u32)) {
        if t.to.0 != NONE {
            f(t.to.0);
        }
        if !t.more_to.is_empty() {
            self.arcs(t.more_to).iter().for_each(|s| f(s.0));
        }
    }
}
