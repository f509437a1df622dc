//! Measurements against peers: the same charts for both sides, in one run.
//!
//! `scan.sh` is the entry; `bin/scan.rs` runs G7, and matiec where it is found.

pub mod matiec;
pub mod shape;
