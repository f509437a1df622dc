//! Layouts by geometry: nothing overlaps, no link runs through a symbol.
#![allow(clippy::disallowed_methods, reason = "the tests read the examples")]

mod charts;
mod conventions;
mod geometry;
mod maker;
mod placed;
mod random;
