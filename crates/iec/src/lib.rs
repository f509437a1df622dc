//! The languages of IEC 61131-3: the one place where Structured Text (ST), Instruction List (IL)
//! and Ladder (LD) are read, translated and printed.
//!
//! # Where this sits
//!
//! ```text
//! text, XML -> sfc, plcopen -> st, il -> model::Document
//! .g7 text  -> syntax -> il, ld       -> model::Stmt
//! model::Document -> standard -> sfc, plcopen -> text, XML
//! model::Stmt, model::Expr -> st, il, ld      -> text
//! ```
//!
//! - `constant` reads and writes numbers, durations and strings.
//! - `st` reads and prints expressions, statements and declarations of Structured Text.
//! - `il` and `ld` translate instructions and rungs into statements, and print statements as these.
//! - `standard` rewrites a document in the forms that the standard has.
//! - `enumerations` makes types of the enumerations of a file that is read, with the help of `variables`, which knows the
//!   enumeration of each variable.
//! - `scopes` finds the meaning of names in a document.
//! - `signs` turns functions that do what an operator does into that operator.
//! - `sfc` reads and writes charts as text, `plcopen` as PLCopen TC6 or IEC 61131-10 XML.
//! - `xml`, `report` and `nodes` serve every reader of a foreign file, also those of
//!   `exchange`.
//!
//! # What must hold
//!
//! - Nothing here panics or fails: an element that cannot be carried over is a [`Problem`] with its
//!   place in the file, never dropped in silence.
//! - Every span of an imported document lies in its file.
//! - Time and memory are bounded by the size of the file, and that size is bounded.
#![forbid(unsafe_code)]

pub mod constant;
mod enumerations;
pub mod il;
pub mod ld;
pub mod nodes;
pub mod plcopen;
pub mod report;
pub mod scopes;
pub mod sfc;
pub mod signs;
pub mod st;
mod standard;
mod terms;
mod variables;
pub mod words;
pub mod xml;

use g7_model::Problem;

/// A document in a foreign form.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Written {
    /// The text of the file.
    pub text: String,
    /// Everything that the file does not carry, in the order of the document. If one of these is an
    /// error, the file does not mean the same as the document.
    pub problems: Vec<Problem>,
}
