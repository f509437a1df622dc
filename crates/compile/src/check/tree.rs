//! Looks into expressions and statements.

use std::fmt::Write;

use crate::ir::{ActionKind, Expr, ExprKind, Stmt, StmtKind, Target, Unit, VarId};

/// Every statement that runs, also those inside others, in no special order.
pub(super) fn statements(unit: &Unit) -> Vec<&Stmt> {
    let bodies = unit.pre.iter().chain(&unit.post).chain(&unit.bodies);
    let mut list: Vec<&Stmt> = bodies.flat_map(|b| &b.statements).collect();
    list.extend(unit.sections.iter().flat_map(|s| &s.statements));
    list.extend(unit.transitions.iter().flat_map(|t| &t.on_clearing));
    for action in unit.steps.iter().flat_map(|s| &s.actions) {
        if let ActionKind::Work { work, .. }
        | ActionKind::OnEvent { work, .. }
        | ActionKind::EachScan { work, .. } = &action.kind
        {
            list.extend(work);
        }
    }
    within(list)
}

/// These statements and all inside them.
pub(super) fn within<'u>(list: impl IntoIterator<Item = &'u Stmt>) -> Vec<&'u Stmt> {
    let mut pending: Vec<&Stmt> = list.into_iter().collect();
    let mut all = Vec::new();
    while let Some(s) = pending.pop() {
        all.push(s);
        match &s.kind {
            StmtKind::If(arms, rest) => {
                pending.extend(arms.iter().flat_map(|(_, b)| b));
                pending.extend(rest);
            }
            StmtKind::Case(_, arms, rest) => {
                pending.extend(arms.iter().flat_map(|(_, b)| b));
                pending.extend(rest);
            }
            StmtKind::For { body, .. } | StmtKind::While(_, body) | StmtKind::Repeat(body, _) => {
                pending.extend(body);
            }
            StmtKind::Assign(..)
            | StmtKind::Fb { .. }
            | StmtKind::Exit
            | StmtKind::Return
            | StmtKind::Service(_) => {}
        }
    }
    all
}

/// The variables that a statement itself writes; for a function block the instance.
pub(super) fn written(s: &Stmt) -> Vec<VarId> {
    let variable = |t: &Target| match t {
        Target::Var(v) | Target::Element(v, _) | Target::Member(v, _) => *v,
    };
    match &s.kind {
        StmtKind::Assign(target, _) => vec![variable(target)],
        StmtKind::Fb { var, outputs, .. } => {
            std::iter::once(*var).chain(outputs.iter().map(|(_, t)| variable(t))).collect()
        }
        StmtKind::For { var, .. } => vec![*var],
        _ => Vec::new(),
    }
}

/// True if some part of an expression is an edge.
pub(super) fn has_edge(e: &Expr) -> bool {
    let mut pending = vec![e];
    while let Some(e) = pending.pop() {
        if matches!(e.kind, ExprKind::Rise(_) | ExprKind::Fall(_)) {
            return true;
        }
        pending.extend(e.operands());
    }
    false
}

/// A text that is equal for equal expressions, wherever they stand.
pub(super) fn key(e: &Expr) -> String {
    let mut text = String::new();
    write_key(e, &mut text);
    text
}

fn write_key(e: &Expr, out: &mut String) {
    // Writes the head of each form, then its operands in brackets. Writing to a String cannot fail.
    let _ = match &e.kind {
        ExprKind::Const(v) => write!(out, "{v:?}"),
        ExprKind::Var(v) => write!(out, "v{}", v.0),
        ExprKind::Element(v, _) => write!(out, "v{}@", v.0),
        ExprKind::Member(v, m) => write!(out, "v{}.{m}", v.0),
        ExprKind::StepActive(s) => write!(out, "x{}", s.0),
        ExprKind::StepTime(s) => write!(out, "t{}", s.0),
        ExprKind::StepTenths(s) => write!(out, "T{}", s.0),
        ExprKind::StepScans(s) => write!(out, "n{}", s.0),
        ExprKind::StepSeconds(s) => write!(out, "s{}", s.0),
        ExprKind::Not(_) => write!(out, "!"),
        ExprKind::Neg(_) => write!(out, "-"),
        ExprKind::Rise(_) => write!(out, "rise"),
        ExprKind::Fall(_) => write!(out, "fall"),
        ExprKind::Binary(op, ..) => write!(out, "{op:?}"),
        ExprKind::Timer { .. } => write!(out, "timer"),
        ExprKind::Convert(_) => write!(out, "to {:?}", e.ty),
        ExprKind::Trunc(_) => write!(out, "trunc {:?}", e.ty),
        ExprKind::Builtin(f, _) => write!(out, "{f:?}"),
        ExprKind::Call(f, _) => write!(out, "f{}", f.0),
        ExprKind::Section(s) => write!(out, "section{}", s.0),
        ExprKind::ScanTime => write!(out, "dt"),
        ExprKind::Random => write!(out, "random"),
    };
    let list = e.operands();
    if !list.is_empty() {
        out.push('(');
        for e in list {
            write_key(e, out);
            out.push(',');
        }
        out.push(')');
    }
}
