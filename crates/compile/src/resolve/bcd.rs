//! Numbers in binary-coded decimal: `WORD_BCD_TO_UINT`, `UINT_TO_BCD_WORD` and the forms without the bit string.
//!
//! A conversion is a function that is made at its first call (decision 57).

use g7_engine::Builtin;
use g7_model::{Arg, Name, Problem, Span, Type, codes, say};

use super::bits;
use super::made::{binary, compare, constant, unless};
use super::resolver::Resolver;
use super::types::{Typed, converted};
use crate::ir::{BinaryOp, Expr, ExprKind, Value, VarId};

/// A conversion by its name. Where the name leaves the bit string out, the argument or the place of the result tells it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Bcd {
    /// `BYTE_BCD_TO_INT`, `BCD_TO_INT`.
    From(Option<Type>, Type),
    /// `INT_TO_BCD_BYTE`, `INT_TO_BCD`.
    To(Type, Option<Type>),
}

impl Bcd {
    /// The conversion of this name, in upper or lower case (IEC 61131-3:2003, table 22).
    pub(super) fn named(name: &str) -> Option<Bcd> {
        let upper = name.to_ascii_uppercase();
        let bits = |name: &str| Type::named(name).filter(|ty| ty.is_bits());
        let number = |name: &str| Type::named(name).filter(|ty| ty.is_integer());
        if let Some((from, to)) = upper.split_once("BCD_TO_") {
            let from = match from {
                "" => None,
                _ => Some(bits(from.strip_suffix('_')?)?),
            };
            return Some(Bcd::From(from, number(to)?));
        }
        let (from, to) = upper.split_once("_TO_BCD")?;
        let to = match to {
            "" => None,
            _ => Some(bits(to.strip_prefix('_')?)?),
        };
        Some(Bcd::To(number(from)?, to))
    }
}

/// Decimal digits that a bit string has room for.
fn digits(bits: Type) -> u32 {
    bits.elementary().map_or(0, |row| u32::from(row.bits) / 4)
}

/// The largest number of so many digits.
fn largest(digits: u32) -> i128 {
    10i128.pow(digits) - 1
}

/// The number that a bit string stands for; `None` where a digit is over 9.
fn decoded(bits: i128, digits: u32) -> Option<i128> {
    (0..digits).rev().try_fold(0, |number, k| {
        let digit = (bits >> (4 * k)) & 15;
        (digit <= 9).then_some(10 * number + digit)
    })
}

/// The digits of a number that is not negative, four bits each.
fn encoded(number: i128, digits: u32) -> i128 {
    (0..digits).map(|k| number / 10i128.pow(k) % 10 * (1 << (4 * k))).sum()
}

