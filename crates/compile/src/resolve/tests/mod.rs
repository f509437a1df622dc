//! The typing rules and path rules as tables, and what resolving makes of charts.

mod paths;
mod typing;
mod units;

use g7_model::{Document, FileId, Problem};

use super::{Scopes, resolve_open, resolve_query};
use crate::ir::{ChartId, Expr, ExprKind, Unit, Value};

/// A document that can be read.
fn read(text: &str) -> Document {
    let (doc, problems) = g7_syntax::parse(text, FileId::default());
    assert!(problems.is_empty(), "{problems:?}\n{text}");
    doc
}

/// A document that has a meaning.
fn resolved(doc: &Document) -> (Unit, Scopes<'_>) {
    let (unit, scopes, problems) = resolve_open(doc, None);
    assert!(problems.is_empty(), "{problems:?}");
    (unit, scopes)
}

/// Reads an expression as a question, seen from a chart or the file.
fn ask(
    unit: &mut Unit,
    scopes: &mut Scopes<'_>,
    text: &str,
    chart: Option<ChartId>,
) -> Result<Expr, Vec<Problem>> {
    let (e, problems) = g7_syntax::parse_expr(text, FileId::default());
    assert!(problems.is_empty(), "{problems:?}\n{text}");
    let (expr, problems) = resolve_query(unit, scopes, &e, chart, None);
    match expr {
        Some(e) if problems.is_empty() => Ok(e),
        _ => Err(problems),
    }
}

/// The codes of problems, or the expression as text.
fn outcome(unit: &Unit, result: Result<Expr, Vec<Problem>>) -> String {
    match result {
        Ok(e) => format!("{} : {}", show(unit, &e), e.ty),
        Err(problems) => problems.iter().map(|p| p.code.id).collect::<Vec<_>>().join(" "),
    }
}

/// A typed expression in one line: conversions show as `DINT(n)`.
fn show(unit: &Unit, e: &Expr) -> String {
    let var = |v: &crate::ir::VarId| unit.vars[v.index()].name.to_string();
    let step = |s: &crate::ir::StepId| {
        let s = &unit.steps[s.index()];
        format!("{}.{}", unit.charts[s.chart.index()].path, s.name)
    };
    let all = |list: &[Expr]| list.iter().map(|e| show(unit, e)).collect::<Vec<_>>().join(", ");
    match &e.kind {
        ExprKind::Const(Value::Bool(b)) => b.to_string(),
        ExprKind::Const(Value::Int(n)) => n.to_string(),
        ExprKind::Const(Value::Real(x)) => format!("{x:?}"),
        ExprKind::Const(Value::Str(s)) => format!("'{s}'"),
        ExprKind::Var(v) => var(v),
        ExprKind::Element(all, k) => format!("{}[{}]", var(&all.first), show(unit, &k[0])),
        ExprKind::Member(v, m) => format!("{}#{m}", var(v)),
        ExprKind::StepActive(s) => format!("active {}", step(s)),
        ExprKind::StepTime(s) => format!("time {}", step(s)),
        ExprKind::StepTenths(s) => format!("tenths {}", step(s)),
        ExprKind::StepScans(s) => format!("scans {}", step(s)),
        ExprKind::StepSeconds(s) => format!("seconds {}", step(s)),
        ExprKind::Not(a) => format!("not {}", show(unit, a)),
        ExprKind::Neg(a) => format!("-{}", show(unit, a)),
        ExprKind::Rise(a) => format!("rise {}", show(unit, a)),
        ExprKind::Fall(a) => format!("fall {}", show(unit, a)),
        ExprKind::Binary(op, a, b) => format!("({} {op:?} {})", show(unit, a), show(unit, b)),
        ExprKind::Timer { t1, e, t2 } => {
            let t2 = t2.as_ref().map_or("-".to_owned(), |t| show(unit, t));
            format!("timer({}, {}, {t2})", show(unit, t1), show(unit, e))
        }
        ExprKind::Convert(a) => format!("{}({})", e.ty, show(unit, a)),
        ExprKind::Trunc(a) => format!("trunc {}({})", e.ty, show(unit, a)),
        ExprKind::Builtin(f, args) => format!("{f:?}({})", all(args)),
        ExprKind::Call(f, args) => format!("{}({})", unit.functions[f.index()].name, all(args)),
        ExprKind::Section(s) => format!("section {}", unit.sections[s.index()].name),
        ExprKind::ScanTime => "scan time".to_owned(),
        ExprKind::Random => "random".to_owned(),
    }
}
