//! Measurements against other programs: the same charts for both sides, in one run.
//!
//! Start `scan.sh`; `bin/scan.rs` measures G7, and matiec if it is installed. `rows.sh` measures the
//! rows of features beside a loop in C.

pub mod active_loop;
pub mod cells;
pub mod matiec;
pub mod mix;
pub mod rows;
pub mod shape;
pub mod tools;
