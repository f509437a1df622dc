//! Two charts, or one under two profiles, beside each other: equal for every sequence of
//! inputs, or a shortest sequence that tells them apart.
//!
//! # Where this sits
//!
//! ```text
//! Compare -> sides (what belongs together) -> search (pairs of states), miter -> sat -> Equality
//!                                          -> run (a difference, repeated by both engines)
//! ```
//!
//! Inputs and outputs belong together by name and type. Both charts are scanned at the same
//! instants with the same inputs; outputs (and situations, if wanted) are compared at the
//! end of each scan, and whether a fault stops it. The inputs keep the assumptions of both charts.
//! Search and solver work in turns, as in `answer.rs`.
//!
//! # Invariants
//!
//! - Equal is said only where all pairs of states were visited by all inputs that matter, or where the
//!   checker agreed with the solver's proof and inputs are never at an end.
//! - A difference is shown only after both engines have repeated it from the start.

mod equality;
mod miter;
mod run;
mod search;
mod sides;

use crate::layer::Budget;
use crate::verdict::Open;
pub use equality::{Compare, Difference, Equality, Unlike};
use miter::Miter;
use sides::Sides;

/// Scans of both charts in the first turn of the search.
const SCANS: usize = 20_000;
/// Turns of the solver in its first turn.
const SOLVER: u32 = 6;

/// Compares two charts.
pub fn compare(what: &Compare<'_>, budget: &Budget<'_>) -> Equality {
    let sides = match Sides::new(what) {
        Ok(sides) => sides,
        Err(why) => return Equality::Unlike(why),
    };
    let (mut scans, mut turns) = (SCANS, SOLVER);
    let (mut before, mut miter) = (None, None);
    loop {
        let small = Budget { scans: scans.min(budget.scans), ..*budget };
        let now = turn(&sides, &mut miter, turns, &small);
        // More work changes nothing where both have come to their end.
        if !matches!(now, Equality::Open(_)) || (budget.stop)() || before.as_ref() == Some(&now) {
            return now;
        }
        before = Some(now);
        scans = scans.saturating_mul(16);
        turns += 4;
    }
}

/// The same for a caller whose budget cannot stop a solver: a search within the budget, and then a short attempt
/// of the solver.
pub fn compare_once(what: &Compare<'_>, budget: &Budget<'_>) -> Equality {
    match Sides::new(what) {
        Ok(sides) => turn(&sides, &mut None, SOLVER, budget),
        Err(why) => Equality::Unlike(why),
    }
}

/// One turn of the search, and of the solver where the search has no answer, or may not have a shortest run.
fn turn(sides: &Sides<'_>, miter: &mut Option<Miter>, turns: u32, budget: &Budget<'_>) -> Equality {
    let found = sides.search(budget);
    let surely = !found.hole && !matches!(found.equality, Equality::Open(_));
    if surely || (budget.stop)() {
        return found.equality;
    }
    if miter.is_none() {
        *miter = Miter::until(sides, budget.stop);
    }
    let Some(miter) = miter else { return found.equality };
    let solved = miter.solve(sides, turns, budget);
    match (found.equality, solved) {
        (_, solved @ (Equality::Apart { .. } | Equality::Equal(_))) => solved,
        (found @ Equality::Apart { .. }, _) => found,
        (Equality::Open(a), Equality::Open(b)) => Equality::Open(joined(a, b)),
        (_, other) => other,
    }
}

/// The search alone, for tests and benchmarks.
pub fn compare_by_search(what: &Compare<'_>, budget: &Budget<'_>) -> Equality {
    match Sides::new(what) {
        Ok(sides) => sides.search(budget).equality,
        Err(why) => Equality::Unlike(why),
    }
}

/// The solver alone, for so many turns, each of which has twice the work of the one before.
pub fn compare_by_solver(what: &Compare<'_>, turns: u32, budget: &Budget<'_>) -> Equality {
    match Sides::new(what) {
        Ok(sides) => Miter::new(&sides).solve(&sides, turns, budget),
        Err(why) => Equality::Unlike(why),
    }
}

/// Writes both charts as one system, a binary AIGER file for other model checkers. Its first bad signal is 1 in a
/// scan in which the charts differ. A second bad signal, if there is one, is 1 in a scan that has more passes than
/// the system follows.
///
/// # Errors
///
/// They cannot be compared.
pub fn miter(what: &Compare<'_>) -> Result<Vec<u8>, Unlike> {
    let sides = Sides::new(what)?;
    Ok(Miter::new(&sides).aiger())
}

/// A question that is open in two ways is sure as far as one of them is.
fn joined(a: Open, b: Open) -> Open {
    let (scans, states) = (a.scans.max(b.scans), a.states.max(b.states));
    // If a larger search may decide it, the answer says so, though the solver cannot follow a part.
    let further = if a.reason.is_of_budget() || a.scans > b.scans { a } else { b };
    Open { scans, states, ..further }
}
