//! The one solver for clauses, for all who ask whether conditions can hold together, and the one place for
//! decision diagrams, for those who need all values for which they do.
//!
//! ```text
//! compile::check (receptivities) -> clauses -> Solver -> yes with a model | no | stopped
//! verify (systems of bits)       -> clauses ->
//!                                -> functions -> diagram (not in the page: it needs a thread)
//! ```
//!
//! # Invariants
//!
//! - Behind the trait [`Solver`] stands a library, behind [`diagram`] another; no other crate names them.
//! - The same clauses and questions give the same answers on every machine: work is limited by
//!   ticks, not by a clock.
#![forbid(unsafe_code)]

#[cfg(not(target_family = "wasm"))]
pub mod diagram;
mod solver;

pub use solver::{Answer, Batsat, Literal, Solver};
