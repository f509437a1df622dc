//! Every outside form of a chart, to and from [`g7_model::Document`].
//!
//! # Where this sits
//!
//! ```text
//! bytes -> decode -> lexer -> parse -> model::Document -> compile
//!                                        |
//!                     g7 fmt  <- print <-+
//! ```
//!
//! Reading never fails: it returns what it could make of the text *and* the
//! problems. A document read with problems may hold `Bad` expressions and empty
//! names; do not print it over its source.
//!
//! # Invariants
//!
//! - `parse(print(d)) == d` for every document without `Bad` expressions.
//! - No bytes make it panic or overflow the stack, and the time is linear in them.
//! - The height of expressions and the nesting of blocks are bounded, so later
//!   stages may recurse.
#![forbid(unsafe_code)]

mod decode;
mod foreign;
pub mod il;
pub mod ladder;
mod lexer;
mod lines;
mod parse;
mod print;
mod problems;
mod quote;
mod tokens;
mod tree;
mod words;

pub use decode::decode;
pub use lines::{LineColumn, LineIndex};
pub use parse::{SWITCHES, UNITS};
pub use print::part::{Part, chart_items_apart, items_apart, print_part};
pub use print::{Spelled, print, print_expr, print_statements};
pub use tokens::{
    Token, TokenKind, Tokens, is_reserved, show_comment, show_name, show_path_name, show_step_name, tokens,
};
pub use tree::{Marks, Tree};

use g7_model::{Document, Expr, ExprKind, FileId, Place, Problem, Span, Stmt};
use parse::Parser;

/// Reads the text of a file. The document contains the notes of the text.
pub fn parse(text: &str, file: FileId) -> (Document, Vec<Problem>) {
    if let Some(problem) = decode::too_large(text.len(), file) {
        return (Document::default(), vec![problem]);
    }
    let mut parser = Parser::new(text, file);
    let mut document = parser.document();
    let (problems, notes) = parser.finish();
    document.notes = notes;
    (document, problems)
}

/// Reads a file's bytes. Spans are places in these bytes, and in the text that [`decode`] makes of them.
pub fn parse_bytes(bytes: &[u8], file: FileId) -> (Document, Vec<Problem>) {
    let (text, mut problems) = decode(bytes, file);
    let (document, more) = parse(&text, file);
    problems.extend(more);
    problems.sort_by_key(|p| p.at.start);
    (document, problems)
}

/// Reads one expression; nothing may follow it.
pub fn parse_expr(text: &str, file: FileId) -> (Expr, Vec<Problem>) {
    if let Some(problem) = decode::too_large(text.len(), file) {
        let at = Place(Span { file, start: 0, end: 0 });
        return (Expr { kind: ExprKind::Bad, at }, vec![problem]);
    }
    let mut parser = Parser::new(text, file);
    let expr = parser.expr();
    parser.expect_end();
    (expr, parser.finish().0)
}

/// Reads statements of Structured Text; nothing may follow them.
pub fn parse_statements(text: &str, file: FileId) -> (Vec<Stmt>, Vec<Problem>) {
    if let Some(problem) = decode::too_large(text.len(), file) {
        return (Vec::new(), vec![problem]);
    }
    let mut parser = Parser::new(text, file);
    let statements = parser.statements(false);
    parser.expect_end();
    (statements, parser.finish().0)
}
