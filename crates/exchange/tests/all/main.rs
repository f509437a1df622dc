//! The tests of the formats of other tools, in one program: to link a program for each file takes longer than to compile them.

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
