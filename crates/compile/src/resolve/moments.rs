//! Dates and times of day: what is computed with them (IEC 61131-3:2003, tables 22 and 30; 2013, tables 35 and 36).
//!
//! Their values are nanoseconds, as those of TIME. This file alone knows which of their types can be added or subtracted;
//! from `lower` on they are durations (decision 65).

use g7_model::{BinaryOp as Sign, Moment, Nanos, Problem, Span, Type, codes, say};

use super::constant::{self, Fault};
use super::made::{binary, choice, compare, constant as whole, unless};
use super::resolver::Resolver;
use super::types::{Typed, converted};
use crate::ir::{BinaryOp, Expr, ExprKind, Value, VarId};

pub(super) const DAY: i128 = Nanos::DAY.count() as i128;

/// 1970-01-01 was a Thursday, the fifth day of a week that begins with Sunday.
const FIRST: i128 = 4;

/// The duration since 1970-01-01, or since midnight.
fn since(e: Expr) -> Expr {
    converted(e, Type::Time)
}

fn known(e: &Expr) -> Option<i128> {
    match &e.kind {
        ExprKind::Const(Value::Int(n)) => Some(*n),
        _ => None,
    }
}

impl Resolver<'_, '_> {
    /// `a sign b`, where one of them is a date or a time of day.
    pub(super) fn with_moment(&mut self, sign: Sign, a: Typed, b: Typed, at: Span) -> Option<Typed> {
        match (sign, a.expr.ty, b.expr.ty) {
            (Sign::Sub, Type::Moment(m), Type::Moment(n)) if m == n => {
                self.finish(BinaryOp::Sub, since(a.expr), since(b.expr), Type::Time, at)
            }
            (Sign::Add | Sign::Sub, Type::Moment(moment @ (Moment::Tod | Moment::Dt)), Type::Time)
                if !b.literal =>
            {
                let op = if sign == Sign::Add { BinaryOp::Add } else { BinaryOp::Sub };
                let sum = self.finish(op, since(a.expr), b.expr, Type::Time, at)?;
                self.moment_of(sum.expr, moment, at)
            }
            _ => self.wrong_operands(sign, &a, &b, at),
        }
    }

    /// A duration since 1970 or since midnight as a value of a type. A DATE is the day in which it lies; what is no TOD is
    /// the fault `range`.
    pub(super) fn moment_of(&mut self, time: Expr, moment: Moment, at: Span) -> Option<Typed> {
        let ty = Type::Moment(moment);
        match moment {
            Moment::Dt => Some(Typed { expr: converted(Expr { at, ..time }, ty), literal: false }),
            Moment::Date => self.day(time, at),
            Moment::Tod => match known(&time) {
                Some(n) if (0..DAY).contains(&n) => Some(Typed::constant(Value::Int(n), ty, at)),
                Some(_) => self.constant_fault(Fault::Overflow, ty, at),
                None => {
                    let types = (Type::Time, ty);
                    let f = self.made("@TIME_within_a_day", types, at, |_, input, result| {
                        let given = || Expr { kind: ExprKind::Var(input), ty: Type::Time, at };
                        let (early, late) =
                            (compare(BinaryOp::Lt, given(), 0, at), compare(BinaryOp::Ge, given(), DAY, at));
                        let wrong = binary(BinaryOp::Or, early, late, Type::Bool, at);
                        vec![(result, converted(unless(wrong, given(), at), ty))]
                    });
                    Some(Typed::of(ExprKind::Call(f, vec![time]), ty, at))
                }
            },
        }
    }

    /// DT_TO_DATE: the beginning of the day.
    pub(super) fn day(&mut self, time: Expr, at: Span) -> Option<Typed> {
        let ty = Type::Moment(Moment::Date);
        let time = since(time);
        if let Some(n) = known(&time) {
            return match constant::fit(ty, n - n.rem_euclid(DAY)) {
                Ok(n) => Some(Typed::constant(Value::Int(n), ty, at)),
                Err(fault) => self.constant_fault(fault, ty, at),
            };
        }
        let f = self.made("@DT_TO_DATE", (Type::Time, ty), at, |r, input, result| {
            let rest = r.local("@DT_TO_DATE.rest", Type::Lint, at);
            let (mut list, from_midnight) = remainder(nanos(input, at), rest, DAY, at);
            let day = binary(BinaryOp::Sub, nanos(input, at), from_midnight, Type::Lint, at);
            list.push((result, converted(converted(day, Type::Time), ty)));
            list
        });
        Some(Typed::of(ExprKind::Call(f, vec![time]), ty, at))
    }

