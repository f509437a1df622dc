//! The scans of a search as it shows them, and the inputs that it tries.

use g7_engine::{Fault, State};

use crate::explore::Move;
use crate::verdict::Open;

/// Which inputs are tried in a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tried {
    /// One of each class: of all combinations that agree in what their scans read, the first one of
    /// [`Tried::Matter`]. They lead to the same states in the same order.
    Classes,
    /// All combinations of those that can matter there.
    Matter,
    /// At most one differs from its initial value: another model than that of the others, with fewer runs.
    One,
    /// All, which takes longer and finds no more.
    All,
}

/// A scan of the search.
pub(crate) struct Scene<'s> {
    /// The number of scans before it.
    pub(crate) depth: usize,
    /// The number of the state before it.
    pub(crate) from: usize,
    /// The number of the state behind it; none behind a fault, or where the search ends.
    pub(crate) to: Option<usize>,
    /// The inputs and the wait.
    pub(crate) m: &'s Move,
    /// The inputs that are tried in the state before it, by their places.
    pub(crate) tried: &'s [usize],
    /// The state behind it.
    pub(crate) state: &'s mut State,
    /// The fault that stopped it.
    pub(crate) fault: Option<Fault>,
}

/// How much a search has seen.
pub(crate) struct Extent {
    pub(crate) states: usize,
    /// Scans that were made.
    pub(crate) scans: usize,
    /// Why not all runs were seen.
    pub(crate) open: Option<Open>,
}

/// Is shown each scan.
pub(crate) type Look<'a> = &'a mut dyn FnMut(Scene<'_>);

/// When a search ends that has states left to visit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Until {
    /// When all questions are answered.
    Answered,
    /// When no input satisfies the assumptions in some state.
    Stuck,
    /// Only when all states are visited.
    Visited,
}
