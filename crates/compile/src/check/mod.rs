//! Applies the rules of GRAFCET and SFC to a chart whose names and types are right: structure,
//! evolution, actions, the limits of a target.
//!
//! # Where this sits
//!
//! ```text
//! resolve -> ir::Unit -> here -> Problems
//!                    \-> lower (when no problem is an error)
//! ```
//!
//! Each check reads the unit and reports facts; none changes it. Questions that only a run can
//! answer are left to the run or to the prover.

mod actions;
mod clauses;
mod ends;
mod exclusion;
mod facts;
mod forcing;
mod formula;
mod idle;
mod loops;
mod named;
mod pages;
mod reach;
mod remainder;
mod settle;
mod solve;
mod structure;
mod target;
mod tree;
mod unused;
mod writes;

use g7_model::{Document, Problem};

use crate::ir::Unit;
use facts::Facts;

/// Runs all checks of the chart, and those of its target if it names one. `written` is the document with the
/// structures and function blocks of its author, `doc` the one with plain variables in their place.
#[inline(never)]
pub fn check(written: &Document, doc: &Document, unit: &Unit) -> Vec<Problem> {
    let facts = Facts::of(unit);
    let mut problems = Vec::new();
    structure::check(unit, &mut problems);
    reach::check(&facts, &mut problems);
    exclusion::check(&facts, &mut problems);
    actions::check(&facts, &mut problems);
    writes::check(unit, &mut problems);
    forcing::check(&facts, &mut problems);
    if unit.rules.stable {
        loops::check(&facts, &mut problems);
    }
    if let Some(plc) = unit.target {
        target::check(doc, unit, plc, &mut problems);
    }
    ends::check(&facts, &mut problems);
    unused::check(written, &mut problems);
    idle::check(written, &mut problems);
    remainder::check(doc, &mut problems);
    problems
}
