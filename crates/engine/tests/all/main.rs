//! The tests of the engine. They are one program, because linking one for each file would take longer than compiling them.

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
