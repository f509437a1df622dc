//! Words of a run that devices give and get.

use g7_engine::{Addr, GroupId, State, StepId};
use g7_host::Runner;

use crate::wire::Worth;

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
    /// The time since a step became active, in nanoseconds.
    Age(StepId),
    /// The same of a macro-step.
    MacroAge(GroupId),
    /// How good an input is, as a [`Worth`](crate::wire::Worth): the device and the input, by number.
    Worth(usize, usize),
}

impl Source {
    /// Its word. `worth` gives that of an input, by the numbers of its device and of itself.
    pub(crate) fn word(
        self,
        runner: &Runner,
        state: &State,
        worth: impl FnOnce(usize, usize) -> Worth,
    ) -> u64 {
        match self {
            Source::Age(step) => state.step_age(runner.program(), step) as u64,
            Source::MacroAge(group) => state.group_age(runner.program(), group) as u64,
            Source::Worth(device, input) => worth(device, input).word(),
            Source::Word(addr) => state.word(addr),
            Source::Step(step) => u64::from(state.is_active(step)),
            Source::Macro(group) => u64::from(state.group_active(runner.program(), group)),
        }
    }
}
