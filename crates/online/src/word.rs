//! Words of a run that devices give and get.

use g7_engine::{Addr, GroupId, State, StepId};
use g7_host::Runner;

/// A word of the run that a device gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// An input word, counted from the first.
    Input(u32),
    /// A variable that nothing in the program writes.
    Word(Addr),
}

/// A word of the run that a device gets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// A variable.
    Word(Addr),
    /// The activity of a step.
    Step(StepId),
    /// The activity of a macro-step: that of its expansion.
    Macro(GroupId),
}

impl Source {
    pub(crate) fn word(self, runner: &Runner, state: &State) -> u64 {
        match self {
            Source::Word(addr) => state.word(addr),
            Source::Step(step) => u64::from(state.is_active(step)),
            Source::Macro(group) => u64::from(state.group_active(runner.program(), group)),
        }
    }
}
