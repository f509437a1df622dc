//! Ladder Diagram, written as text: a way to write Structured Text.
//!
//! # Where this sits
//!
//! ```text
//! text of an `ld { }` body -> parse::ladder -> Rung -> translate -> il::flow -> model::Stmt
//! model::Stmt, model::Expr -> show -> text
//! ```
//!
//! Power flows from left to right: a contact lets it through, a branch lets it
//! through on any of its ways, a coil takes it and lets it pass.

mod show;
mod translate;

pub use show::{show_as_ladder, show_expr_as_ladder};

use g7_model::{Arg, Expr, FileId, Name, Path, Problem, Span, Stmt, UnaryOp};

use crate::parse::ladder::rungs;

/// Reads the rungs of a Ladder Diagram as the statements they stand for.
pub fn statements(text: &str, file: FileId) -> (Vec<Stmt>, Vec<Problem>) {
    statements_from(text, file, 0)
}

/// The same for a part of a file: from a byte to the end of the text.
pub(crate) fn statements_from(text: &str, file: FileId, start: usize) -> (Vec<Stmt>, Vec<Problem>) {
    let (rungs, mut problems) = rungs(text, file, start);
    let statements = translate::translate(&rungs, &mut problems);
    (statements, problems)
}

/// Reads one rung of contacts as the expression that is the power behind it.
pub fn expression(text: &str, file: FileId) -> (Expr, Vec<Problem>) {
    let (rungs, mut problems) = rungs(text, file, 0);
    let end = u32::try_from(text.len()).unwrap_or(u32::MAX);
    let expr = translate::expression(&rungs, Span { file, start: 0, end }, &mut problems);
    (expr, problems)
}

/// Reads the rungs as they are drawn.
pub fn read(text: &str, file: FileId) -> (Vec<Rung>, Vec<Problem>) {
    rungs(text, file, 0)
}

/// A rung, read.
#[derive(Clone, Debug)]
pub struct Rung {
    /// Where jumps go to.
    pub label: Option<Name>,
    /// From left to right.
    pub elements: Vec<Element>,
    /// All of it.
    pub at: Span,
}

/// What stands on a wire.
#[derive(Clone, Debug)]
pub enum Element {
    /// `[a]`: power passes while this is true.
    Contact(Expr),
    /// A coil.
    Coil(Coil, Span),
    /// `<t1(IN, PT := 5s).Q>`: power goes to the input that has no value, and comes from the output.
    Block {
        /// The function or instance.
        path: Path,
        /// Its arguments.
        args: Vec<Arg>,
        /// Where power comes out.
        output: Option<Name>,
        /// Where it stands.
        at: Span,
    },
    /// `{ … | … }`.
    Branch(Vec<Vec<Element>>, Span),
}

/// What power does.
#[derive(Clone, Debug)]
pub enum Coil {
    /// `(q)`, and with a complement `(/q)`.
    Assign(Expr, bool),
    /// `(S q)`, `(R q)`.
    Latch(Expr, bool),
    /// `(P q)`, `(N q)`: true in the scan in which power comes or goes.
    Edge(Expr, UnaryOp),
    /// `(n := n + 1)`: while there is power.
    Statement(Box<Stmt>),
    /// `(JMP name)`.
    Jump(Name),
    /// `(RET)`.
    Return,
}
