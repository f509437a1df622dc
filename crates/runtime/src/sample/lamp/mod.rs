//! A lamp that goes out by itself: equations instead of a walk over the active steps.

pub mod chart;
#[allow(dead_code, reason = "the chart has no services and no search for a picture that comes back")]
#[path = "../../flat/mod.rs"]
mod flat;

pub use flat::{State, is_active, scan, scan_in_place, step_time};
