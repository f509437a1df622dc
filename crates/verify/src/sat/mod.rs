//! Questions about transition systems of bits.

pub mod graph;
pub mod simulate;
