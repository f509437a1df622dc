//! The tests of the repository, as one program: each program is linked for itself, which takes longer than to compile it.

mod book;
mod citations;
mod grammars;
mod linked;
mod tidy;
#[cfg(feature = "types")]
mod types;
mod warnings;