impl Resolver<'_, '_> {
    /// A call of a conversion.
    #[inline(never)]
    pub(super) fn call_bcd(
        &mut self,
        bcd: Bcd,
        name: &Name,
        args: &[Arg],
        hint: Option<Type>,
        at: Span,
    ) -> Option<Typed> {
        let arg = self.only_argument(name, args, at)?;
        let (bits, number, value) = match bcd {
            Bcd::From(Some(bits), number) => (bits, number, self.value(&arg.value, bits)?),
            Bcd::From(None, number) => {
                let typed = self.infer(&arg.value, None)?;
                let bits = match typed.expr.ty {
                    _ if typed.literal => Type::Lword,
                    ty if ty.is_bits() => ty,
                    ty => {
                        let what = say!("`{}` takes a bit string, this is {ty}", name.text);
                        return self.report(Problem::new(&codes::WRONG_TYPE, typed.expr.at, what));
                    }
                };
                (bits, number, self.coerce(typed, bits)?)
            }
            Bcd::To(number, bits) => {
                let wanted = bits.or(hint.filter(|ty| ty.is_bits()));
                (wanted.or(number.bit_string())?, number, self.value(&arg.value, number)?)
            }
        };
        let decodes = matches!(bcd, Bcd::From(..));
        let result = if decodes { number } else { bits };
        if let ExprKind::Const(Value::Int(n)) = &value.kind {
            let count = digits(bits);
            let known = if decodes {
                decoded(*n, count).filter(|v| number.bounds().is_some_and(|(_, most)| *v <= most))
            } else {
                (0..=largest(count)).contains(n).then(|| encoded(*n, count))
            };
            return match known {
                Some(v) => Some(Typed::constant(Value::Int(v), result, at)),
                None if decodes => {
                    let what = say!("these bits are no decimal digits of {number}");
                    self.report(Problem::new(&codes::CONSTANT_FAULT, at, what))
                }
                None => {
                    let what = say!("{bits} has {count} decimal digits and no sign");
                    self.report(Problem::new(&codes::CONSTANT_FAULT, at, what))
                }
            };
        }
        let (from, to) = if decodes { (bits, number) } else { (number, bits) };
        let full = if decodes { format!("@{from}_BCD_TO_{to}") } else { format!("@{from}_TO_BCD_{to}") };
        let function = self.made(&full, (from, to), at, |r, input, result| {
            let counter = bits.unsigned().unwrap_or(Type::Ulint);
            let work = r.local(&format!("{full}.n"), counter, at);
            let make = Make { bits, counter, at };
            if decodes {
                make.decoded(number, (input, work, result))
            } else {
                make.encoded(number, (input, work, result))
            }
        });
        Some(Typed::of(ExprKind::Call(function, vec![value]), result, at))
    }
}

/// Makes expressions of one conversion.
struct Make {
    /// The bit string.
    bits: Type,
    /// The whole type without a sign that has its bits.
    counter: Type,
    at: Span,
}

impl Make {
    /// How two halves become one number: the mask of the high halves behind the shift, the shift, and what is too much in
    /// each of them. First digits are joined in pairs (6 = 16 - 10), then pairs (156 = 256 - 100), and so on.
    fn steps(&self) -> Vec<(i128, u32, i128)> {
        let width = 4 * digits(self.bits);
        let mut steps = Vec::new();
        let mut half = 4;
        while half < width {
            let low = (1i128 << half) - 1;
            let mask = (0..width / (2 * half)).map(|k| low << (2 * half * k)).sum();
            steps.push((mask, half, (1i128 << half) - 10i128.pow(half / 4)));
            half *= 2;
        }
        steps
    }

    /// The assignments of the conversion to a number, by the input, a variable of its own and the result.
    fn decoded(&self, number: Type, (input, work, result): (VarId, VarId, VarId)) -> Vec<(VarId, Expr)> {
        let (bits, counter, at) = (self.bits, self.counter, self.at);
        let n = || self.read(work, counter);
        let mut list = vec![(work, converted(self.read(input, bits), counter))];
        for (mask, shift, weight) in self.steps() {
            let high = self.and(self.shifted(Builtin::Shr, converted(n(), bits), shift), mask);
            let surplus = self.arith(BinaryOp::Mul, converted(high, counter), weight);
            list.push((work, binary(BinaryOp::Sub, n(), surplus, counter, at)));
        }
        let mut wrong = self.digit_over_nine(self.read(input, bits));
        let most = number.bounds().map_or(0, |(_, most)| most);
        if most < largest(digits(bits)) {
            wrong = binary(BinaryOp::Or, wrong, compare(BinaryOp::Gt, n(), most, at), Type::Bool, at);
        }
        list.push((result, converted(converted(unless(wrong, n(), at), bits), number)));
        list
    }

