//! Bit strings and the bits of numbers, worked out one bit at a time (IEC 61131-3:2013, 6.4.2.1, 6.6.2.5.4,
//! 6.6.2.5.8).

use g7_model::{BinaryOp, Type};

use super::value::{NaiveFault, Run, Typed, Value, bad, common};

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

/// `WORD_BCD_TO_UINT` and `UINT_TO_BCD_WORD`, if the name is one of these: digit by digit (IEC 61131-3:2003, table 22).
pub(super) fn decimal(name: &str, x: &Typed) -> Option<Run<Typed>> {
    let named = |name: &str| Type::named(name.trim_matches('_'));
    if let Some((from, to)) = name.split_once("BCD_TO_") {
        let (from, to) = (named(from).or(x.ty)?, named(to)?);
        let digits = |n: i128| (0..width(from) / 4).rev().map(move |k| (n >> (4 * k)) % 16);
        return Some(x.to(from).and_then(|v| {
            let Value::Int(n) = v else { return bad("digits of no number") };
            let value = digits(n).fold(0, |all, digit| 10 * all + digit);
            let fits = to.bounds().is_some_and(|(_, most)| value <= most);
            let right = fits && digits(n).all(|digit| digit < 10);
            if right { Ok(Typed::of(to, Value::Int(value))) } else { Err(NaiveFault::Index) }
        }));
    }
    let (from, to) = name.split_once("_TO_BCD")?;
    let from = named(from)?;
    let to = named(to).or(from.bit_string())?;
    Some(x.to(from).and_then(|v| {
        let Value::Int(mut rest) = v else { return bad("digits of no number") };
        let (mut all, mut place) = (0, 0);
        while rest > 0 {
            all += (rest % 10) << place;
            (rest, place) = (rest / 10, place + 4);
        }
        let right = rest == 0 && place <= width(to);
        if right { Ok(Typed::of(to, Value::Int(all))) } else { Err(NaiveFault::Index) }
    }))
}
