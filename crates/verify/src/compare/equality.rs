//! The question of a comparison, and its answers.

use g7_compile::Compiled;

use crate::explore::Move;
use crate::question::Query;
use crate::verdict::{Certificate, Open};

/// The charts and signals that are compared.
pub struct Compare<'c> {
    /// The two charts.
    pub charts: [&'c Compiled; 2],
    /// The conditions of each chart that the environment keeps; all of them bind the inputs of both.
    pub assume: [Vec<Query>; 2],
    /// Situations are compared too, by the names of the steps.
    pub situations: bool,
}

/// The first thing in which the two charts differ at the end of the last scan of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Difference {
    /// An output has two values.
    Output(String),
    /// A step is active in one chart alone.
    Step(String),
    /// A fault stops one chart alone, or two faults differ. All searches for stability that do not end are
    /// one fault.
    Fault,
}

/// The answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Equality {
    /// Equal for every sequence of inputs; the states of the certificate are pairs of states.
    Equal(Certificate),
    /// A run that tells them apart: for each chart the moves with its own inputs. It is a shortest one, but
    /// where neither search nor solver can tell (inputs of more values than are tried).
    Apart {
        /// The moves of each chart.
        moves: [Vec<Move>; 2],
        /// The first difference in the last scan.
        what: Difference,
    },
    /// Not decided.
    Open(Open),
    /// They cannot be compared.
    Unlike(Unlike),
}

/// The reason why two charts cannot be compared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unlike {
    /// They are scanned at different periods.
    Periods,
    /// An output is in one chart only.
    Only {
        /// Its name.
        output: String,
        /// The chart: 0 is the first, 1 the second.
        side: usize,
    },
    /// The input or output with this name has two types.
    Types(String),
}
