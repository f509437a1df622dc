//! Questions about transition systems of bits, answered with a solver for clauses.
//!
//! # Where this sits
//!
//! ```text
//! Question -> layer -> crate::system -> graph -> decide -> bounded, pdr -> solver
//!                                                       -> check (proofs), simulate (runs)
//!                                   -> kept (what the chart suggests, as far as it holds) -> decide
//!                                   -> dead (constraints that cannot be kept)
//!                                   -> diagram (all states as sets, where the solver has found nothing)
//!                                   -> wide (all states one by one, where a set is too large)
//!                                   -> traps (what can follow no more), stays (a trap judged by a search)
//! Compare  -> crate::compare -> joined (two systems as one) -> relate (latches that belong together) -> decide
//! ```
//!
//! # Invariants
//!
//! - *Never* is said only after the checker agreed, which has a solver of its own, or after all states were
//!   visited and some of them tried again; *reached* only after the simulator showed it.
//! - What is found depends on the system and the ticks of the solvers, not on a clock. The
//!   caller's `stop` ends the work, inside a call of a solver too.

mod aiger;
mod bounded;
#[cfg(test)]
mod brute;
mod check;
mod cnf;
mod cone;
mod dead;
mod decide;
#[cfg(not(target_family = "wasm"))]
pub(crate) mod diagram;
mod frames;
pub mod graph;
mod joined;
mod kept;
mod layer;
mod needs;
mod pdr;
mod relate;
pub mod simulate;
mod solver;
mod stays;
mod traps;
mod unrolled;
pub(crate) mod wide;

pub use aiger::aiger;
pub(crate) use cone::Cube;
pub use dead::{Ends, ends};
pub(crate) use decide::decide_related;
#[cfg(test)]
pub(crate) use decide::decide_with;
pub use decide::{Effort, Found, Proof, decide};
pub use graph::{Graph, Init, Latch, Node, Signal, System};
pub(crate) use joined::{join, mapped};
#[cfg(test)]
pub(crate) use kept::kept;
pub use layer::Satisfiability;
#[cfg(test)]
pub(crate) use needs::Needs;
pub use simulate::{Trace, Values, evaluate, shows};
pub use wide::Tries;
pub(crate) use wide::{Wanted, wide};
