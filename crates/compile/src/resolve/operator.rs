//! Operators between two typed operands.

use g7_model::{BinaryOp as Sign, Operands, Problem, Said, Span, Type, codes, say};

use super::resolver::Resolver;
use super::types::{Typed, common, converted};
use super::{bits, constant};
use crate::ir::{BinaryOp, Expr, ExprKind, Value};

/// True if the result has the type of the operands, so that a hint goes down to them.
pub(super) fn keeps_type(sign: Sign) -> bool {
    sign.row().operands != Operands::Comparison
}

/// The operator of the typed tree: there `·` is an AND like any other.
fn numeric(sign: Sign) -> BinaryOp {
    match sign {
        Sign::Or => BinaryOp::Or,
        Sign::Xor => BinaryOp::Xor,
        Sign::And | Sign::Dot => BinaryOp::And,
        Sign::Eq => BinaryOp::Eq,
        Sign::Ne => BinaryOp::Ne,
        Sign::Lt => BinaryOp::Lt,
        Sign::Le => BinaryOp::Le,
        Sign::Gt => BinaryOp::Gt,
        Sign::Ge => BinaryOp::Ge,
        Sign::Add => BinaryOp::Add,
        Sign::Sub => BinaryOp::Sub,
        Sign::Mul => BinaryOp::Mul,
        Sign::Div => BinaryOp::Div,
        Sign::Mod => BinaryOp::Mod,
        Sign::Pow => BinaryOp::Pow,
    }
}

fn compares(sign: Sign) -> bool {
    sign.row().operands == Operands::Comparison
}

impl Resolver<'_, '_> {
    /// `a sign b`.
    pub(super) fn combine(&mut self, sign: Sign, a: Typed, b: Typed, at: Span) -> Option<Typed> {
        let a_bool = !a.literal && a.expr.ty == Type::Bool;
        let b_bool = !b.literal && b.expr.ty == Type::Bool;
        match sign {
            Sign::Or | Sign::Xor | Sign::And | Sign::Dot => self.logic(sign, numeric(sign), a, b, at),
            Sign::Add if a_bool || b_bool => self.logic(sign, BinaryOp::Or, a, b, at),
            Sign::Mul if a_bool || b_bool => self.logic(sign, BinaryOp::And, a, b, at),
            _ if a.literal && b.literal => self.literals(sign, a, b, at),
            _ if compares(sign) => self.comparison(sign, a, b, at),
            _ if a_bool || b_bool => self.wrong_operands(sign, &a, &b, at),
            _ if a.expr.ty.is_moment() || b.expr.ty.is_moment() => self.with_moment(sign, a, b, at),
            _ if a.expr.ty == Type::Time || b.expr.ty == Type::Time => self.with_time(sign, a, b, at),
            Sign::Pow => self.power(a, b, at),
            _ => self.arithmetic(sign, a, b, at),
        }
    }

    /// Resolves a logical operator; its operands are BOOL, or the literals 0 and 1.
    fn logic(&mut self, sign: Sign, op: BinaryOp, a: Typed, b: Typed, at: Span) -> Option<Typed> {
        if bits::are_joined(&a, &b) {
            return self.bitwise(sign, a, b, at);
        }
        let logical = |t: &Typed| t.expr.ty == Type::Bool || t.truth_literal();
        if !logical(&a) && !logical(&b) && a.expr.ty.is_number() && b.expr.ty.is_number() {
            return self.wrong_operands(sign, &a, &b, at);
        }
        let a = self.coerce(a, Type::Bool);
        let b = self.coerce(b, Type::Bool);
        self.finish(op, a?, b?, Type::Bool, at)
    }

    /// Two untyped literals give an untyped literal, except in a comparison.
    fn literals(&mut self, sign: Sign, a: Typed, b: Typed, at: Span) -> Option<Typed> {
        let (Some(x), Some(y)) = (a.value(), b.value()) else { return None };
        match constant::literals(numeric(sign), x, y) {
            Ok(Some((v, true))) => Some(Typed::untyped(v, at)),
            Ok(Some((v, false))) => Some(Typed::constant(v, Type::Bool, at)),
            Ok(None) => self.wrong_operands(sign, &a, &b, at),
            Err(fault) => self.constant_fault(fault, Type::Lint, at),
        }
    }

