//! Questions about all runs of a chart, as claims that hold or fail.
//!
//! A claim is worded so that it is good news when it holds: "step 5 can be active", "no
//! deadlock". Conditions of the author are numbers of rows in [`Compiled::queries`], which
//! have the same numbers in `equations::Equations::questions`.
//!
//! [`Compiled::queries`]: g7_compile::Compiled

use g7_engine::{Addr, StepId};
use g7_model::Span;

/// A claim with its place in the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Question {
    /// The claim.
    pub claim: Claim,
    /// The place in the text: the step, the transition, the property, or the chart.
    pub at: Span,
}

/// A condition: row of the queries with which the chart was compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Query(pub u32);

/// The claim of a question. "At a scan" means at the end of it; "some run" and "each run" are
/// those of the [`crate::Model`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Claim {
    /// The step is active in some run, if only in a transient situation.
    Active(StepId),
    /// The transition (rank) clears in some run.
    Clears(u32),
    /// The action (rank) runs in some run.
    Runs(u32),
    /// The output is not 0 at a scan of some run.
    On(Addr),
    /// The input can make a difference to a scan of some run.
    Asked(Addr),
    /// From each state some run changes the situation again, or all charts are at an end: no
    /// active step has a transition behind it.
    NoDeadlock,
    /// No two clearable transitions share a preceding step in a pass.
    NoConflict,
    /// No step is activated while it is active, unless it is deactivated in the same pass.
    NoUnsafe,
    /// Each search for stability ends.
    NoInstability,
    /// Stored actions of a pass give no variable two different values.
    NoOpposedWrites,
    /// Forcing orders agree.
    NoOpposedOrders,
    /// No other fault.
    NoFault,
    /// It holds at each scan.
    Always(Query),
    /// It holds at no scan.
    Never(Query),
    /// It holds at a scan of some run.
    Reachable(Query),
    /// At each scan at most so many of them hold.
    AtMost(u32, Vec<Query>),
    /// When `cause` holds at a scan, `effect` holds at that scan or one that is at most
    /// `within` ns later.
    Within {
        /// The cause.
        cause: Query,
        /// The time, ns.
        within: i64,
        /// The effect.
        effect: Query,
    },
    /// From a scan with `from` on, up to but without the first scan with `to`, `holds` is
    /// true at each scan. A scan with both ends it.
    Until {
        /// The condition that begins it.
        from: Query,
        /// The condition that ends it.
        to: Query,
        /// The condition that holds meanwhile.
        holds: Query,
    },
    /// From a scan with `from` on, up to but without the next scan with `to`, `never` is true
    /// at no scan. If `to` does not come, nothing is claimed.
    Between {
        /// The condition that begins it.
        from: Query,
        /// The condition that ends it.
        to: Query,
        /// The condition that does not hold meanwhile.
        never: Query,
    },
    /// When `cause` holds at a scan, `effect` holds at that scan or a later one, if every
    /// choice of inputs that a state meets again and again is made again and again.
    LeadsTo {
        /// The cause.
        cause: Query,
        /// The effect.
        effect: Query,
    },
}

impl Claim {
    /// True if the claim is that some run exists: then a run proves it.
    pub fn is_of_some_run(&self) -> bool {
        matches!(
            self,
            Claim::Active(_)
                | Claim::Clears(_)
                | Claim::Runs(_)
                | Claim::On(_)
                | Claim::Asked(_)
                | Claim::Reachable(_)
        )
    }

    /// True if the author asks it in the file.
    pub fn is_own(&self) -> bool {
        matches!(
            self,
            Claim::Always(_)
                | Claim::Never(_)
                | Claim::Reachable(_)
                | Claim::AtMost(..)
                | Claim::Within { .. }
                | Claim::Until { .. }
                | Claim::Between { .. }
                | Claim::LeadsTo { .. }
        )
    }
}
