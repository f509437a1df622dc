//! Questions about all runs of a program.
//!
//! # Where this sits
//!
//! ```text
//! compile -> Program -> verify: engine::begin, pass, finish from each state that is reached
//! ```
//!
//! Its first feature is reachability: [`Explorer::search`] tries moves breadth first
//! from the state before the first scan, and answers with a shortest run, with "no
//! state has it", or with "not decided" and the bound that ended the search.
//!
//! # Invariants
//!
//! - A state is compared as a whole, by its canonical image. A hash only finds the
//!   place of an image, so two states are never taken for one.
//! - The order of a search depends on the program, the moves and the bounds alone.
//! - A verdict about all runs is given only where all states were visited and every
//!   move that matters was tried.
//!
//! Not here: names, messages (`compile`, `model`), the evolution itself (`engine`).
#![forbid(unsafe_code)]

mod explore;
mod inputs;
mod layer;
mod model;
mod question;
mod store;
mod values;
mod verdict;

pub use explore::{Answer, Bound, Explorer, Limits, Moment, Move, Moves, Next};
pub use inputs::{Inputs, Which};
pub use layer::{Budget, Layer};
pub use model::Model;
pub use question::{Claim, Query, Question};
pub use values::{Values, values};
pub use verdict::{Certificate, Evidence, Open, Run, Verdict};
