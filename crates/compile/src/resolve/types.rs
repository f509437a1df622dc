//! Widening of types, and how a value takes the type that its place needs.

use g7_model::{Moment, Problem, Said, Span, Type, codes, say};

use super::constant::{self, Fault, transferred};
use super::resolver::Resolver;
use crate::ir::{Expr, ExprKind, Value};
use crate::tree::transfers;

/// An expression, with a flag for an untyped literal: such a constant adapts to the type that is
/// needed.
#[derive(Clone, Debug)]
pub(super) struct Typed {
    pub(super) expr: Expr,
    pub(super) literal: bool,
}

impl Typed {
    /// An expression with a type of its own.
    pub(super) fn of(kind: ExprKind, ty: Type, at: Span) -> Typed {
        Typed { expr: Expr { kind, ty, at }, literal: false }
    }

    /// A constant with a type of its own.
    pub(super) fn constant(value: Value, ty: Type, at: Span) -> Typed {
        Typed::of(ExprKind::Const(value), ty, at)
    }

    /// An untyped literal; its type here serves only for messages.
    pub(super) fn untyped(value: Value, at: Span) -> Typed {
        let ty = if matches!(value, Value::Real(_)) { Type::Lreal } else { Type::Lint };
        Typed { expr: Expr { kind: ExprKind::Const(value), ty, at }, literal: true }
    }

    /// Its value, if it is a constant.
    pub(super) fn value(&self) -> Option<&Value> {
        match &self.expr.kind {
            ExprKind::Const(v) => Some(v),
            _ => None,
        }
    }

    /// True for a literal 0 or 1, which count as FALSE and TRUE.
    pub(super) fn truth_literal(&self) -> bool {
        self.literal && matches!(self.value(), Some(Value::Int(0 | 1)))
    }
}

/// True if every value of `from` is accepted as `to` without a conversion by the author.
pub(super) fn widens(from: Type, to: Type) -> bool {
    if let (Some((a, b)), Some((c, d))) = (from.bounds(), to.bounds()) {
        return c <= a && b <= d;
    }
    match to {
        Type::Real => from == Type::Real || from.is_integer() && bits(from) <= bits(Type::Real),
        Type::Lreal => from == Type::Lreal || widens(from, Type::Real),
        Type::String(_) => matches!(from, Type::String(_)),
        _ => from == to,
    }
}

/// True if a value can be taken for a number: a bit string has the values of a whole type without
/// a sign (decision 57).
fn counts(ty: Type) -> bool {
    ty.is_number() || ty.is_bits()
}

fn bits(ty: Type) -> u8 {
    ty.elementary().map_or(0, |row| row.bits)
}

/// The narrowest type that both widen to.
pub fn common(a: Type, b: Type) -> Option<Type> {
    match (a, b) {
        (Type::String(m), Type::String(n)) => Some(Type::String(m.max(n))),
        (Type::Fb(_), _) | (_, Type::Fb(_)) => None,
        _ if a == b => Some(a),
        _ if a.is_bits() && b.is_bits() => Some(if widens(a, b) { b } else { a }),
        _ if !counts(a) || !counts(b) => None,
        _ => {
            let both = Type::ELEMENTARY.into_iter().filter(|t| widens(a, *t) && widens(b, *t));
            both.filter(|t| !t.is_bits()).min_by_key(|t| (t.is_real(), bits(*t)))
        }
    }
}

impl Resolver<'_, '_> {
    /// Returns the expression in the type that is needed.
    pub(super) fn coerce(&mut self, t: Typed, want: Type) -> Option<Expr> {
        if t.literal {
            return self.adapt(t, want);
        }
        let e = t.expr;
        if e.ty == want {
            return Some(e);
        }
        if let (Type::String(_), Type::String(most)) = (e.ty, want) {
            return self.fitting_text(e, most);
        }
        if widens(e.ty, want) {
            return Some(converted(e, want));
        }
        let problem = wrong_type(&e, want);
        self.report(problem)
    }

    /// A constant text must fit; a variable one is cut when it is copied.
    fn fitting_text(&mut self, e: Expr, most: u16) -> Option<Expr> {
        if let ExprKind::Const(Value::Str(s)) = &e.kind
            && s.len() > usize::from(most)
        {
            let what = say!("this text has {} bytes, at most {most} fit", s.len());
            return self.report(Problem::new(&codes::OUT_OF_RANGE, e.at, what));
        }
        Some(e)
    }

