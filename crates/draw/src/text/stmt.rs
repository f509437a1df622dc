//! Sets the statements of actions, written in Structured Text, as lines.

use g7_model::{Stmt, StmtKind};

use crate::text::expr::Setter;
use crate::text::{Line, clean};

/// The indent of a nested statement.
const INDENT: i32 = 140;

/// The body of an action, one line for each statement.
pub(crate) fn body(list: &[Stmt]) -> Vec<Line> {
    let mut lines = Vec::new();
    block(list, 0, &mut lines);
    if lines.is_empty() {
        lines.push(Line::plain("{ }"));
    }
    lines
}

fn block(list: &[Stmt], depth: i32, lines: &mut Vec<Line>) {
    for s in list {
        statement(s, depth, lines);
    }
}

fn push(lines: &mut Vec<Line>, depth: i32, build: impl FnOnce(&mut Setter)) {
    let mut setter = Setter::new();
    build(&mut setter);
    // The indent is limited, so that deep nesting does not push the text out of the box.
    setter.line.indent = depth.min(6) * INDENT;
    lines.push(setter.line);
}

fn words(lines: &mut Vec<Line>, depth: i32, text: &str) {
    push(lines, depth, |s| s.text(text));
}

fn statement(s: &Stmt, depth: i32, lines: &mut Vec<Line>) {
    match &s.kind {
        StmtKind::Assign { target, value } => push(lines, depth, |s| {
            s.expr(target, 1);
            s.text(" := ");
            s.expr(value, 0);
        }),
        StmtKind::Call(p, args) => push(lines, depth, |s| s.call(p, args, 0)),
        StmtKind::If(arms, otherwise) => {
            for (i, (condition, body)) in arms.iter().enumerate() {
                push(lines, depth, |s| {
                    s.text(if i == 0 { "IF " } else { "ELSIF " });
                    s.expr(condition, 0);
                    s.text(" THEN");
                });
                block(body, depth + 1, lines);
            }
            if !otherwise.is_empty() {
                words(lines, depth, "ELSE");
                block(otherwise, depth + 1, lines);
            }
            words(lines, depth, "END_IF");
        }
        StmtKind::Case(selector, arms, otherwise) => {
            push(lines, depth, |s| {
                s.text("CASE ");
                s.expr(selector, 0);
                s.text(" OF");
            });
            for arm in arms {
                push(lines, depth, |s| labels(s, &arm.labels));
                block(&arm.body, depth + 1, lines);
            }
            if !otherwise.is_empty() {
                words(lines, depth, "ELSE");
                block(otherwise, depth + 1, lines);
            }
            words(lines, depth, "END_CASE");
        }
        StmtKind::For { var, from, to, by, body } => {
            push(lines, depth, |s| {
                s.text(&format!("FOR {} := ", clean(&var.text)));
                s.expr(from, 1);
                s.text(" TO ");
                s.expr(to, 1);
                if let Some(by) = by {
                    s.text(" BY ");
                    s.expr(by, 1);
                }
                s.text(" DO");
            });
            block(body, depth + 1, lines);
            words(lines, depth, "END_FOR");
        }
        StmtKind::While(condition, body) => {
            push(lines, depth, |s| {
                s.text("WHILE ");
                s.expr(condition, 0);
                s.text(" DO");
            });
            block(body, depth + 1, lines);
            words(lines, depth, "END_WHILE");
        }
        StmtKind::Repeat(body, until) => {
            words(lines, depth, "REPEAT");
            block(body, depth + 1, lines);
            push(lines, depth, |s| {
                s.text("UNTIL ");
                s.expr(until, 0);
            });
            words(lines, depth, "END_REPEAT");
        }
        StmtKind::Exit => words(lines, depth, "EXIT"),
        StmtKind::Return => words(lines, depth, "RETURN"),
    }
}

fn labels(s: &mut Setter, labels: &[(g7_model::Expr, Option<g7_model::Expr>)]) {
    for (i, (from, to)) in labels.iter().enumerate() {
        if i > 0 {
            s.text(", ");
        }
        s.expr(from, 1);
        if let Some(to) = to {
            s.text("..");
            s.expr(to, 1);
        }
    }
    s.text(":");
}
