//! Documents as short lines to compare with, brackets round every operation.

use crate::support;
use std::path::PathBuf;

use g7_model::{
    Action, ActionKind, BinaryOp, Chart, Document, Expr, ExprKind, FileId, Item, Literal, Problem, Step,
    Stmt, StmtKind, Target, UnaryOp, VarDecl, VarKind, Work,
};

/// A file of `tests/interchange/jgrafchart`.
pub(crate) fn path(name: &str) -> PathBuf {
    [env!("CARGO_MANIFEST_DIR"), "..", "..", "tests", "interchange", "jgrafchart", name].iter().collect()
}

/// Its bytes.
pub(crate) fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(path(name)).expect("the file is part of the repository")
}

/// Its result.
pub(crate) fn import(name: &str) -> (Document, Vec<Problem>) {
    support::import("jgrafchart", &bytes(name), FileId(0))
}

pub(crate) fn chart<'a>(document: &'a Document, name: &str) -> &'a Chart {
    document.charts().find(|c| &*c.name.text == name).unwrap_or_else(|| panic!("no chart {name}"))
}

pub(crate) fn step<'a>(document: &'a Document, chart: &str, name: &str) -> &'a Step {
    let steps = || self::chart(document, chart).steps();
    steps().find(|s| &*s.name.text == name).unwrap_or_else(|| panic!("no step {name} in {chart}"))
}

/// `code line: words` of each problem.
pub(crate) fn problems(bytes: &[u8], problems: &[Problem]) -> Vec<String> {
    let line = |at: u32| 1 + bytes.iter().take(at as usize).filter(|b| **b == b'\n').count();
    problems.iter().map(|p| format!("{} {}: {}", p.code.id, line(p.at.start), p.what)).collect()
}

/// `input Tilt BOOL at 30`.
pub(crate) fn var(v: &VarDecl) -> String {
    let kind = match v.kind {
        VarKind::Input => "input",
        VarKind::Output => "output",
        VarKind::Var => "var",
        VarKind::Const => "const",
    };
    let names: Vec<&str> = v.names.iter().map(|n| &*n.text).collect();
    let mut line = format!("{kind} {} {}", names.join(","), v.ty);
    if let Some(init) = &v.init {
        line += &format!(" := {}", expr(init));
    }
    if let Some(address) = &v.address {
        line += &format!(" at {}", address.text);
    }
    if v.inverted {
        line += " inverted";
    }
    if v.retain {
        line += " retain";
    }
    line
}

/// The variables of the file.
pub(crate) fn vars(document: &Document) -> Vec<String> {
    document.items.iter().filter_map(|i| if let Item::Var(v) = i { Some(var(v)) } else { None }).collect()
}

/// `a, b -> c when e priority 1` of each transition.
pub(crate) fn transitions(chart: &Chart) -> Vec<String> {
    let names = |list: &[g7_model::Name]| list.iter().map(|n| &*n.text).collect::<Vec<_>>().join(", ");
    chart
        .transitions()
        .map(|t| {
            let priority = t.priority.map_or(String::new(), |p| format!(" priority {p}"));
            format!("{} -> {} when {}{priority}", names(&t.from), names(&t.to), expr(&t.receptivity))
        })
        .collect()
}

/// The actions of a step.
pub(crate) fn actions(step: &Step) -> Vec<String> {
    step.actions.iter().map(action).collect()
}

fn action(a: &Action) -> String {
    match &a.kind {
        ActionKind::Qualified { qualifier, time: None, target, condition: None } => {
            let target = match target {
                Target::Path(p) => p.text(),
                Target::Work(w) => work(w),
                Target::Element(element) => format!("{:?}", element.kind),
                Target::Direct(..) => "?".to_string(),
            };
            format!("{} {target}", qualifier.name())
        }
        ActionKind::EachScan { work: w, condition: None } => format!("each scan: {}", work(w)),
        other => format!("{other:?}"),
    }
}

fn work(w: &Work) -> String {
    let stmt = |s: &Stmt| match &s.kind {
        StmtKind::Assign { target, value } => format!("{} := {}", expr(target), expr(value)),
        other => format!("{other:?}"),
    };
    w.statements().iter().map(stmt).collect::<Vec<_>>().join("; ")
}

/// An expression with all its brackets.
pub(crate) fn expr(e: &Expr) -> String {
    match &e.kind {
        ExprKind::Literal(Literal::Bool(b)) => b.to_string().to_uppercase(),
        ExprKind::Literal(Literal::Int(n, None)) => n.to_string(),
        ExprKind::Literal(Literal::Real(r, None)) => r.to_string(),
        ExprKind::Literal(Literal::Str(s)) => format!("'{s}'"),
        ExprKind::Path(p) => p.text(),
        ExprKind::Unary(op, e) => {
            let sign = match op {
                UnaryOp::Not => "not ",
                UnaryOp::Neg => "-",
                UnaryOp::Rise => "↑",
                UnaryOp::Fall => "↓",
            };
            format!("{sign}{}", expr(e))
        }
        ExprKind::Binary(op, a, b) => format!("({} {} {})", expr(a), sign(*op), expr(b)),
        ExprKind::Call(p, args) => {
            let args: Vec<String> = args.iter().map(|a| expr(&a.value)).collect();
            format!("{}({})", p.text(), args.join(", "))
        }
        ExprKind::Bad => "bad".to_string(),
        other => format!("{other:?}"),
    }
}

fn sign(op: BinaryOp) -> &'static str {
    match op {
        BinaryOp::Or => "or",
        BinaryOp::And => "and",
        BinaryOp::Eq => "=",
        BinaryOp::Ne => "<>",
        BinaryOp::Lt => "<",
        BinaryOp::Le => "<=",
        BinaryOp::Gt => ">",
        BinaryOp::Ge => ">=",
        BinaryOp::Add => "+",
        BinaryOp::Sub => "-",
        BinaryOp::Mul => "*",
        BinaryOp::Div => "/",
        BinaryOp::Mod => "mod",
        BinaryOp::Xor | BinaryOp::Dot | BinaryOp::Pow => "?",
    }
}
