//! The tests of the page, as one program: each program is linked for itself, which takes longer than to compile it.

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
