//! Bit strings and the bits of numbers, worked out one bit at a time (IEC 61131-3:2013, 6.4.2.1, 6.6.2.5.4,
//! 6.6.2.5.8).

use g7_model::{BinaryOp, Type};

use super::value::{Run, Typed, Value, bad, common};

/// The number of bits of a type.
pub(super) fn width(ty: Type) -> u32 {
    ty.elementary().map_or(0, |row| row.bits.into())
}

/// The bit of this number; negative numbers are in two's complement.
pub(super) fn bit(n: i128, k: u32) -> bool {
    n.div_euclid(1 << k).rem_euclid(2) == 1
}

/// The number of a type with these bits, the lowest first.
fn number(ty: Type, bits: impl Fn(u32) -> bool) -> i128 {
    let top = width(ty) - 1;
    let signed = ty.bounds().is_some_and(|(least, _)| least < 0);
    let value = |k: u32| if signed && k == top { -(1i128 << k) } else { 1 << k };
    (0..=top).filter(|k| bits(*k)).map(value).sum()
}

/// The bits of a number as those of another type.
pub(super) fn transferred(n: i128, to: Type) -> i128 {
    number(to, |k| bit(n, k))
}

/// A number of the type with one bit replaced.
pub(super) fn replaced(ty: Type, n: i128, at: u32, on: bool) -> i128 {
    number(ty, |k| if k == at { on } else { bit(n, k) })
}

/// AND, OR and XOR, if an operand is a bit string.
pub(super) fn joined(op: BinaryOp, a: &Typed, b: &Typed) -> Option<Run<Typed>> {
    let strings = [a, b].iter().any(|t| t.ty.is_some_and(Type::is_bits));
    let logical = matches!(op, BinaryOp::And | BinaryOp::Or | BinaryOp::Xor);
    (strings && logical).then(|| {
        let string = |ty: Type| ty.bit_string().unwrap_or(ty);
        let Some(ty) = common(a, b)?.map(string) else { return bad("bit strings without a type") };
        let (Value::Int(x), Value::Int(y)) = (a.to(ty)?, b.to(ty)?) else { return bad("bits of no number") };
        let n = number(ty, |k| match op {
            BinaryOp::And => bit(x, k) && bit(y, k),
            BinaryOp::Or => bit(x, k) || bit(y, k),
            _ => bit(x, k) != bit(y, k),
        });
        Ok(Typed::of(ty, Value::Int(n)))
    })
}

/// NOT of a bit string.
pub(super) fn complement(x: &Typed) -> Option<Run<Typed>> {
    let ty = x.ty.filter(|ty| ty.is_bits())?;
    Some(x.whole().map(|n| Typed::of(ty, Value::Int(number(ty, |k| !bit(n, k))))))
}