    /// An untyped literal takes the type that is needed.
    fn adapt(&mut self, t: Typed, want: Type) -> Option<Expr> {
        let at = t.expr.at;
        let ExprKind::Const(value) = &t.expr.kind else { return Some(t.expr) };
        let adapted = match (value, want) {
            (Value::Int(n @ (0 | 1)), Type::Bool) => Value::Bool(*n == 1),
            (Value::Int(n), _) if want.is_integer() || want.is_bits() => match constant::fit(want, *n) {
                Ok(n) => Value::Int(n),
                Err(_) => return self.out_of_range(n, want, at),
            },
            (Value::Int(n), Type::Lreal) => Value::Real(*n as f64),
            (Value::Int(n), Type::Real) => Value::Real(f64::from(*n as f32)),
            (Value::Real(x), Type::Real | Type::Lreal) => {
                let narrow = constant::narrow(want, *x);
                if !narrow.is_finite() {
                    return self.out_of_range(x, want, at);
                }
                Value::Real(narrow)
            }
            _ => {
                let problem = wrong_literal(value, want, at);
                return self.report(problem);
            }
        };
        Some(Expr { kind: ExprKind::Const(adapted), ty: want, at })
    }

    fn out_of_range<T>(&mut self, value: impl std::fmt::Display, ty: Type, at: Span) -> Option<T> {
        let mut problem = Problem::new(
            &codes::OUT_OF_RANGE,
            at,
            say!("{} does not fit into {ty}", Said::foreign(value.to_string())),
        );
        if let Some((least, most)) = ty.bounds() {
            problem.help = Some(say!("{ty} goes from {least} to {most}"));
        }
        self.report(problem)
    }

    /// The type that a literal takes if nothing asks for one.
    pub(super) fn settle(&mut self, t: Typed) -> Option<Expr> {
        if !t.literal {
            return Some(t.expr);
        }
        let want = match t.value() {
            Some(Value::Int(n)) => {
                let fits = |ty: Type| constant::fit(ty, *n).is_ok();
                [Type::Dint, Type::Lint].into_iter().find(|t| fits(*t)).unwrap_or(Type::Ulint)
            }
            _ => Type::Lreal,
        };
        self.coerce(t, want)
    }

    /// Reports constant arithmetic that has no result.
    pub(super) fn constant_fault<T>(&mut self, fault: Fault, ty: Type, at: Span) -> Option<T> {
        self.report(match fault {
            Fault::Overflow => {
                let what = say!("the result does not fit into {ty}");
                Problem::new(&codes::CONSTANT_FAULT, at, what)
            }
            Fault::Division => Problem::new(&codes::CONSTANT_FAULT, at, say!("division by zero")),
        })
    }
}

/// Converts to a wider type; constants are converted at once.
pub(super) fn converted(e: Expr, to: Type) -> Expr {
    let at = e.at;
    if let ExprKind::Const(Value::Int(n)) = &e.kind
        && transfers(e.ty, to)
    {
        return Expr { kind: ExprKind::Const(Value::Int(transferred(*n, to))), ty: to, at };
    }
    if let ExprKind::Const(v) = &e.kind
        && let Ok(Some(v)) = constant::convert(v, to)
    {
        return Expr { kind: ExprKind::Const(v), ty: to, at };
    }
    Expr { kind: ExprKind::Convert(Box::new(e)), ty: to, at }
}

/// The length of a text is left out of messages about types.
fn plain(ty: Type) -> Type {
    if matches!(ty, Type::String(_)) { Type::STRING } else { ty }
}