    fn comparison(&mut self, sign: Sign, a: Typed, b: Typed, at: Span) -> Option<Typed> {
        let Some(ty) = meeting(&a, &b) else { return self.wrong_operands(sign, &a, &b, at) };
        let a = self.coerce(a, ty);
        let b = self.coerce(b, ty);
        self.finish(numeric(sign), a?, b?, Type::Bool, at)
    }

    fn arithmetic(&mut self, sign: Sign, a: Typed, b: Typed, at: Span) -> Option<Typed> {
        let (a, b) = (bits::as_number(a), bits::as_number(b));
        let Some(ty) = meeting(&a, &b).filter(|t| t.is_number()) else {
            return self.wrong_operands(sign, &a, &b, at);
        };
        if sign == Sign::Mod && !ty.is_integer() {
            return self.wrong_operands(sign, &a, &b, at);
        }
        let a = self.coerce(a, ty);
        let b = self.coerce(b, ty);
        self.finish(numeric(sign), a?, b?, ty, at)
    }

    /// Resolves `a ** b`. It is computed in LREAL; the result is REAL unless an operand is LREAL.
    fn power(&mut self, a: Typed, b: Typed, at: Span) -> Option<Typed> {
        let fine = |t: &Typed| t.literal || t.expr.ty.is_number();
        if !fine(&a) || !fine(&b) {
            return self.wrong_operands(Sign::Pow, &a, &b, at);
        }
        let long = |t: &Typed| !t.literal && t.expr.ty == Type::Lreal;
        let short = !(long(&a) || long(&b));
        let a = self.coerce(a, Type::Lreal);
        let b = self.coerce(b, Type::Lreal);
        let result = self.finish(BinaryOp::Pow, a?, b?, Type::Lreal, at)?;
        if !short {
            return Some(result);
        }
        let expr = converted(result.expr, Type::Real);
        Some(Typed { expr, literal: false })
    }

    /// Resolves sums of TIME, and TIME times or divided by a number.
    fn with_time(&mut self, sign: Sign, a: Typed, b: Typed, at: Span) -> Option<Typed> {
        let time = |t: &Typed| !t.literal && t.expr.ty == Type::Time;
        let number = |t: &Typed| t.literal || t.expr.ty.is_number();
        match sign {
            Sign::Add | Sign::Sub if time(&a) && time(&b) => {
                self.finish(numeric(sign), a.expr, b.expr, Type::Time, at)
            }
            Sign::Mul if number(&a) && time(&b) => self.scale(BinaryOp::Mul, b, a, at),
            Sign::Mul | Sign::Div if time(&a) && number(&b) => self.scale(numeric(sign), a, b, at),
            _ => self.wrong_operands(sign, &a, &b, at),
        }
    }

    fn scale(&mut self, op: BinaryOp, time: Typed, by: Typed, at: Span) -> Option<Typed> {
        let real = match by.value() {
            Some(Value::Real(_)) => true,
            _ => by.expr.ty.is_real(),
        };
        let by = self.coerce(by, if real { Type::Lreal } else { Type::Lint })?;
        if let (ExprKind::Const(t), ExprKind::Const(n)) = (&time.expr.kind, &by.kind) {
            match constant::scaled(op, t, n) {
                Ok(Some(v)) => return Some(Typed::constant(v, Type::Time, at)),
                Ok(None) => {}
                Err(fault) => return self.constant_fault(fault, Type::Time, at),
            }
        }
        self.sure_division(op, &by)?;
        let kind = ExprKind::Binary(op, Box::new(time.expr), Box::new(by));
        Some(Typed::of(kind, Type::Time, at))
    }

