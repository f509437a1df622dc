//! The rows that a pass reads instead of the tables where steps and transitions are plain
//! (`moves.rs`).
//!
//! A step is plain if nothing follows it but its `direct` output, its gate, or contributions to control
//! blocks without a condition. A transition is plain if clearing it does no more than change plain
//! steps. Whether a row is plain depends on that row alone: one
//! step with a stored action leaves all others as they are.

use alloc::boxed::Box;

use crate::decision::Decisions;
use crate::gates::{COUNTED, GATE, Gates};
use crate::given::Given;
use crate::layout::{Layout, head};
use crate::tables::{Extra, NONE, Receptivity, Rows, Tables, Transition};

/// A step with one transition behind it whose receptivity can be judged at once, and where a
/// lone token goes from here. A row never straddles two cache lines.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(crate) struct Hot {
    /// A word of the image or, where `decides` says so, the first test of a decision; `NONE` for a
    /// step of another kind.
    pub(crate) waits_for: u32,
    /// The transition.
    pub(crate) rank: u32,
    /// The one succeeding step; `NONE` where clearing does more than move a token from one
    /// plain step to another.
    pub(crate) to: u32,
    pub(crate) shift: Shift,
    /// The receptivity is the complement of the word.
    pub(crate) flip: bool,
    /// The receptivity is a decision.
    pub(crate) decides: bool,
}

/// A transition in a pass where all that clear are plain.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(crate) struct Move {
    /// The preceding step; `NONE` for a transition with several steps or none on a side, or one that
    /// may clear together with another one behind its step.
    pub(crate) from: u32,
    /// The succeeding step.
    pub(crate) to: u32,
    pub(crate) shift: Shift,
    /// The transition is plain.
    pub(crate) plain: bool,
}

/// The words of the image that change with a token; `NONE` where there is none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shift {
    /// Time of the step that is left.
    pub(crate) from_stamp: u32,
    /// Time of the step that is entered.
    pub(crate) to_stamp: u32,
    /// The step that is left acts on this: an output, or a gate if the tag is [`GATE`]. With the tag
    /// [`COUNTED`] it is the step itself, whose contributions are counted.
    pub(crate) from_output: u32,
    /// The same for the step that is entered, except that a gate has nothing to do when its step is
    /// entered.
    pub(crate) to_output: u32,
}

impl Shift {
    pub(crate) const NOTHING: Shift =
        Shift { from_stamp: NONE, to_stamp: NONE, from_output: NONE, to_output: NONE };
}

/// The parts of a program from which the rows are made.
#[derive(Clone, Copy)]
pub(crate) struct Parts<'a> {
    pub(crate) t: &'a Tables,
    pub(crate) l: &'a Layout,
    pub(crate) gates: &'a Gates,
    pub(crate) given: &'a Given,
    /// Steps can be plain that have more than an output.
    pub(crate) tags: bool,
}

impl<'a> Parts<'a> {
    /// The words that change with a token that goes from one step to another.
    fn shift(self, from: u32, to: u32) -> Shift {
        let (left, entered) = (self.leaving(from), self.entering(to));
        Shift { from_stamp: left.from_stamp, from_output: left.from_output, ..entered }
    }

    /// The words that change with a step that is activated.
    pub(crate) fn entering(self, step: u32) -> Shift {
        Shift { to_stamp: self.l.stamp(step), to_output: self.output(step), ..Shift::NOTHING }
    }

    /// The words that change with a step that is deactivated.
    pub(crate) fn leaving(self, step: u32) -> Shift {
        // A step that has a gate alone; else its output.
        let gate = self.extra(step).and_then(|e| self.gates.alone(e));
        let from_output = gate.map_or_else(|| self.output(step), |row| GATE | row);
        Shift { from_stamp: self.l.stamp(step), from_output, ..Shift::NOTHING }
    }

    /// The output that follows a step, as a word of the image, or the step where it is counted.
    fn output(self, step: u32) -> u32 {
        if self.extra(step).is_some_and(|e| self.given.alone(e)) {
            return COUNTED | step;
        }
        match self.t.steps.get(step as usize) {
            Some(s) if s.direct.0 != NONE => self.l.vars + s.direct.0,
            _ => NONE,
        }
    }

    fn extra(self, step: u32) -> Option<&'a Extra> {
        self.t.extras.get(self.t.steps.get(step as usize)?.extra as usize)
    }

    /// True if clearing a transition does no more than change plain steps.
    fn is_plain(self, tr: &Transition) -> bool {
        let direct = |step: u32| self.t.steps.get(step as usize).is_some_and(|s| s.direct.0 != NONE);
        let plain = |step: u32| match self.extra(step) {
            Some(e) => self.tags && !direct(step) && (self.gates.alone(e).is_some() || self.given.alone(e)),
            None => true,
        };
        let all_plain = |rows: Rows| {
            let steps = self.t.arcs.get(rows.start as usize..rows.end as usize).unwrap_or(&[]);
            steps.iter().all(|step| plain(step.0))
        };
        let alone = !tr.drops && tr.on_clearing == NONE;
        alone && plain(tr.from.0) && plain(tr.to.0) && all_plain(tr.more_from) && all_plain(tr.more_to)
    }

    /// A row for each step.
    #[inline(never)]
    pub(crate) fn hot(self, decisions: &Decisions, moves: &[Move]) -> Box<[Hot]> {
        let Parts { t, l, .. } = self;
        let none =
            Hot { waits_for: NONE, rank: NONE, to: NONE, shift: Shift::NOTHING, flip: false, decides: false };
        let row = |step: u32, out: Rows| {
            let [rank] = t.outs.get(out.start as usize..out.end as usize)? else { return None };
            let tr = t.transitions.get(*rank as usize)?;
            if !tr.more_from.is_empty() {
                return None;
            }
            let (waits_for, flip) = match tr.receptivity {
                // This word is not zero while the program runs.
                Receptivity::True => (head::FLAGS as u32, false),
                Receptivity::Word(a) => (l.vars + a.0, false),
                Receptivity::NotWord(a) => (l.vars + a.0, true),
                Receptivity::Code(code) => (decisions.of(code), false),
            };
            let decides = matches!(tr.receptivity, Receptivity::Code(_));
            let plain = moves.get(*rank as usize).filter(|m| m.plain && m.from == step && m.to != step);
            let plain = plain.filter(|_| waits_for != NONE);
            let to = plain.map_or(NONE, |m| m.to);
            Some(Hot { waits_for, rank: *rank, to, shift: self.shift(step, to), flip, decides })
        };
        (0..).zip(&t.steps).map(|(i, s)| row(i, s.out).unwrap_or(none)).collect()
    }

    /// A row for each transition. `any` says that transitions can be plain under the rules.
    #[inline(never)]
    pub(crate) fn moves(self, any: bool) -> Box<[Move]> {
        let row = |tr: &Transition| {
            let (from, to) = (tr.from.0, tr.to.0);
            let alone = one_to_one(tr) && !(tr.shares && self.t.rules.multi_token);
            Move {
                from: if alone { from } else { NONE },
                to,
                shift: self.shift(from, to),
                plain: any && self.is_plain(tr),
            }
        };
        self.t.transitions.iter().map(row).collect()
    }
}

/// True if a transition leads from one step to one step.
fn one_to_one(t: &Transition) -> bool {
    t.more_from.is_empty() && t.more_to.is_empty() && t.from.0 != NONE && t.to.0 != NONE
}
