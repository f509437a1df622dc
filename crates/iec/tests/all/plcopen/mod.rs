//! Projects in PLCopen XML become documents that mean the same, and documents
//! become such projects.
//!
//! The files stand in `tests/interchange/plcopen`; what is expected of them is
//! written here from TC6 XML 2.01 and IEC 61131-3, not from a run.

mod charts;
mod codesys;
mod corpus;
mod hostile;
mod problems;
mod show;
mod types;
mod write;
