//! A document as a project in PLCopen TC6 XML 2.01.
//!
//! Each chart becomes a program with an SFC body. The variables of the file are
//! those of the program where there is only one, else global ones. Bodies before
//! and behind the charts become programs in Structured Text, whose place in the
//! task says when they run.

mod clocks;
mod codesys;
mod control;
mod declare;
mod never;
mod place;
mod project;
mod sfc;

pub(super) use project::export;
