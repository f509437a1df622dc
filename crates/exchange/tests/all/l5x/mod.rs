//! Logix routines in SFC become documents that run the same.
//!
//! The files stand in `tests/interchange/l5x`; what is expected of them is written
//! here from the rules of Logix, not from a run.

mod corpus;
mod hostile;
mod routines;
