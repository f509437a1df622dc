//! The prover beside other programs that answer the same questions: model checkers by AIGER files, Spin by a
//! model of its own. Each is skipped where it is absent. (`oracles.rs`: the static analysis of one corpus.)
//!
//! Where two differ, a run that `engine::scan` repeats shows who is right.
#![allow(clippy::disallowed_methods, reason = "the examples are read")]

mod aiger;
mod spin;
