//! Charts written by hand, each with the runtime compiled over it.
//!
//! A sample is the chart in words, in the header of its `chart.rs`, and what `codegen`
//! would print of it. The tests run it.
#![allow(clippy::duplicate_mod, reason = "the runtime is compiled once for each sample")]

pub mod lamp;
pub mod press;
pub mod tank;
pub mod turns;
