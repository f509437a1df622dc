//! The choices of a search for all states: what it looks for, and by which inputs.

use crate::sat::graph::Signal;

/// Inputs of which all combinations are tried at once, at most.
const TOGETHER: usize = 6;

/// Which inputs are tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tries {
    /// All combinations that matter.
    All,
    /// At most one input is 1.
    One,
}

/// The search that is wanted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wanted<'s> {
    /// The signals that are looked for.
    pub(crate) signals: &'s [Signal],
    /// Signals of which one that is 0 leaves little to do: the scan has a second pass, a third, and so on.
    pub(crate) guards: &'s [Signal],
    /// States are told apart by all latches, not only by those on which the signals depend, and the search goes
    /// on when all signals are shown.
    pub(crate) all: bool,
    pub(crate) tries: Tries,
    pub(crate) threads: usize,
    /// Inputs of which all combinations are tried at once, at most.
    pub(crate) together: usize,
}

impl<'s> Wanted<'s> {
    /// All signals, by all inputs, with the latches that they depend on.
    pub(crate) fn of(signals: &'s [Signal], guards: &'s [Signal], threads: usize) -> Wanted<'s> {
        Wanted { signals, guards, all: false, tries: Tries::All, threads, together: TOGETHER }
    }
}
