//! The tests of the prover, in one program: to link a program for each file takes longer than to compile them.

mod closed;
mod compared;
mod large;
mod questions;
