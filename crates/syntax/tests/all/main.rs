//! The tests of the text, as one program: each program is linked for itself, which takes longer than to compile it.

mod documents;
mod grammar;
mod hostile;
mod ladder_il;
mod lines;
mod problems;
mod roundtrip;
mod tree;
mod words;
