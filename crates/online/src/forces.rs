//! The values that a person forces, each until its end.
//!
//! The controller asks at each step whether one has ended. Their number is bounded, so nothing is
//! allocated on the scan thread.

use g7_host::{Force, Runner};
use g7_model::Nanos;

/// Greatest number of forced values.
pub const FORCES: usize = 64;
/// A force lasts at most so long.
pub const LONGEST: Nanos = Nanos::DAY;
/// A force lasts so long where nobody says it.
pub const USUAL: Nanos = Nanos::from_millis(600_000);

/// A forced value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Forced {
    /// The forced variable.
    pub what: Force,
    /// Its value.
    pub word: u64,
    /// The time of the controller at which it ends.
    pub until: Nanos,
}

/// The forces of a controller, in the order in which they were begun.
#[derive(Debug)]
pub(crate) struct Forces(Vec<Forced>);

impl Forces {
    /// None yet, with room for all, here and in the run.
    pub(crate) fn new(runner: &mut Runner) -> Forces {
        runner.reserve_forces(FORCES);
        Forces(Vec::with_capacity(FORCES))
    }

    /// Forces a value, or another value or end for one that is forced; false where there are too many.
    pub(crate) fn force(&mut self, runner: &mut Runner, force: Forced) -> bool {
        if let Some(known) = self.0.iter_mut().find(|known| known.what == force.what) {
            *known = force;
        } else if self.0.len() < FORCES {
            self.0.push(force);
        } else {
            return false;
        }
        runner.force(force.what, force.word);
        true
    }

    /// Takes a force back; false where there was none.
    pub(crate) fn release(&mut self, runner: &mut Runner, what: Force) -> bool {
        let Some(at) = self.0.iter().position(|known| known.what == what) else { return false };
        self.0.remove(at);
        runner.release(what)
    }

    /// Takes the first force back whose end has come.
    pub(crate) fn end_one(&mut self, runner: &mut Runner, now: Nanos) -> Option<Force> {
        let over = self.0.iter().find(|known| now >= known.until)?.what;
        self.release(runner, over);
        Some(over)
    }

    /// Takes the last force back.
    pub(crate) fn pop(&mut self, runner: &mut Runner) -> Option<Force> {
        let what = self.0.pop()?.what;
        runner.release(what);
        Some(what)
    }

    /// Exchanges the list; that of the run is exchanged with the run.
    pub(crate) fn swap(&mut self, others: &mut Vec<Forced>) {
        std::mem::swap(&mut self.0, others);
    }

    pub(crate) fn all(&self) -> &[Forced] {
        &self.0
    }
}
