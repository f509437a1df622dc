//! The tests of the text. They are one program, because linking one for each file would take longer than compiling them.

mod documents;
mod grammar;
mod hostile;
mod ladder_il;
mod lines;
mod problems;
mod roundtrip;
mod tree;
mod words;
