//! The frame of a chart that is printed as equations: each section of the equations is
//! a function of the chart, and every step has its memory and its time.
//!
//! `evolution` says which forms of Rust may stand here.

#![allow(clippy::unnecessary_cast, reason = "a `Tick` of printed code may have 32 bits")]

#[path = "../cycle.rs"]
mod cycle;
mod frame;

pub use cycle::*;
pub use frame::*;

use super::chart::*;
use crate::faults::*;
use crate::numbers::since;
