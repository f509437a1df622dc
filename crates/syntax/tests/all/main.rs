//! The tests of the text, in one program: to link a program for each file takes longer than to compile them.

mod documents;
mod grammar;
mod hostile;
mod ladder_il;
mod lines;
mod problems;
mod roundtrip;
mod tree;
mod words;
