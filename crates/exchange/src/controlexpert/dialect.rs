//! Rewrites words of Control Expert's Structured Text that the language spells differently.

use g7_model::{Arg, Expr, ExprKind, Stmt, StmtKind, UnaryOp};

use g7_iec::nodes;
use g7_model::visit_mut::Visitor;

/// `SET(x)`, `RESET(x)`, `RE(x)`, `FE(x)`.
pub(super) struct Words;

fn only(args: &[Arg]) -> Option<&Expr> {
    match args {
        [arg] if !arg.output => Some(&arg.value),
        _ => None,
    }
}

impl Visitor for Words {
    fn stmt(&mut self, stmt: &mut Stmt) {
        let at = stmt.at.0;
        let StmtKind::Call(path, args) = &stmt.kind else { return };
        let value = match path.text().to_ascii_uppercase().as_str() {
            "SET" => true,
            "RESET" => false,
            _ => return,
        };
        if let Some(target) = only(args).cloned() {
            *stmt = nodes::assign(target, nodes::boolean(value, at), at);
        }
    }

    fn expr(&mut self, e: &mut Expr) {
        let at = e.at.0;
        let ExprKind::Call(path, args) = &e.kind else { return };
        let op = match path.text().to_ascii_uppercase().as_str() {
            "RE" => UnaryOp::Rise,
            "FE" => UnaryOp::Fall,
            _ => return,
        };
        if let Some(value) = only(args).cloned() {
            *e = nodes::unary(op, value, at);
        }
    }
}
