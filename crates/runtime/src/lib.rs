//! The runtime of printed charts: how a chart evolves, scan by scan, on a controller.
//!
//! ```text
//! this crate: compiled, linted, tested as Rust, with the samples
//!      \--> build of codegen (`syn`): data
//!                 \--> codegen::print: what a chart needs of it, as C99 or Rust
//! ```
//!
//! # Where this sits
//!
//! The engine interprets the tables of any chart; printed code is one chart. What all
//! charts have in common stands here (`evolution`), over the facts, tables and functions
//! that each chart brings (`chart.rs`). The samples are charts written by hand, so that
//! the runtime is a program before anything is printed from it.
//!
//! # Invariants
//!
//! - It does what the engine does; `tests/tests/compiled/main.rs` runs both beside each other.
//! - No heap, no library but `libm`, no recursion.
#![no_std]
#![forbid(unsafe_code)]
#![allow(missing_docs, reason = "a doc comment is printed into the code of every chart")]

pub mod arithmetic;
pub mod chart;
pub mod faults;
pub mod function_blocks;
pub mod numbers;
pub mod sample;
pub mod source;
pub mod text;
