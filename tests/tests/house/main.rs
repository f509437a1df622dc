//! The tests of the repository, in one program: to link a program for each file takes longer than to compile them.

mod book;
mod citations;
mod grammars;
mod linked;
mod tidy;
#[cfg(feature = "types")]
mod types;
mod warnings;
