//! Ladder Diagram, written as text: a way to write Structured Text.
//!
//! # Where this sits
//!
//! ```text
//! text of an `ld { }` body -> syntax -> Rung -> translate -> il::jumps -> model::Stmt
//! model::Stmt, model::Expr -> show -> text
//! ```
//!
//! Power flows from left to right: a contact lets it through, a branch lets it
//! through on any of its ways, a coil takes it and lets it pass.

mod rung;
mod show;
mod translate;

pub use rung::{Coil, Element, Rung};
pub use show::{show, show_expr};
pub use translate::{translate, translate_expr};