fn wrong_type(e: &Expr, want: Type) -> Problem {
    let problem = Problem::new(
        &codes::WRONG_TYPE,
        e.at,
        say!("this is {}, but {} is needed here", plain(e.ty), plain(want)),
    );
    match (e.ty, want) {
        (Type::Fb(kind), _) => {
            let outputs = kind.members().iter().filter(|m| !m.2 && m.1 == want);
            match outputs.map(|m| m.0).next() {
                Some(q) => problem.help(say!("its output is `.{q}`")),
                None => problem,
            }
        }
        (_, Type::Fb(_)) => problem,
        (from, Type::Bool) if from.is_number() || from.is_bits() => {
            problem.help(say!("compare it, as in `n <> 0`"))
        }
        (from, to) if from.is_number() && to.is_number() => {
            problem.help(say!("convert it with `{from}_TO_{to}(…)`; a value that does not fit is a fault"))
        }
        (from, to) if transfers(from, to) => {
            problem.help(say!("convert it with `{from}_TO_{to}(…)`, which takes the lowest bits"))
        }
        (Type::Time, to) if to.is_number() => {
            problem.help(say!("convert it with `TIME_TO_{to}(…)`, in milliseconds"))
        }
        (from, Type::Time) if from.is_number() => {
            problem.help(say!("convert it with `{from}_TO_TIME(…)`, in milliseconds"))
        }
        _ => problem,
    }
}

/// How a constant of the type is written, for a message.
fn example(moment: Moment) -> Said {
    match moment {
        Moment::Date => say!("write a date, as in `D#2026-11-28`"),
        Moment::Tod => say!("write a time of day, as in `TOD#15:36:55`"),
        Moment::Dt => say!("write a date with a time, as in `DT#2026-11-28-15:36:55`"),
    }
}

fn wrong_literal(value: &Value, want: Type, at: Span) -> Problem {
    let what = match value {
        Value::Real(_) => say!("a real number"),
        _ => say!("a whole number"),
    };
    let problem =
        Problem::new(&codes::WRONG_TYPE, at, say!("this is {what}, but {} is needed here", plain(want)));
    match (value, want) {
        (_, Type::Moment(moment)) => problem.help(example(moment)),
        (_, Type::Time) => problem.help(say!("write a duration, as in `5s` or `200ms`")),
        (Value::Int(_), Type::Bool) => {
            problem.help(say!("of the numbers only 0 and 1 stand for FALSE and TRUE"))
        }
        (Value::Real(_), want) if want.is_number() => {
            problem.help(say!("write a whole number, or round with `REAL_TO_{}(…)`", plain(want)))
        }
        (Value::Int(n), Type::String(_)) => problem.help(say!("write it as a text: '{n}'")),
        _ => problem,
    }
}

#[cfg(test)]
mod tests {
    use super::{Type, common, widens};

    #[test]
    fn a_type_widens_only_where_no_value_is_lost() {
        use Type::{Bool, Dint, Int, Lint, Lreal, Real, Sint, Time, Udint, Uint, Ulint, Usint};
        let wider: &[(Type, &[Type])] = &[
            (Sint, &[Int, Dint, Lint, Real, Lreal]),
            (Int, &[Dint, Lint, Real, Lreal]),
            (Dint, &[Lint, Real, Lreal]),
            (Lint, &[]),
            (Usint, &[Int, Dint, Lint, Uint, Udint, Ulint, Real, Lreal]),
            (Uint, &[Dint, Lint, Udint, Ulint, Real, Lreal]),
            (Udint, &[Lint, Ulint, Real, Lreal]),
            (Ulint, &[]),
            (Real, &[Lreal]),
            (Lreal, &[]),
            (Bool, &[]),
            (Time, &[]),
        ];
        for (from, to) in wider {
            for (other, _) in wider {
                assert_eq!(widens(*from, *other), from == other || to.contains(other), "{from} {other}");
            }
        }
    }

    #[test]
    fn the_common_type_is_the_narrowest_that_holds_both() {
        use Type::{Bool, Dint, Int, Lint, Lreal, Real, Sint, Time, Udint, Uint, Ulint, Usint};
        for (a, b, want) in [
            (Int, Int, Some(Int)),
            (Int, Dint, Some(Dint)),
            (Int, Uint, Some(Dint)),
            (Sint, Usint, Some(Int)),
            (Dint, Udint, Some(Lint)),
            (Lint, Ulint, None),
            (Dint, Real, Some(Real)),
            (Real, Lreal, Some(Lreal)),
            (Lint, Real, None),
            (Bool, Int, None),
            (Time, Int, None),
            (Time, Time, Some(Time)),
            (Type::String(5), Type::String(9), Some(Type::String(9))),
        ] {
            assert_eq!(common(a, b), want, "{a} {b}");
            assert_eq!(common(b, a), want, "{b} {a}");
        }
    }
}
