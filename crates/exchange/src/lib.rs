//! Reads charts of other tools into a document, and writes a document for them.
//!
//! # Where this sits
//!
//! ```text
//! foreign bytes -> registry -> a reader -> model::Document -> print (.g7) or compile
//!                  registry <- a writer <- model::Document
//! ```
//!
//! Each format has a folder; `registry` is the table of all formats, including those of `iec`. The
//! readers share parts of `iec`: the check of XML files, the collection of problems, and the
//! readers of the languages in the files.
//!
//! # What must hold
//!
//! - Nothing here panics or fails: an element that cannot be carried over is a problem with its
//!   place in the file, never dropped in silence. With only warnings the rest runs as in the tool
//!   that wrote the file; with an error it does not.
//! - Every span of an imported document lies in the foreign file, so a message shows the author's
//!   own line.
//! - Time and memory are bounded by the size of the file, and that size is bounded.
//! - The meaning of a chart is not decided here: a reader chooses the profile, `compile` and
//!   `engine` do the rest.
#![forbid(unsafe_code)]

mod arrays;
mod classicladder;
mod controlexpert;
mod flow;
mod jgrafchart;
mod l5x;
mod mermaid;
mod registry;
mod s7graph;
mod undeclared;
mod xmi;

pub use g7_iec::Written;
pub use g7_iec::plcopen::Dialect;

pub use registry::{FORMATS, Format, is_foreign, named, recognise};
