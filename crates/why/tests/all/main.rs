//! Answers about runs: the cases of `tests/why`, and what holds for every answer about random charts.
#![allow(clippy::disallowed_methods, reason = "the runner reads the cases")]

mod cases;
mod hour;
mod law;
