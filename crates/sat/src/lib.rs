//! The one solver for clauses, for all who ask whether conditions can hold together.
//!
//! ```text
//! compile::check (receptivities) -> clauses -> Solver -> yes with a model | no | stopped
//! verify (systems of bits)       -> clauses ->
//! ```
//!
//! # Invariants
//!
//! - Behind the trait [`Solver`] stands a library; no other crate names it.
//! - The same clauses and questions give the same answers on every machine: work is limited by
//!   ticks, not by a clock.
#![forbid(unsafe_code)]

mod solver;

pub use solver::{Answer, Batsat, Literal, Solver};
