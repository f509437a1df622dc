//! The tests of the prover, as one program: each program is linked for itself, which takes longer than to compile it.

mod closed;
mod compared;
mod large;
mod questions;
