//! Instruction List in the .g7 language: the lists of `iec`, with operands in the
//! spelling of .g7.

use g7_iec::il::{translate, translate_expr};
use g7_model::{Expr, FileId, Problem, Span, Stmt};

use crate::parse::Parser;
use crate::print::print_expr;

/// Reads an Instruction List as the statements it stands for.
pub fn statements(text: &str, file: FileId) -> (Vec<Stmt>, Vec<Problem>) {
    statements_from(text, file, 0)
}

/// The same for a part of a file: from a byte to the end of the text.
pub(crate) fn statements_from(text: &str, file: FileId, start: usize) -> (Vec<Stmt>, Vec<Problem>) {
    let mut parser = Parser::portion(text, file, start);
    let list = parser.instructions();
    let mut problems = parser.finish().0;
    let (statements, more) = translate(&list);
    problems.extend(more);
    (statements, problems)
}

/// Reads an Instruction List as the expression that is its last result.
pub fn expression(text: &str, file: FileId) -> (Expr, Vec<Problem>) {
    let mut parser = Parser::portion(text, file, 0);
    let list = parser.instructions();
    let mut problems = parser.finish().0;
    let end = u32::try_from(text.len()).unwrap_or(u32::MAX);
    let (expr, more) = translate_expr(&list, Span { file, start: 0, end });
    problems.extend(more);
    (expr, problems)
}

/// The list whose last result is the expression.
pub fn show_expr(e: &Expr) -> String {
    g7_iec::il::show_expr(e, &print_expr)
}

/// The list that does what the statements do; none where a statement has no form in it (FOR, CASE).
pub fn show(statements: &[Stmt]) -> Option<String> {
    g7_iec::il::show(statements, &print_expr)
}
