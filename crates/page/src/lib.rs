//! What the page asks, answered: one text in, one text out.
//!
//! # Where this sits
//!
//! ```text
//! page (TypeScript) -> JSON -> Page::call -> Files: syntax, edit, compile, draw
//!                                        \-> Runs:  rig, host, engine
//! ```
//!
//! The same [`Page`] answers in the browser (as wasm, `exports`) and in the
//! server (shared runs). The page draws what it is given and knows no rule of
//! GRAFCET.
//!
//! What must hold: no message makes it panic; what it cannot do is a sentence
//! for the user; time is an input; places in texts are UTF-16 code units outside
//! and bytes inside, and turn in `positions` only.
#![deny(unsafe_code)]

mod answer;
mod drawing;
mod edit;
mod explain;
pub mod exports;
mod file;
mod fixes;
mod ids;
mod language;
mod logic;
mod look;
mod merge;
mod out;
mod page;
mod positions;
mod problems;
mod request;
mod run;
mod tests;

pub use explain::explain;
pub use page::Page;
