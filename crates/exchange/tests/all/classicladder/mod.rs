//! ClassicLadder's projects become documents that run the same.
//!
//! The files stand in `tests/interchange/classicladder`; what is expected of them
//! is written here from what ClassicLadder does, not from a run.

mod corpus;
mod hostile;
mod ladder;
mod sequential;
