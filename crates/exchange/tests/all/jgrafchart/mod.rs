//! Charts saved by JGrafchart become documents that mean the same, and documents
//! become such charts.
//!
//! The files stand in `tests/interchange/jgrafchart`; what is expected of them
//! is written here from JGrafchart's language reference, not from a run.

mod corpus;
mod hostile;
mod pages;
mod plants;
mod problems;
mod runs;
mod show;
mod typed;
mod written;