    /// The assignments of the conversion to decimal digits.
    fn encoded(&self, number: Type, (input, work, result): (VarId, VarId, VarId)) -> Vec<(VarId, Expr)> {
        let (bits, counter, at, count) = (self.bits, self.counter, self.at, digits(self.bits));
        let (least, most) = number.bounds().unwrap_or((0, 0));
        let given = || self.read(input, number);
        let negative = (least < 0).then(|| compare(BinaryOp::Lt, given(), 0, at));
        let large = (most > largest(count)).then(|| compare(BinaryOp::Gt, given(), largest(count), at));
        let plain = converted(converted(given(), bits), counter);
        let right = match (negative, large) {
            (Some(a), Some(b)) => unless(binary(BinaryOp::Or, a, b, Type::Bool, at), plain, at),
            (Some(one), None) | (None, Some(one)) => unless(one, plain, at),
            (None, None) => plain,
        };
        // A digit weighs 16 in place of 10: each ten of the number adds 6, each hundred 96, and so on.
        let mut all = self.read(work, counter);
        for k in 1..count {
            let times = self.arith(BinaryOp::Div, self.read(work, counter), 10i128.pow(k));
            let more = self.arith(BinaryOp::Mul, times, 6 * (1 << (4 * (k - 1))));
            all = binary(BinaryOp::Add, all, more, counter, at);
        }
        vec![(work, right), (result, converted(all, bits))]
    }

    fn read(&self, v: VarId, ty: Type) -> Expr {
        Expr { kind: ExprKind::Var(v), ty, at: self.at }
    }

    fn arith(&self, op: BinaryOp, a: Expr, n: i128) -> Expr {
        binary(op, a, constant(n, self.counter, self.at), self.counter, self.at)
    }

    fn shifted(&self, function: Builtin, value: Expr, by: u32) -> Expr {
        let args = vec![value, constant(i128::from(by), Type::Lint, self.at)];
        Expr { kind: ExprKind::Builtin(function, args), ty: self.bits, at: self.at }
    }

    fn and(&self, value: Expr, mask: i128) -> Expr {
        bits::joined(Builtin::BitAnd, value, constant(mask, self.bits, self.at), self.at)
    }

    /// True if the bit of 8 of some digit is set together with that of 4 or of 2.
    fn digit_over_nine(&self, value: Expr) -> Expr {
        let eights = (0..digits(self.bits)).map(|k| 8i128 << (4 * k)).sum();
        let four = self.shifted(Builtin::Shl, value.clone(), 1);
        let two = self.shifted(Builtin::Shl, value.clone(), 2);
        let lower = bits::joined(Builtin::BitOr, four, two, self.at);
        let both = bits::joined(Builtin::BitAnd, value, lower, self.at);
        compare(BinaryOp::Ne, self.and(both, eights), 0, self.at)
    }
}

#[cfg(test)]
mod tests {
    use super::{Bcd, Type, decoded, encoded, largest};

    #[test]
    fn a_conversion_is_known_by_its_name() {
        // IEC 61131-3:2003, table 22: `*_BCD_TO_**`, `**_TO_BCD_*`.
        let names = [
            ("WORD_BCD_TO_UINT", Some(Bcd::From(Some(Type::Word), Type::Uint))),
            ("bcd_to_int", Some(Bcd::From(None, Type::Int))),
            ("UINT_TO_BCD_WORD", Some(Bcd::To(Type::Uint, Some(Type::Word)))),
            ("INT_TO_BCD", Some(Bcd::To(Type::Int, None))),
            ("INT_BCD_TO_INT", None),
            ("WORDBCD_TO_INT", None),
            ("REAL_TO_BCD", None),
            ("INT_TO_BCDWORD", None),
        ];
        for (name, wanted) in names {
            assert_eq!(Bcd::named(name), wanted, "{name}");
        }
    }

    #[test]
    fn digits_are_four_bits_each() {
        for (number, bits) in [(0, 0), (9, 9), (10, 0x10), (1987, 0x1987), (9999, 0x9999)] {
            assert_eq!((encoded(number, 4), decoded(bits, 4)), (bits, Some(number)));
        }
        assert_eq!((decoded(0x1A, 2), decoded(0xA1, 2), largest(16)), (None, None, 9_999_999_999_999_999));
    }
}
