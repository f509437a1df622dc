//! Numbers in binary-coded decimal: `WORD_BCD_TO_UINT`, `UINT_TO_BCD_WORD` and the forms without the bit string.
//!
//! A conversion is a function of the chart that is made at its first call (decision 57), so that no later stage knows of it.

use g7_engine::Builtin;
use g7_model::{Arg, Name, Problem, Span, Type, codes, say};

use super::bits;
use super::resolver::Resolver;
use super::types::{Typed, converted};
use crate::ir::{
    BinaryOp, Expr, ExprKind, Function, FunctionId, Stmt, StmtKind, Target, Value, VarClass, VarId,
};

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
        let full = if decodes { format!("{from}_BCD_TO_{to}") } else { format!("{from}_TO_BCD_{to}") };
        let made = self.unit.functions.iter().position(|f| *f.name == *full);
        let function = match made {
            Some(known) => FunctionId(known as u32),
            None => self.make(&full, bits, number, decodes, at)?,
        };
        Some(Typed::of(ExprKind::Call(function, vec![value]), result, at))
    }

    /// Adds the function of a conversion.
    fn make(&mut self, name: &str, bits: Type, number: Type, decodes: bool, at: Span) -> Option<FunctionId> {
        let id = FunctionId(self.unit.functions.len() as u32);
        let (from, to) = if decodes { (bits, number) } else { (number, bits) };
        let counter = bits.unsigned()?;
        let input = self.add_var(format!("{name}.IN").into(), VarClass::Local, from, at);
        let work = self.add_var(format!("{name}.n").into(), VarClass::Local, counter, at);
        let result = self.add_var(name.into(), VarClass::Local, to, at);
        let make = Make { bits, counter, at };
        let mut statements = Vec::new();
        let mut assign = |target: VarId, value: Expr| {
            statements.push(Stmt { kind: StmtKind::Assign(Target::Var(target), value), at });
        };
        let count = digits(bits);
        let read = |v: VarId, ty: Type| Expr { kind: ExprKind::Var(v), ty, at };
        let n = || read(work, counter);
        if decodes {
            assign(work, converted(read(input, bits), counter));
            for (mask, shift, weight) in make.steps() {
                let high = make.and(make.shifted(Builtin::Shr, converted(n(), bits), shift), mask);
                let surplus = make.arith(BinaryOp::Mul, converted(high, counter), weight);
                assign(work, make.binary(BinaryOp::Sub, n(), surplus, counter));
            }
            let mut wrong = make.digit_over_nine(read(input, bits));
            let most = number.bounds().map_or(0, |(_, most)| most);
            if most < largest(count) {
                let large = make.compare(BinaryOp::Gt, n(), most);
                wrong = make.binary(BinaryOp::Or, wrong, large, Type::Bool);
            }
            let right = make.unless(wrong, n());
            assign(result, converted(converted(right, bits), number));
        } else {
            let (least, most) = number.bounds()?;
            let given = || read(input, number);
            let negative = (least < 0).then(|| make.compare(BinaryOp::Lt, given(), 0));
            let large = (most > largest(count)).then(|| make.compare(BinaryOp::Gt, given(), largest(count)));
            let plain = converted(converted(given(), bits), counter);
            let right = match (negative, large) {
                (Some(a), Some(b)) => make.unless(make.binary(BinaryOp::Or, a, b, Type::Bool), plain),
                (Some(one), None) | (None, Some(one)) => make.unless(one, plain),
                (None, None) => plain,
            };
            assign(work, right);
            // A digit weighs 16 in place of 10: each ten of the number adds 6, each hundred 96, and so on.
            let mut all = n();
            for k in 1..count {
                let times = make.arith(BinaryOp::Div, n(), 10i128.pow(k));
                let more = make.arith(BinaryOp::Mul, times, 6 * (1 << (4 * (k - 1))));
                all = make.binary(BinaryOp::Add, all, more, counter);
            }
            assign(result, converted(all, bits));
        }
        self.scopes.params.push(vec!["IN"]);
        self.unit.functions.push(Function { name: name.into(), params: vec![input], result, statements, at });
        Some(id)
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

    fn constant(&self, n: i128, ty: Type) -> Expr {
        bits::constant(n, ty, self.at)
    }

    fn binary(&self, op: BinaryOp, a: Expr, b: Expr, ty: Type) -> Expr {
        Expr { kind: ExprKind::Binary(op, Box::new(a), Box::new(b)), ty, at: self.at }
    }

    fn arith(&self, op: BinaryOp, a: Expr, n: i128) -> Expr {
        self.binary(op, a, self.constant(n, self.counter), self.counter)
    }

    fn compare(&self, op: BinaryOp, a: Expr, n: i128) -> Expr {
        let ty = a.ty;
        self.binary(op, a, self.constant(n, ty), Type::Bool)
    }

    fn shifted(&self, function: Builtin, value: Expr, by: u32) -> Expr {
        let args = vec![value, self.constant(i128::from(by), Type::Lint)];
        Expr { kind: ExprKind::Builtin(function, args), ty: self.bits, at: self.at }
    }

    fn and(&self, value: Expr, mask: i128) -> Expr {
        bits::joined(Builtin::BitAnd, value, self.constant(mask, self.bits), self.at)
    }

    /// True if the bit of 8 of some digit is set together with that of 4 or of 2.
    fn digit_over_nine(&self, value: Expr) -> Expr {
        let eights = (0..digits(self.bits)).map(|k| 8i128 << (4 * k)).sum();
        let four = self.shifted(Builtin::Shl, value.clone(), 1);
        let two = self.shifted(Builtin::Shl, value.clone(), 2);
        let lower = bits::joined(Builtin::BitOr, four, two, self.at);
        let both = bits::joined(Builtin::BitAnd, value, lower, self.at);
        self.compare(BinaryOp::Ne, self.and(both, eights), 0)
    }

    /// The value, or the fault `range`: of the inputs 0 and 1 of this MUX the third is chosen.
    fn unless(&self, wrong: Expr, value: Expr) -> Expr {
        let long = |n: i128| self.constant(n, Type::Lint);
        let choice = Expr {
            kind: ExprKind::Builtin(Builtin::Sel, vec![wrong, long(0), long(2)]),
            ty: Type::Lint,
            at: self.at,
        };
        let (ty, zero) = (value.ty, self.constant(0, value.ty));
        Expr { kind: ExprKind::Builtin(Builtin::Mux, vec![choice, value, zero]), ty, at: self.at }
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
