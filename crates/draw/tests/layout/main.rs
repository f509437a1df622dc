//! Checks the geometry of layouts: nothing overlaps, no link crosses a symbol.
#![allow(clippy::disallowed_methods, reason = "the tests read the examples")]

mod bends;
mod charts;
mod conventions;
mod forms;
mod geometry;
mod imported;
mod maker;
mod placed;
mod random;
