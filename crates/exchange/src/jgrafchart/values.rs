//! Initial values of variables, as expressions.

use g7_model::{Expr, ExprKind, Literal, Span, Type, UnaryOp, VarKind};

use super::express::written;
use super::sheet::{Value, Var};

/// The initial value of a procedure's variable at each call.
pub(super) fn initial(var: &Var, at: Span) -> Expr {
    literal(var.init.as_ref().unwrap_or(&zero(var.ty)), at)
}

fn zero(ty: Type) -> Value {
    match ty {
        Type::Bool => Value::Bool(false),
        Type::Dint => Value::Int(0),
        Type::Lreal => Value::Real(0.0),
        _ => Value::Str(String::new()),
    }
}

/// The value of a constant without a written one.
pub(super) fn constant_zero(var: &Var, at: Span) -> Option<Expr> {
    if var.kind != VarKind::Const {
        return None;
    }
    Some(literal(&zero(var.ty), at))
}

/// A value as an expression; a negative number is a sign before a literal.
pub(super) fn literal(value: &Value, at: Span) -> Expr {
    let (literal, negative) = match value {
        Value::Bool(b) => (Literal::Bool(*b), false),
        Value::Int(n) => (Literal::Int(i128::from(*n).abs(), None), *n < 0),
        Value::Real(r) => (Literal::Real(written(r.abs()).into(), None), *r < 0.0),
        Value::Str(s) => (Literal::Str(s.as_str().into()), false),
    };
    let expr = Expr { kind: ExprKind::Literal(literal), at: at.into() };
    if !negative {
        return expr;
    }
    Expr { kind: ExprKind::Unary(UnaryOp::Neg, Box::new(expr)), at: at.into() }
}
