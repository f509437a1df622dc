//! ClassicLadder's projects become documents that run the same.
//!
//! The files stand in `tests/interchange/classicladder`; what is expected of them
//! is written here from what ClassicLadder does, not from a run.

#[path = "../support/mod.rs"]
mod support;

mod corpus;
mod hostile;
mod ladder;
mod sequential;