    /// Builds an operator whose operands have one type; constants are computed at once.
    pub(super) fn finish(&mut self, op: BinaryOp, a: Expr, b: Expr, ty: Type, at: Span) -> Option<Typed> {
        if let (ExprKind::Const(x), ExprKind::Const(y)) = (&a.kind, &b.kind) {
            match constant::binary(op, a.ty, x, y) {
                Ok(Some(v)) => return Some(Typed::constant(v, ty, at)),
                Ok(None) => {}
                Err(fault) => return self.constant_fault(fault, ty, at),
            }
        }
        self.sure_division(op, &b)?;
        Some(Typed::of(ExprKind::Binary(op, Box::new(a), Box::new(b)), ty, at))
    }

    /// Reports a division by a literal zero.
    fn sure_division(&mut self, op: BinaryOp, b: &Expr) -> Option<()> {
        let zero = match &b.kind {
            ExprKind::Const(Value::Int(n)) => *n == 0,
            ExprKind::Const(Value::Real(x)) => *x == 0.0,
            _ => false,
        };
        if zero && matches!(op, BinaryOp::Div | BinaryOp::Mod) {
            return self.constant_fault(constant::Fault::Division, b.ty, b.at);
        }
        Some(())
    }

    pub(super) fn wrong_operands<T>(&mut self, sign: Sign, a: &Typed, b: &Typed, at: Span) -> Option<T> {
        let name = |t: &Typed| match t.value() {
            Some(Value::Real(_)) if t.literal => say!("a real number"),
            Some(_) if t.literal => say!("a whole number"),
            _ => Said::foreign(t.expr.ty.to_string()),
        };
        let what = say!("`{}` cannot stand between {} and {}", sign.row().sign, name(a), name(b));
        let problem = Problem::new(&codes::WRONG_OPERANDS, at, what);
        self.report(match help(sign, a, b) {
            Some(h) => problem.help(h),
            None => problem,
        })
    }
}

/// The type in which two values are compared or added.
fn meeting(a: &Typed, b: &Typed) -> Option<Type> {
    let (literal, other) = match (a.literal, b.literal) {
        (true, _) => (a, b.expr.ty),
        (_, true) => (b, a.expr.ty),
        _ => return common(a.expr.ty, b.expr.ty),
    };
    match literal.value()? {
        Value::Int(_) if other.is_number() || other.is_bits() || other == Type::Bool => Some(other),
        Value::Real(_) if other.is_integer() => common(other, Type::Real),
        Value::Real(_) if other.is_real() => Some(other),
        _ => None,
    }
}

fn help(sign: Sign, a: &Typed, b: &Typed) -> Option<Said> {
    let has = |ty: Type| [a, b].iter().any(|t| !t.literal && t.expr.ty == ty);
    let numbers = [a, b].iter().all(|t| t.literal || t.expr.ty.is_number());
    if [a, b].iter().any(|t| t.expr.ty.is_moment()) {
        return Some(say!(
            "a duration is added to or taken from a TOD or a DT; the difference of two values of one type is a duration"
        ));
    }
    if has(Type::Time) && (a.literal || b.literal) {
        return Some(say!("write a duration, as in `5s`"));
    }
    match sign {
        Sign::Dot if numbers => Some(say!("`·` is AND; a product of numbers is written `*`")),
        Sign::Or | Sign::Xor | Sign::And if numbers => {
            Some(say!("it joins conditions; compare each number first"))
        }
        Sign::Mod if a.expr.ty.is_real() || b.expr.ty.is_real() => Some(say!("`mod` is for whole numbers")),
        Sign::Div if a.literal && b.expr.ty == Type::Bool => Some(say!("a delay has its unit: `5s/X1`")),
        _ if numbers => {
            let long = if has(Type::Lint) { Type::Lint } else { Type::Ulint };
            let other = if a.expr.ty == long { b.expr.ty } else { a.expr.ty };
            Some(say!("convert one of them, as in `{long}_TO_{other}(…)`"))
        }
        _ => None,
    }
}
