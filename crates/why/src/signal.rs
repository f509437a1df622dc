//! The values of a state that are followed through a run, and the moments of a run.

use g7_engine::{Addr, GroupId, Program, State, StepId, WatchId};

/// A value of a state that can be followed through a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Signal {
    Word(Addr),
    Step(StepId),
    Group(GroupId),
    Timer(WatchId),
}

impl Signal {
    pub(crate) fn of(self, p: &Program, s: &State) -> u64 {
        match self {
            Signal::Word(addr) => s.word(addr),
            Signal::Step(step) => u64::from(s.is_active(step)),
            Signal::Group(group) => u64::from(s.group_active(p, group)),
            Signal::Timer(watch) => u64::from(s.timer(p, watch)),
        }
    }
}

/// A moment of a run: a scan, and within it one of the parts of the scan in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Pos {
    pub(crate) scan: usize,
    pub(crate) stage: usize,
}
