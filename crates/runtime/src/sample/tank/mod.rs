//! Filling a tank: steps one after the other, stability, outputs that follow a step.

pub mod chart;
#[allow(dead_code, reason = "a chart without hierarchy, blocks and actions needs a part of it")]
#[allow(
    clippy::absurd_extreme_comparisons,
    clippy::reversed_empty_ranges,
    reason = "the sizes of what is not there are 0"
)]
#[path = "../../evolution/mod.rs"]
mod evolution;

pub use evolution::{State, is_active, scan, scan_in_place, step_time};
