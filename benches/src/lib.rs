//! Measurements against other programs: the same charts for both sides, in one run.
//!
//! Start `scan.sh`; `bin/scan.rs` measures G7, and matiec if it is installed.

pub mod matiec;
pub mod shape;
