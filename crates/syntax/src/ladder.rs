//! Ladder Diagram in the .g7 language: the rungs of `iec`, with contacts and coils in
//! the spelling of .g7.

use g7_iec::ld::{Rung, translate, translate_expr};
use g7_model::{Expr, FileId, Problem, Span, Stmt};

use crate::parse::ladder::rungs;
use crate::print::print_expr;

/// Reads the rungs of a Ladder Diagram as the statements they stand for.
pub fn statements(text: &str, file: FileId) -> (Vec<Stmt>, Vec<Problem>) {
    statements_from(text, file, 0)
}

/// The same for a part of a file: from a byte to the end of the text.
pub(crate) fn statements_from(text: &str, file: FileId, start: usize) -> (Vec<Stmt>, Vec<Problem>) {
    let (rungs, mut problems) = rungs(text, file, start);
    let statements = translate(&rungs, &mut problems);
    (statements, problems)
}

/// Reads one rung of contacts as the expression that is the power behind it.
pub fn expression(text: &str, file: FileId) -> (Expr, Vec<Problem>) {
    let (rungs, mut problems) = rungs(text, file, 0);
    let end = u32::try_from(text.len()).unwrap_or(u32::MAX);
    let expr = translate_expr(&rungs, Span { file, start: 0, end }, &mut problems);
    (expr, problems)
}

/// Reads the rungs as they are drawn.
pub fn read(text: &str, file: FileId) -> (Vec<Rung>, Vec<Problem>) {
    rungs(text, file, 0)
}

/// The wire through which power flows where the expression is true.
pub fn show_expr(e: &Expr) -> String {
    g7_iec::ld::show_expr(e, &print_expr)
}

/// The rungs that do what the statements do; none where a statement has no form in them (FOR, CASE).
///
/// `boolean`: whether a variable or call is a BOOL; an assignment of anything else is no coil.
pub fn show(statements: &[Stmt], boolean: &dyn Fn(&Expr) -> bool) -> Option<String> {
    g7_iec::ld::show(statements, &print_expr, boolean)
}
