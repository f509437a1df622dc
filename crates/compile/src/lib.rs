//! From a document to a program.
#![forbid(unsafe_code)]

pub mod ir;
