//! Looks into expressions and statements.

use std::hash::{Hash, Hasher};
use std::mem::{Discriminant, discriminant};

use g7_engine::Builtin;
use g7_model::Type;

use crate::ir::{ActionKind, BinaryOp, Expr, ExprKind, Stmt, StmtKind, Target, Unit, Value, VarId};

/// Every statement that runs, also those inside others, in no special order.
#[inline(never)]
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
#[inline(never)]
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
#[inline(never)]
pub(super) fn written(s: &Stmt) -> Vec<VarId> {
    let variables = |t: &Target| match t {
        Target::Var(v) | Target::Member(v, _) => vec![*v],
        Target::Element(all, _) => all.iter().collect(),
    };
    match &s.kind {
        StmtKind::Assign(target, _) => variables(target),
        StmtKind::Fb { var, outputs, .. } => {
            std::iter::once(*var).chain(outputs.iter().flat_map(|(_, t)| variables(t))).collect()
        }
        StmtKind::For { var, .. } => vec![*var],
        _ => Vec::new(),
    }
}

/// True if some part of an expression is an edge.
pub(super) fn has_edge(e: &Expr) -> bool {
    matches!(e.kind, ExprKind::Rise(_) | ExprKind::Fall(_)) || e.operands().any(has_edge)
}

/// An expression without its place: it is equal to the same expression elsewhere.
#[derive(Clone, Copy)]
pub(super) struct Form<'e>(pub(super) &'e Expr);

impl PartialEq for Form<'_> {
    fn eq(&self, other: &Self) -> bool {
        head(self.0) == head(other.0) && self.0.operands().map(Form).eq(other.0.operands().map(Form))
    }
}

impl Eq for Form<'_> {}

impl Hash for Form<'_> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        head(self.0).hash(state);
        self.0.operands().for_each(|e| Form(e).hash(state));
    }
}

/// An expression apart from its operands.
#[derive(PartialEq, Eq, Hash)]
enum Head<'e> {
    Const(Constant<'e>),
    Operator(BinaryOp),
    Builtin(Builtin),
    /// A conversion to a type.
    To(Discriminant<ExprKind>, Type),
    /// A form with the number of what it reads or calls and of its member, 0 where it has none.
    Of(Discriminant<ExprKind>, u32, u8),
}

#[inline(never)]
fn head(e: &Expr) -> Head<'_> {
    let form = discriminant(&e.kind);
    match &e.kind {
        ExprKind::Const(v) => Head::Const(Constant::of(v)),
        ExprKind::Binary(op, ..) => Head::Operator(*op),
        ExprKind::Builtin(f, _) => Head::Builtin(*f),
        ExprKind::Convert(_) | ExprKind::Trunc(_) => Head::To(form, e.ty),
        ExprKind::Var(v) => Head::Of(form, v.0, 0),
        ExprKind::Element(all, _) => Head::Of(form, all.first.0, 0),
        ExprKind::Member(v, m) => Head::Of(form, v.0, *m),
        ExprKind::StepActive(s)
        | ExprKind::StepTime(s)
        | ExprKind::StepTenths(s)
        | ExprKind::StepScans(s)
        | ExprKind::StepSeconds(s) => Head::Of(form, s.0, 0),
        ExprKind::Call(f, _) => Head::Of(form, f.0, 0),
        ExprKind::Section(s) => Head::Of(form, s.0, 0),
        ExprKind::Not(_)
        | ExprKind::Neg(_)
        | ExprKind::Rise(_)
        | ExprKind::Fall(_)
        | ExprKind::Timer { .. }
        | ExprKind::ScanTime
        | ExprKind::Random => Head::Of(form, 0, 0),
    }
}

/// A constant that is equal to itself, as `NaN` is not.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Constant<'e> {
    Bool(bool),
    Int(i128),
    /// The bits of a real.
    Real(u64),
    Str(&'e str),
}

impl<'e> Constant<'e> {
    pub(super) fn of(value: &'e Value) -> Constant<'e> {
        match value {
            Value::Bool(v) => Constant::Bool(*v),
            Value::Int(n) => Constant::Int(*n),
            Value::Real(x) => Constant::Real(x.to_bits()),
            Value::Str(s) => Constant::Str(s),
        }
    }
}
