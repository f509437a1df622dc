//! Why something happened in a run: what a scan did, why a step is active, why a transition does not clear, why a
//! variable changed; each answer goes back along causes to the input, the time or the start that began it.
//!
//! # Where this sits
//!
//! ```text
//! compile::Compiled, host::Tape -> Why -> Cause (sentences, facts, times, places) -> g7 | page | rig::testing
//! ```
//!
//! # Invariants
//!
//! - A run is made again by `engine` alone, from what entered it (`host::Tape`); every state is compared with the
//!   recorded one. Nothing here decides how a chart evolves.
//! - Parts of conditions are code of the same program, evaluated by the engine on states of the run (`parts.rs`).
//! - A cause is never later than its effect, and a chain ends: at an input, a time, the start, what came from outside,
//!   or a bound, which is told.
//! - An answer about a long run makes few of its scans again (`past.rs`).
//!
//! # Reading order
//!
//! `answer.rs` (an answer), `past.rs` (the run), `look.rs` (a scan pass by pass), `parts.rs` (conditions), `reason.rs`
//! (why and since when a condition has its value), `change.rs` (why a signal changed), `writers.rs` and `blocks.rs`
//! (who wrote a variable), `questions.rs` (the four questions).
#![forbid(unsafe_code)]

mod answer;
mod blocks;
mod change;
mod look;
mod owners;
mod parts;
mod past;
mod questions;
mod reason;
mod signal;
mod text;
mod trail;
mod writers;

use g7_compile::Compiled;
use g7_engine::{Addr, GroupId, StepId};
use g7_host::{Divergence, Tape};
use g7_model::{Nanos, Said, say};

pub use answer::{Cause, Fact};

use owners::Owners;
use parts::Parts;
use past::Past;
use text::Names;

/// A question about a run at an instant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Question {
    /// All that happened in the scan.
    Scan,
    /// Why a step is active, or is not.
    Step(StepId),
    /// Why a macro-step or chart has an active step, or has none.
    Group(GroupId),
    /// Why a transition (rank) does not clear, or why it cleared.
    Transition(u32),
    /// Why a variable has its value: it lies in so many words from the first.
    Variable(Addr, u32),
}

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NoAnswer {
    /// The run has no scan at or before the instant; its first one is at the other.
    Early(Nanos, Nanos),
    /// The run ends before the instant, at the other.
    Late(Nanos, Nanos),
    /// The run has no scan.
    Empty,
}

impl NoAnswer {
    /// The sentence.
    pub fn said(&self) -> Said {
        match self {
            NoAnswer::Early(asked, first) => {
                say!("the run has no scan at {}: its first one is at {}", text::at(*asked), text::at(*first))
            }
            NoAnswer::Late(asked, end) => {
                say!("the run ends at {}, before {}", text::at(*end), text::at(*asked))
            }
            NoAnswer::Empty => say!("the run has no scan"),
        }
    }
}

impl std::fmt::Display for NoAnswer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.said())
    }
}

impl std::error::Error for NoAnswer {}

/// A recorded run that can be asked.
pub struct Why<'a> {
    compiled: &'a Compiled,
    names: Names<'a>,
    past: Past<'a>,
    parts: Parts,
    owners: Owners,
}

impl<'a> Why<'a> {
    /// Makes the run of a tape again.
    ///
    /// # Errors
    ///
    /// The first scan whose state is another one than the recorded one: the tape is of another program.
    pub fn new(compiled: &'a Compiled, tape: &'a Tape) -> Result<Why<'a>, Divergence> {
        Ok(Why {
            compiled,
            names: Names { compiled },
            past: Past::new(&compiled.program, tape)?,
            parts: Parts::new(compiled),
            owners: Owners::new(compiled.program.tables()),
        })
    }

    /// The instants of the first and the last scan.
    pub fn span(&self) -> Option<(Nanos, Nanos)> {
        let last = self.past.scans().checked_sub(1)?;
        Some((self.past.time(0), self.past.time(last)))
    }

    /// The number of scans that the answers so far have made again: what they cost, on any machine.
    pub fn again(&self) -> u64 {
        self.past.again()
    }

    /// Answers a question about the last scan at or before an instant.
    ///
    /// # Errors
    ///
    /// The run has no such scan.
    pub fn ask(&self, question: Question, now: Nanos) -> Result<Cause, NoAnswer> {
        let (first, last) = self.span().ok_or(NoAnswer::Empty)?;
        if now > last {
            return Err(NoAnswer::Late(now, last));
        }
        let scan = self.past.scan_at(now).ok_or(NoAnswer::Early(now, first))?;
        Ok(self.answer(question, scan))
    }
}
