//! The tests of the page, in one program: to link a program for each file takes longer than to compile them.

#[path = "../common/mod.rs"]
mod common;
mod explained;
mod files;
mod hostile;
mod imported;
mod logic;
mod proofs;
mod properties;
mod redrawn;
mod runs;
mod used;
