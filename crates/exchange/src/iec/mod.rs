//! The text of IEC 61131-3, wherever it stands: Structured Text, Instruction List, declarations.
//!
//! # Where this sits
//!
//! ```text
//! text -> lex -> parse -> expr, stmt, decl -> model::{Expr, Stmt, VarDecl}
//!                      -> il -> syntax::il -> model::Stmt
//! model::Document -> standard -> print -> text
//! ```
//!
//! The text may be a file or a part of one, such as an attribute of an XML
//! element: [`Places`] tells where each byte of it stands in the file. Names are
//! kept as they stand; the language does not tell capitals from small letters, so
//! a reader ends with [`settle`], which gives every name the letters of its
//! declaration.
//!
//! Reading is lenient where dialects differ and the meaning is clear; what has
//! no counterpart is a problem with its place.

mod decl;
mod expr;
mod il;
mod lex;
mod literal;
mod parse;
mod print;
mod settle;
mod standard;
mod stmt;
mod types;

use g7_model::{Expr, Stmt};

use crate::report::Report;

pub(crate) use decl::{Section, Variable, zero};
pub(crate) use lex::Kind;
pub(crate) use parse::{Parser, Places};
pub(crate) use print::{Types as Known, Writer, time};
pub(crate) use settle::settle;
pub(crate) use standard::{Form, standard};
pub(crate) use types::{Types, bits, elementary};

/// Structured Text and nothing behind it.
pub(crate) fn statements(text: &str, place: Places, report: &mut Report) -> Vec<Stmt> {
    let mut parser = Parser::new(text, place, report);
    let statements = parser.statements();
    parser.expect_end();
    statements
}

/// One expression; `;` may stand behind it.
pub(crate) fn expression(text: &str, place: Places, report: &mut Report) -> Expr {
    let mut parser = Parser::new(text, place, report);
    let expr = parser.expr();
    while parser.eat(";") {}
    parser.expect_end();
    expr
}

/// An Instruction List as the statements that it stands for.
pub(crate) fn il_body(text: &str, place: Places, report: &mut Report) -> Vec<Stmt> {
    let mut parser = Parser::new(text, place, report);
    parser.il_statements()
}

/// An Instruction List as the expression that is its last result: a receptivity.
pub(crate) fn il_expression(text: &str, place: Places, report: &mut Report) -> Expr {
    let mut parser = Parser::new(text, place, report);
    parser.il_expression()
}
