//! All questions about a file, answered for the panel *Prove*.
//!
//! ```text
//! file -> verify: ask, answer -> Proof -> rows: claims, verdicts and runs as data
//! file, question, run         -> ways: the edits that a refuted claim offers (cures, assume, saved)
//! two files                   -> compared: equal, or a run for each of them up to the first difference
//! ```
//!
//! A call searches as far as its budget goes; the next one, with a larger budget, goes on with what
//! is open. So the page can show how far the search is and stop it between two calls. There is no
//! clock here: the page counts the time.

mod asked;
mod assume;
mod compared;
mod cures;
mod place;
mod rows;
pub mod saved;
mod ways;

pub(crate) use asked::{Limits, Proof, prove};
pub(crate) use compared::{Both, Compared, compared};
pub(crate) use rows::{Found, Report};
pub(crate) use ways::{Ways, Wish, ways};
