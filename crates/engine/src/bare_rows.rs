//! The rows that the short way of bare programs (`bare.rs`) reads instead of the
//! tables.

use alloc::boxed::Box;

use crate::layout::{Layout, head};
use crate::tables::{NONE, Receptivity, Rows, Tables, Transition};

/// A step with one transition behind it that waits for one BOOL word, and where a
/// lone token goes from here. A row never straddles two cache lines.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(crate) struct Hot {
    /// The BOOL word, as a word of the image; `NONE` for a step of another kind.
    pub(crate) waits_for: u32,
    /// The transition.
    pub(crate) rank: u32,
    /// The one succeeding step; `NONE` where clearing does more than move the only
    /// token to another step.
    pub(crate) to: u32,
    /// Output that follows this step, or `NONE`.
    pub(crate) from_output: u32,
    /// Output that follows the succeeding step, or `NONE`.
    pub(crate) to_output: u32,
    /// The receptivity is the complement of the word.
    pub(crate) flip: bool,
}

/// A transition from one step to one step. Outputs are words of the image.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Move {
    /// The preceding step; `NONE` for a transition of another kind.
    pub(crate) from: u32,
    /// The succeeding step.
    pub(crate) to: u32,
    /// Output that follows the preceding step, or `NONE`.
    pub(crate) from_output: u32,
    /// Output that follows the succeeding step, or `NONE`.
    pub(crate) to_output: u32,
}

/// The output that follows a step, as a word of the image.
pub(crate) fn output(t: &Tables, l: &Layout, step: u32) -> u32 {
    match t.steps.get(step as usize) {
        Some(s) if s.direct.0 != NONE => l.vars + s.direct.0,
        _ => NONE,
    }
}

/// True if a transition leads from one step to one step.
fn one_to_one(t: &Transition) -> bool {
    t.more_from.is_empty() && t.more_to.is_empty() && t.from.0 != NONE && t.to.0 != NONE
}

pub(crate) fn hot(t: &Tables, l: &Layout) -> Box<[Hot]> {
    let none = Hot { waits_for: NONE, rank: NONE, to: NONE, from_output: NONE, to_output: NONE, flip: false };
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
            Receptivity::Code(_) => return None,
        };
        // With source transitions a lone token is not all that can move.
        let moves = one_to_one(tr) && tr.from.0 == step && tr.to.0 != step && t.sources.is_empty();
        let to = if moves { tr.to.0 } else { NONE };
        let (from_output, to_output) = (output(t, l, step), output(t, l, to));
        Some(Hot { waits_for, rank: *rank, to, from_output, to_output, flip })
    };
    (0..).zip(&t.steps).map(|(i, s)| row(i, s.out).unwrap_or(none)).collect()
}

pub(crate) fn moves(t: &Tables, l: &Layout) -> Box<[Move]> {
    t.transitions
        .iter()
        .map(|tr| {
            let (from, to) = (tr.from.0, tr.to.0);
            Move {
                from: if one_to_one(tr) { from } else { NONE },
                to,
                from_output: output(t, l, from),
                to_output: output(t, l, to),
            }
        })
        .collect()
}
