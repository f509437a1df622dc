//! Functions that only the document of a plant has: random numbers, and the time of a tick. An
//! author cannot write their names.

use g7_model::{Span, Type};

use super::types::{Typed, converted};
use crate::ir::{BinaryOp, Expr, ExprKind, Value};

/// A function of the plant, if this is its name.
pub(super) fn function(name: &str, at: Span) -> Option<Typed> {
    match name {
        "@random" => Some(Typed::of(ExprKind::Random, Type::Lreal, at)),
        "@tick" => Some(Typed::of(ExprKind::ScanTime, Type::Time, at)),
        // The nanoseconds as a number, then converted to seconds.
        "@dt" => {
            let ns = converted(Expr { kind: ExprKind::ScanTime, ty: Type::Lint, at }, Type::Lreal);
            let unit = Typed::constant(Value::Real(1e-9), Type::Lreal, at).expr;
            let seconds = ExprKind::Binary(BinaryOp::Mul, Box::new(ns), Box::new(unit));
            Some(Typed::of(seconds, Type::Lreal, at))
        }
        _ => None,
    }
}
