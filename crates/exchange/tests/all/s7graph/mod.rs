//! S7-GRAPH blocks become documents that run the same.
//!
//! The files stand in `tests/interchange/s7graph`; what is expected of them is
//! written here from the rules of S7-GRAPH, not from a run.

mod blocks;
mod corpus;
mod hostile;
