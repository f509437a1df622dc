//! The tests of the engine, in one program: to link a program for each file takes longer than to compile them.

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
