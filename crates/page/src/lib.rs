//! Answers the questions of the page: one JSON text in, one JSON text out.
//!
//! # Where this sits
//!
//! ```text
//! page (TypeScript) -> JSON -> Page::call -> ide:   files, gestures, completion, problems …
//!                                        |-> draw
//!                                        |-> Runs:  rig, host, engine
//!                                        |-> prove: verify
//!                                        \-> exercise: grade
//! ```
//!
//! The same [`Page`] runs in the browser (as wasm, through `wasm`) and in the server (for shared
//! runs). The web page only draws the answers and contains no rule of GRAFCET.
//!
//! No message causes a panic; a request that cannot be fulfilled is answered by a sentence for the
//! user; time is an input; places in texts are UTF-16 code units outside this crate and bytes
//! inside, and are converted in `places` and `language` only.
#![deny(unsafe_code)]

mod answer;
mod between;
mod drawing;
mod edit;
mod exercise;
mod explain;
mod export;
mod language;
mod merge;
mod overview;
mod page;
mod picture;
mod places;
mod printed;
mod problems;
mod prove;
mod redrawn;
mod request;
mod run;
mod sheet;
mod testing;
#[cfg(feature = "types")]
pub mod types;
pub mod wasm;

pub use explain::explain;
pub use page::Page;
pub use prove::saved;
#[cfg(feature = "types")]
pub use request::types as protocol;
pub use run::{Places, Show, show};
