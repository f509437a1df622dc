//! Answers: proved, refuted, or not decided, each with what shows it.

use g7_engine::Fault;

use crate::explore::Move;
use crate::reason::Reason;

/// The answer to a question.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The claim holds.
    Proved(Evidence),
    /// The claim fails.
    Refuted(Evidence),
    /// Neither was found.
    Open(Open),
}

/// True where nothing is decided yet, and more work may decide it.
pub fn is_open(answer: &Option<Verdict>) -> bool {
    match answer {
        None => true,
        Some(Verdict::Open(open)) => !open.reason.is_last_word(),
        Some(Verdict::Proved(_) | Verdict::Refuted(_)) => false,
    }
}

/// The evidence of an answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Evidence {
    /// A run that does it (a proof that something can be), or that breaks the claim.
    Run(Run),
    /// A proof that holds for all runs.
    Certificate(Certificate),
}

/// A run from the state before the first scan.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Run {
    /// Its scans. Its last scan shows what was asked for.
    pub moves: Vec<Move>,
    /// For each of them the way in which the plant ticked, by number; empty unless it draws random
    /// numbers.
    pub ways: Vec<u8>,
    /// The fault that stops the last scan.
    pub fault: Option<Fault>,
}

/// A proof that holds for all runs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Certificate {
    /// All states were visited by all moves that matter.
    Search {
        /// Number of states.
        states: usize,
        /// Number of scans made.
        scans: usize,
    },
    /// All sets of states were visited, each with any number of times that its clocks may have, by all
    /// moves that matter.
    Zones {
        /// Number of sets.
        zones: usize,
        /// Number of scans made.
        scans: usize,
    },
    /// The set of all states, made as a decision diagram.
    Diagram {
        /// Number of states; nothing where it has more than 128 bits.
        states: Option<u128>,
        /// Number of nodes of the diagram.
        nodes: usize,
        /// True if a checker with its own solver confirmed the set. If false, only random runs were tried; they stayed in it.
        checked: bool,
    },
    /// An inductive invariant, verified by a checker with a solver of its own.
    Invariant {
        /// Number of its clauses.
        clauses: usize,
    },
    /// Something that did not happen in so many scans does not happen in the next, and it does
    /// not happen in the first ones. Verified as an invariant is.
    Induction {
        /// Number of scans.
        depth: usize,
    },
}

/// How far a question is decided that is not decided.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Open {
    /// No run of so many scans decides it.
    pub scans: usize,
    /// Number of states that were visited.
    pub states: usize,
    /// The reason; `words` has its sentence and the way out.
    pub reason: Reason,
}