    /// DT_TO_TOD: the time since midnight.
    pub(super) fn time_of_day(&mut self, time: Expr, at: Span) -> Option<Typed> {
        let ty = Type::Moment(Moment::Tod);
        let time = since(time);
        if let Some(n) = known(&time) {
            return Some(Typed::constant(Value::Int(n.rem_euclid(DAY)), ty, at));
        }
        let f = self.made("@DT_TO_TOD", (Type::Time, ty), at, |r, input, result| {
            let rest = r.local("@DT_TO_TOD.rest", Type::Lint, at);
            let (mut list, from_midnight) = remainder(nanos(input, at), rest, DAY, at);
            list.push((result, converted(converted(from_midnight, Type::Time), ty)));
            list
        });
        Some(Typed::of(ExprKind::Call(f, vec![time]), ty, at))
    }

    /// DAY_OF_WEEK: 0 for Sunday, up to 6 for Saturday (IEC 61131-3:2013, table 36).
    pub(super) fn day_of_week(&mut self, day: Expr, at: Span) -> Option<Typed> {
        let time = since(day);
        if let Some(n) = known(&time) {
            let day = (n.div_euclid(DAY) + FIRST).rem_euclid(7);
            return Some(Typed::constant(Value::Int(day), Type::Int, at));
        }
        let f = self.made("@DAY_OF_WEEK", (Type::Time, Type::Int), at, |r, input, result| {
            let rest = r.local("@DAY_OF_WEEK.rest", Type::Lint, at);
            let day = whole(DAY, Type::Lint, at);
            let count = binary(BinaryOp::Div, nanos(input, at), day, Type::Lint, at);
            let shifted = binary(BinaryOp::Add, count, whole(FIRST, Type::Lint, at), Type::Lint, at);
            let (mut list, of_week) = remainder(shifted, rest, 7, at);
            list.push((result, converted(of_week, Type::Int)));
            list
        });
        Some(Typed::of(ExprKind::Call(f, vec![time]), Type::Int, at))
    }

    /// CONCAT_DATE_TOD: a day and a time of day.
    pub(super) fn day_with_time(&mut self, day: Expr, time: Expr, at: Span) -> Option<Typed> {
        let sum = self.finish(BinaryOp::Add, since(day), since(time), Type::Time, at)?;
        self.moment_of(sum.expr, Moment::Dt, at)
    }

    /// Reports a conversion that there is not.
    pub(super) fn no_conversion<T>(&mut self, from: Type, to: Type, at: Span) -> Option<T> {
        let what = say!("there is no conversion from {from} to {to}");
        self.report(Problem::new(&codes::UNKNOWN_NAME, at, what))
    }
}

/// The duration in a variable, as a number.
fn nanos(v: VarId, at: Span) -> Expr {
    converted(Expr { kind: ExprKind::Var(v), ty: Type::Time, at }, Type::Lint)
}

/// Assignments of a remainder to a variable, and the remainder as a number that is not negative: that of the engine has the
/// sign of the number.
fn remainder(of: Expr, rest: VarId, by: i128, at: Span) -> (Vec<(VarId, Expr)>, Expr) {
    let cut = binary(BinaryOp::Mod, of, whole(by, Type::Lint, at), Type::Lint, at);
    let left = || Expr { kind: ExprKind::Var(rest), ty: Type::Lint, at };
    let more = binary(BinaryOp::Add, left(), whole(by, Type::Lint, at), Type::Lint, at);
    (vec![(rest, cut)], choice(compare(BinaryOp::Lt, left(), 0, at), left(), more, at))
}
