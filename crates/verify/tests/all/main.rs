//! The tests of the prover. They are one program, because linking one for each file would take longer than compiling them.

mod closed;
mod compared;
mod large;
mod questions;
