//! The tests of the formats of other tools, as one program: each program is linked for itself, which takes longer than to compile it.

mod arrays;
mod classicladder;
mod controlexpert;
mod jgrafchart;
mod l5x;
mod mermaid;
mod s7graph;
#[path = "../support/mod.rs"]
mod support;
mod xmi;
