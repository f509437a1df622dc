//! The tests of the formats of other tools. They are one program, because linking one for each file would take longer than compiling them.

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
