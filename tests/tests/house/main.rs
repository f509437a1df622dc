//! The tests of the repository. They are one program, because linking one for each file would take longer than compiling them.

mod book;
mod citations;
mod grammars;
mod linked;
mod tidy;
#[cfg(feature = "types")]
mod types;
mod warnings;
