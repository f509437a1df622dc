//! Charts of Control Expert become documents that run the same.
//!
//! The files stand in `tests/interchange/controlexpert`; what is expected of them
//! is written here from Control Expert's rules, not from a run.

mod charts;
mod corpus;
mod hostile;
mod refused;
mod written;
