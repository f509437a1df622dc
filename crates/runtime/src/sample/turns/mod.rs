//! A choice, a fork and a join, cleared in turn.

#[allow(
    clippy::single_match,
    clippy::collapsible_match,
    clippy::collapsible_if,
    reason = "as `codegen` prints it"
)]
pub mod chart;
#[allow(dead_code, reason = "a chart without hierarchy and blocks needs a part of it")]
#[allow(
    clippy::absurd_extreme_comparisons,
    clippy::reversed_empty_ranges,
    reason = "the sizes of what is not there are 0"
)]
#[path = "../../evolution/mod.rs"]
mod evolution;

pub use evolution::{State, is_active, scan, scan_in_place, step_time};
