//! Instruction List: a way to write Structured Text.
//!
//! # Where this sits
//!
//! ```text
//! text of the standard -> read ---------+-> Instruction -> translate -> jumps -> model::Stmt
//! text of an `il { }` body -> syntax ---+
//! model::Stmt, model::Expr -> show -> text
//! ```
//!
//! All stages behind the readers see statements only. The statements do what the list does: the
//! current result is kept as the expression that computed it, and is written where it is used.

mod instruction;
pub(crate) mod jumps;
mod read;
mod show;
mod translate;

pub use instruction::{Instruction, InstructionKind, Mnemonic, Operand, When, is_input, mnemonic};
pub use read::{expression, statements};
pub use show::{show, show_expr};
pub use translate::{translate, translate_expr};
