//! Structured Text and declarations, wherever they occur.
//!
//! # Where this sits
//!
//! ```text
//! text -> lex -> parse -> expr, stmt, decl -> model::{Expr, Stmt, VarDecl}
//!                parse -> il::read         -> model::{Expr, Stmt}
//! model::{Expr, Stmt} -> print -> text
//! ```
//!
//! The text may be a file or a part of one, such as an attribute of an XML element: [`Places`] maps
//! each byte of the text to its place in the file. Names are kept as written. The language ignores
//! case, so each reader ends with [`settle`], which gives every name the spelling of its
//! declaration.
//!
//! Reading is lenient where dialects differ and the meaning is clear. An element without a
//! counterpart is a problem with its place.

mod bits;
mod decl;
pub(crate) mod expr;
mod initial;
mod known;
pub(crate) mod lex;
mod literal;
pub(crate) mod parse;
mod print;
mod settle;
mod shape;
mod stmt;
mod types;

use g7_model::{Expr, Stmt};

use crate::report::Report;

/// Prints an expression as an operand of a list or a contact of a rung.
pub type Spelling<'a> = &'a dyn Fn(&Expr) -> String;

pub(crate) use decl::{Section, Variable, fit};
pub(crate) use initial::{Initial, declared};
pub use known::Types as Known;
pub(crate) use lex::Kind;
pub use parse::Places;
pub(crate) use parse::{Parser, foreign};
pub use print::Writer;
pub use settle::settle;
pub(crate) use shape::{Shape, Types, Values, no_array};
pub use types::elementary;
pub(crate) use types::{is_base, text};

/// Reads statements of Structured Text; the text must end behind them.
pub fn statements(text: &str, place: Places, report: &mut Report) -> Vec<Stmt> {
    Parser::new(text, place, report).body()
}

/// Reads one expression; `;` may follow.
pub fn expression(text: &str, place: Places, report: &mut Report) -> Expr {
    Parser::new(text, place, report).whole()
}

/// The same for formats whose elements of arrays become single variables with names such as `a[1]`.
pub mod single {
    use g7_model::{Expr, Stmt};

    use super::{Parser, Places};
    use crate::report::Report;

    /// See [`super::statements`].
    pub fn statements(text: &str, place: Places, report: &mut Report) -> Vec<Stmt> {
        Parser::single(text, place, report).body()
    }

    /// See [`super::expression`].
    pub fn expression(text: &str, place: Places, report: &mut Report) -> Expr {
        Parser::single(text, place, report).whole()
    }

    /// See [`crate::il::statements`].
    pub fn instructions(text: &str, place: Places, report: &mut Report) -> Vec<Stmt> {
        Parser::single(text, place, report).il_statements()
    }

    /// See [`crate::il::expression`].
    pub fn result(text: &str, place: Places, report: &mut Report) -> Expr {
        Parser::single(text, place, report).il_expression()
    }
}
