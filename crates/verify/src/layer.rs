//! The common side of all layers: they answer what they can of one list of questions.

use crate::model::Model;
use crate::question::Question;
use crate::reason::Reason;
use crate::verdict::{Verdict, is_open};

/// How much a layer may do.
pub struct Budget<'b> {
    /// Most states kept.
    pub states: usize,
    /// Most scans made.
    pub scans: usize,
    /// Most bytes kept.
    pub bytes: usize,
    /// True as soon as the layer is to stop: the time is over, or the user asks for it. It is
    /// asked often, and must be quick.
    pub stop: &'b (dyn Fn() -> bool + Sync),
}

impl Budget<'_> {
    /// The reason to stop if there are more states, or more bytes of them, than are allowed.
    pub(crate) fn full(&self, states: usize, bytes: usize) -> Option<Reason> {
        if states > self.states {
            return Some(Reason::States(self.states));
        }
        (bytes > self.bytes).then_some(Reason::Memory(self.bytes >> 20))
    }

    /// The reason to stop if so many scans are enough, or if the caller wants it.
    pub(crate) fn over(&self, scans: usize) -> Option<Reason> {
        if scans >= self.scans {
            return Some(Reason::Scans(self.scans));
        }
        (self.stop)().then_some(Reason::Stopped)
    }
}

/// A way to answer questions.
pub trait Layer {
    /// Its name in reports.
    fn name(&self) -> &'static str;

    /// Answers questions. `answers` has an entry for each question; those that are `None` or
    /// [`Verdict::Open`] may be replaced, the others stay. Each run that it gives was
    /// replayed with `engine::scan`.
    fn answer(
        &self,
        model: &Model<'_>,
        questions: &[Question],
        answers: &mut [Option<Verdict>],
        budget: &Budget<'_>,
    );
}

/// The questions without an answer, with their numbers.
pub(crate) fn undecided<'q>(
    questions: &'q [Question],
    answers: &[Option<Verdict>],
) -> Vec<(usize, &'q Question)> {
    questions.iter().enumerate().zip(answers).filter(|(_, a)| is_open(a)).map(|(q, _)| q).collect()
}
