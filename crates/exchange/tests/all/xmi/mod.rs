//! Instances of the AGRAFE meta-model become documents that mean the same, and
//! documents become instances.
//!
//! The files stand in `tests/interchange/xmi`; what is expected of them is written
//! here from the meta-model and IEC 60848, not from a run.

mod corpus;
mod hostile;
mod problems;
mod show;
mod sound;
mod write;
