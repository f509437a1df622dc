//! Bit strings: what is computed bit by bit, and single bits of a word.
//!
//! A bit of a variable has no memory of its own. It is read through a mask, and to assign it
//! assigns the whole variable.

use g7_engine::Builtin;
use g7_model::{BinaryOp as Sign, Problem, Span, Type, codes, say};

use super::constant::transferred;
use super::made::constant;
use super::resolver::Resolver;
use super::types::{Typed, common, converted};
use crate::ir::{BinaryOp, Expr, ExprKind, StmtKind, Target, Value, VarClass, VarId};

/// A bit string with all bits set.
fn all(ty: Type) -> i128 {
    ty.bounds().map_or(0, |(_, most)| most)
}

/// Two bit strings of one type, bit by bit; constants are computed at once.
pub(super) fn joined(f: Builtin, a: Expr, b: Expr, at: Span) -> Expr {
    let ty = a.ty;
    if let (ExprKind::Const(Value::Int(x)), ExprKind::Const(Value::Int(y))) = (&a.kind, &b.kind) {
        let n = match f {
            Builtin::BitAnd => x & y,
            Builtin::BitOr => x | y,
            _ => x ^ y,
        };
        return constant(n, ty, at);
    }
    Expr { kind: ExprKind::Builtin(f, vec![a, b]), ty, at }
}

/// `not` of a bit string: each bit complemented.
pub(super) fn complement(e: Expr, at: Span) -> Typed {
    let every = constant(all(e.ty), e.ty, at);
    Typed { expr: joined(Builtin::BitXor, e, every, at), literal: false }
}

/// The type itself if it is a bit string; for an unsigned integer type the bit string of its bits.
fn string_of(ty: Type) -> Option<Type> {
    let unsigned = ty.bounds().is_some_and(|(least, _)| least == 0);
    if ty.is_bits() { Some(ty) } else { ty.bit_string().filter(|_| unsigned) }
}

/// True if a logical operator between the two works bit by bit.
pub(super) fn are_joined(a: &Typed, b: &Typed) -> bool {
    [a, b].iter().any(|t| !t.literal && t.expr.ty.is_bits())
}

/// A bit string as the number that it stands for in arithmetic.
pub(super) fn as_number(t: Typed) -> Typed {
    match t.expr.ty.unsigned() {
        Some(number) if !t.literal => Typed { expr: converted(t.expr, number), literal: false },
        _ => t,
    }
}

/// A bit string in which this bit alone is set.
fn mask(ty: Type, bit: u8) -> Expr {
    constant(1 << bit, ty, Span::default())
}

impl Resolver<'_, '_> {
    /// `and`, `or` and `xor` where an operand is a bit string.
    pub(super) fn bitwise(&mut self, sign: Sign, a: Typed, b: Typed, at: Span) -> Option<Typed> {
        let f = match sign {
            Sign::And => Builtin::BitAnd,
            Sign::Or => Builtin::BitOr,
            Sign::Xor => Builtin::BitXor,
            _ => return self.wrong_operands(sign, &a, &b, at),
        };
        let whole = |t: &Typed| t.literal && matches!(t.value(), Some(Value::Int(_)));
        let ty = match (whole(&a), whole(&b)) {
            (true, _) => Some(b.expr.ty),
            (_, true) => Some(a.expr.ty),
            _ => string_of(a.expr.ty).and_then(|x| common(x, string_of(b.expr.ty)?)),
        };
        let Some(ty) = ty.filter(|ty| ty.is_bits()) else { return self.wrong_operands(sign, &a, &b, at) };
        let (a, b) = (self.coerce(a, ty), self.coerce(b, ty));
        Some(Typed { expr: joined(f, a?, b?, at), literal: false })
    }

    /// The number of a bit of a variable of this type, if a name is one.
    pub(super) fn bit_number(name: &str, ty: Type) -> Option<u8> {
        let digits = !name.is_empty() && name.bytes().all(|b| b.is_ascii_digit());
        let numbered = ty.is_bits() || ty.is_integer();
        // A number that is too large for the type is told where the bit is used.
        (digits && numbered).then(|| name.parse().unwrap_or(u8::MAX))
    }

    /// The type of a variable and its bit string, if it has the bit; reports a problem if not.
    fn with_bit(&mut self, v: VarId, bit: u8, at: Span) -> Option<(Type, Type)> {
        let (ty, name) = self.var(v).map(|v| (v.ty, v.name.clone()))?;
        let string = if ty.is_bits() { ty } else { ty.bit_string()? };
        let count = string.elementary()?.bits;
        if bit < count {
            return Some((ty, string));
        }
        let what = say!("`{name}` is {ty}: its bits go from 0 to {}", count - 1);
        self.report(Problem::new(&codes::OUT_OF_RANGE, at, what))
    }

    /// `w.3`, a BOOL.
    pub(super) fn bit_of(&mut self, v: VarId, bit: u8, at: Span) -> Option<Typed> {
        let (ty, string) = self.with_bit(v, bit, at)?;
        let var = self.var(v)?;
        let whole = match (var.class, &var.init) {
            (VarClass::Const, Value::Int(n)) => constant(*n, ty, at),
            _ => Expr { kind: ExprKind::Var(v), ty, at },
        };
        let bits = self.in_bits(whole, string);
        let one = joined(Builtin::BitAnd, bits, mask(string, bit), at);
        let zero = constant(0, string, at);
        self.finish(BinaryOp::Ne, one, zero, Type::Bool, at)
    }

    /// A whole number as its bits; a bit string stays as it is.
    fn in_bits(&self, e: Expr, string: Type) -> Expr {
        match (&e.kind, e.ty) {
            (_, ty) if ty == string => e,
            (ExprKind::Const(Value::Int(n)), _) => constant(transferred(*n, string), string, e.at),
            _ => converted(e, string),
        }
    }

    /// `w.3 := b`: the variable with this bit replaced.
    pub(super) fn assign_bit(&mut self, v: VarId, bit: u8, value: Expr, at: Span) -> Option<StmtKind> {
        let (ty, string) = self.with_bit(v, bit, at)?;
        let class = self.var(v).map(|v| v.class)?;
        self.may_write(v, class, at)?;
        let bits = self.in_bits(Expr { kind: ExprKind::Var(v), ty, at }, string);
        let one = mask(string, bit);
        let others = constant(all(string) ^ (1 << bit), string, at);
        let set = joined(Builtin::BitOr, bits.clone(), one, at);
        let reset = joined(Builtin::BitAnd, bits, others, at);
        let chosen = match value.kind {
            ExprKind::Const(Value::Bool(true)) => set,
            ExprKind::Const(Value::Bool(false)) => reset,
            _ => Expr { kind: ExprKind::Builtin(Builtin::Sel, vec![value, reset, set]), ty: string, at },
        };
        let chosen = if ty == string { chosen } else { converted(chosen, ty) };
        Some(StmtKind::Assign(Target::Var(v), chosen))
    }

    /// Reports a bit where only a whole variable can be written.
    pub(super) fn no_bit_here<T>(&mut self, v: VarId, bit: u8, at: Span) -> Option<T> {
        let name = self.var(v).map(|v| v.name.clone())?;
        let what = say!("bit {bit} of `{name}` cannot be written here");
        self.report(
            Problem::new(&codes::NOT_WRITABLE, at, what).help(say!(
                "an assignment writes a bit: `{name}.{bit} := …`; a continuous action needs a BOOL"
            )),
        )
    }
}
