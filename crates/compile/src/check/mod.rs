//! What the rules of GRAFCET and SFC say of a chart whose names and types are
//! right: structure, evolution, actions, the limits of a target.
//!
//! # Where this sits
//!
//! ```text
//! resolve -> ir::Unit -> here -> Problems
//!                    \-> lower (when no problem is an error)
//! ```
//!
//! Each check reads the unit and reports facts; none changes it. What cannot be
//! told without running the chart is left to the run or to the prover.

mod actions;
mod exclusion;
mod forcing;
mod structure;
mod target;
mod tree;

use g7_model::{Problem, TargetPlc};

use crate::ir::Unit;

/// All checks of the chart itself, and of its target if it names one.
pub fn check(unit: &Unit) -> Vec<Problem> {
    let mut problems = Vec::new();
    structure::check(unit, &mut problems);
    exclusion::check(unit, &mut problems);
    actions::check(unit, &mut problems);
    forcing::check(unit, &mut problems);
    if let Some(plc) = unit.target {
        target::check(unit, plc, &mut problems);
    }
    problems
}

/// The limits of a PLC that the document does not name (`g7 check --target`).
pub fn check_target(unit: &Unit, plc: TargetPlc) -> Vec<Problem> {
    let mut problems = Vec::new();
    target::check(unit, plc, &mut problems);
    problems
}
