//! From a document to a program.
#![forbid(unsafe_code)]

pub mod ir;
pub mod lower;
pub mod resolve;
pub mod symbols;
