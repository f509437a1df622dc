//! The tests of the engine, as one program: each program is linked for itself, which takes longer than to compile it.

#[path = "../common/mod.rs"]
mod common;
mod counters;
mod joined;
mod limits;
mod numbers;
mod ops;
mod report;
mod state;
mod tables;
mod ways;
