//! The tests of the page. They are one program, because linking one for each file would take longer than compiling them.

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
mod sheet;
mod used;
