//! Expressions as bits: the same values as `equations::Machine` gives them.

use g7_compile::tree::transfers;
use g7_engine::{Arith, Builtin, Cmp, number};
use g7_equations::{Expr, MemoryId};
use g7_model::Type;

use super::exec::Exec;
use super::range::{bounds, is_whole};
use super::value::{Value, choose, compare, num, real_bits, same};
use super::word::{self, Word};
use crate::reason::Part;
use crate::sat::Signal;

/// Most bits of two factors together.
const FACTORS: usize = 80;
/// Most bits of a dividend, and of a divisor that is not constant.
const DIVIDED: [usize; 2] = [66, 34];

/// A value, or why bits do not give it.
type Made<T> = Result<T, Part>;

impl Exec<'_> {
    /// A truth value.
    pub(crate) fn truth(&mut self, e: &Expr) -> Signal {
        let w = self.eval(e).whole();
        word::is_true(self.g(), &w)
    }

    /// The value of an expression; of a table, that of its first element.
    pub(crate) fn eval(&mut self, e: &Expr) -> Value {
        match e {
            Expr::Const(ty, v) => Value::of_word(*ty, *v),
            Expr::Text(t) => Value::Text(Some(t.as_bytes().into())),
            Expr::Read(m) => self.cell(*m).first().cloned().unwrap_or(Value::Whole(Word::constant(0))),
            Expr::Element(m, index) => self.element(*m, index),
            Expr::Not(x) => Value::truth(!self.truth(x)),
            Expr::And(list) => {
                let list: Vec<Signal> = list.iter().map(|x| self.truth(x)).collect();
                Value::truth(self.g().all(list))
            }
            Expr::Or(list) => {
                let list: Vec<Signal> = list.iter().map(|x| self.truth(x)).collect();
                Value::truth(self.g().any(list))
            }
            Expr::Xor(a, b) => {
                let (a, b) = (self.truth(a), self.truth(b));
                Value::truth(self.g().xor(a, b))
            }
            Expr::Compare(c, _, a, b) => {
                let (a, b) = (self.eval(a), self.eval(b));
                Value::truth(self.compared(*c, &a, &b))
            }
            Expr::Differs(_, a, b) => Value::truth(self.differs(a, b)),
            Expr::Random(seed) => match self.eval(seed).known() {
                Some(seed) => Value::of_word(Type::Lreal, number::random(seed)),
                None => self.unknown(Type::Lreal, Part::Random),
            },
            Expr::Fails(x) => Value::truth(self.operate(x).1),
            Expr::Neg(..) | Expr::Arith(..) | Expr::Convert(..) | Expr::Trunc(..) | Expr::Call(..) => {
                self.operate(e).0
            }
        }
    }

    fn compared(&mut self, c: Cmp, a: &Value, b: &Value) -> Signal {
        match (a, b) {
            (Value::Text(Some(a)), Value::Text(Some(b))) => number::ordered(c, Some(a.cmp(b))).into(),
            (Value::Text(_), _) | (_, Value::Text(_)) => {
                self.unknown(Type::Bool, Part::Texts).whole().bits().first().copied().unwrap_or(Signal::FALSE)
            }
            _ => compare(self.g(), c, a, b),
        }
    }

    fn differs(&mut self, a: &Expr, b: &Expr) -> Signal {
        let list = |x: &mut Self, e: &Expr| match e {
            Expr::Read(m) => x.cell(*m).to_vec(),
            _ => vec![x.eval(e)],
        };
        let (a, b) = (list(self, a), list(self, b));
        let mut equal = Vec::new();
        for (a, b) in a.iter().zip(&b) {
            let is_text = matches!((a, b), (Value::Text(a), Value::Text(b)) if a.is_none() || b.is_none());
            equal.push(if is_text { !self.compared(Cmp::Ne, a, b) } else { same(self.g(), a, b) });
        }
        !self.g().all(equal)
    }

    fn element(&mut self, m: MemoryId, index: &Expr) -> Value {
        let index = self.eval(index).whole();
        let cell = self.cell(m).to_vec();
        if let Some(k) = index.known() {
            let found = usize::try_from(k).ok().and_then(|k| cell.get(k));
            return found.cloned().unwrap_or_else(|| self.zero_of(m));
        }
        let mut value = self.zero_of(m);
        for (k, element) in cell.iter().enumerate() {
            let here = word::equal(self.g(), &index, &Word::constant(k as i128));
            value = choose(self.g(), here, element, &value);
        }
        value
    }

    fn zero_of(&self, m: MemoryId) -> Value {
        Value::zero(self.e.memory(m).map_or(Type::Bool, |m| m.ty))
    }

    /// The value of an operation, and 1 where it has none; then the value is that of the form.
    pub(crate) fn operate(&mut self, e: &Expr) -> (Value, Signal) {
        let ty = match e {
            Expr::Neg(ty, _)
            | Expr::Arith(_, ty, ..)
            | Expr::Convert(_, ty, _)
            | Expr::Trunc(_, ty, _)
            | Expr::Call(_, ty, _) => *ty,
            _ => return (self.eval(e), Signal::FALSE),
        };
        let args: Vec<Value> = match e {
            Expr::Neg(_, a) | Expr::Convert(_, _, a) | Expr::Trunc(_, _, a) => vec![self.eval(a)],
            Expr::Arith(_, _, a, b) => vec![self.eval(a), self.eval(b)],
            Expr::Call(_, _, list) => list.iter().map(|a| self.eval(a)).collect(),
            _ => Vec::new(),
        };
        match self.operation(e, ty, &args) {
            Ok(done) => done,
            Err(why) => {
                let value = self.unknown(ty, why);
                let fails = self.unknown(Type::Bool, why).whole();
                (value, word::is_true(self.g(), &fails))
            }
        }
    }

    fn operation(&mut self, e: &Expr, ty: Type, args: &[Value]) -> Made<(Value, Signal)> {
        if let Some(done) = folded(e, ty, args) {
            return Ok(done);
        }
        let sure = |v| Ok((v, Signal::FALSE));
        match (e, args) {
            (Expr::Neg(..), [Value::Real(bits)]) => {
                let mut bits = bits.clone();
                bits.last_mut().into_iter().for_each(|s| *s = !*s);
                sure(Value::Real(bits))
            }
            (Expr::Neg(..), [Value::Whole(w)]) => {
                let minus = word::sub(self.g(), &Word::constant(0), w);
                Ok(self.fitted(ty, minus, false))
            }
            (Expr::Arith(op, ..), [Value::Whole(a), Value::Whole(b)]) => self.arith(*op, ty, a, b),
            (Expr::Convert(_, Type::Bool, _), [Value::Whole(w)]) => {
                let holds = word::is_true(self.g(), w);
                sure(Value::truth(holds))
            }
            (Expr::Convert(from, to, _), [x])
                if num(*from) == num(*to) && !matches!(from, Type::String(_)) =>
            {
                sure(x.clone())
            }
            (Expr::Convert(from, to, _), [Value::Whole(w)]) if transfers(*from, *to) => {
                sure(self.transferred(*to, w))
            }
            (Expr::Convert(_, to, _), [Value::Whole(w)]) if is_whole(*to) => {
                Ok(self.fitted(*to, w.clone(), false))
            }
            (Expr::Call(f, ..), _) => self.function(*f, ty, args),
            (Expr::Arith(..) | Expr::Neg(..), _) => Err(Part::Floating),
            _ => Err(Part::Conversion),
        }
    }

    /// The number in its type, and 1 where it does not fit; then it is 0, or what the low
    /// bits give.
    fn fitted(&mut self, ty: Type, w: Word, wraps: bool) -> (Value, Signal) {
        let (low, high) = bounds(ty);
        let fits = word::within(self.g(), &w, low, high);
        if fits == Signal::TRUE {
            return (Value::Whole(w), Signal::FALSE);
        }
        let other = if wraps { word::wrapped(self.g(), &w, low < 0) } else { Word::constant(0) };
        let inside = word::clipped(&w, low, high);
        (Value::Whole(word::choose(self.g(), fits, &inside, &other)), !fits)
    }

    fn arith(&mut self, op: Arith, ty: Type, a: &Word, b: &Word) -> Made<(Value, Signal)> {
        let wraps = matches!(ty, Type::Lint | Type::Ulint | Type::Time);
        let (na, nb) = (a.bits().len(), b.bits().len());
        match op {
            Arith::Add => {
                let sum = word::add(self.g(), a, b);
                Ok(self.fitted(ty, sum, wraps))
            }
            Arith::Sub => {
                let difference = word::sub(self.g(), a, b);
                Ok(self.fitted(ty, difference, wraps))
            }
            Arith::Mul => {
                if na + nb > FACTORS && a.known().is_none() && b.known().is_none() || na + nb > 110 {
                    return Err(Part::Product);
                }
                let product = word::mul(self.g(), a, b);
                Ok(self.fitted(ty, product, wraps))
            }
            Arith::Div | Arith::Mod => {
                if na > DIVIDED[0] || nb > DIVIDED[1] && b.known().is_none() {
                    return Err(Part::Division);
                }
                let by_zero = !word::is_true(self.g(), b);
                let (q, r) = word::divide(self.g(), a, b);
                let (value, over) = self.fitted(ty, if op == Arith::Div { q } else { r }, false);
                Ok((value, self.g().or(over, by_zero)))
            }
            Arith::Pow => Ok((Value::zero(ty), Signal::TRUE)),
        }
    }

    fn function(&mut self, f: Builtin, ty: Type, args: &[Value]) -> Made<(Value, Signal)> {
        let sure = |v| Ok((v, Signal::FALSE));
        match (f, args) {
            (Builtin::Abs, [Value::Real(bits)]) => {
                let mut bits = bits.clone();
                bits.last_mut().into_iter().for_each(|s| *s = Signal::FALSE);
                sure(Value::Real(bits))
            }
            (Builtin::Abs, [Value::Whole(w)]) => {
                let size = word::absolute(self.g(), w);
                Ok(self.fitted(ty, size, false))
            }
            (Builtin::Min | Builtin::Max, [first, rest @ ..]) => {
                let mut value = first.clone();
                for b in rest {
                    let (x, y) = if f == Builtin::Min { (b, &value) } else { (&value, b) };
                    let takes = self.compared(Cmp::Lt, x, y);
                    value = choose(self.g(), takes, b, &value);
                }
                sure(value)
            }
            (Builtin::Limit, [least, v, most]) => {
                let below = self.compared(Cmp::Lt, v, least);
                let low = choose(self.g(), below, least, v);
                let above = self.compared(Cmp::Lt, most, &low);
                sure(choose(self.g(), above, most, &low))
            }
            (Builtin::Sel, [Value::Whole(k), a, b]) => {
                let second = word::is_true(self.g(), k);
                sure(choose(self.g(), second, b, a))
            }
            (Builtin::Mux, [Value::Whole(k), list @ ..]) => {
                let mut value = Value::zero(ty);
                let mut found = Vec::new();
                for (i, v) in list.iter().enumerate() {
                    let here = word::equal(self.g(), k, &Word::constant(i as i128));
                    value = choose(self.g(), here, v, &value);
                    found.push(here);
                }
                let some = self.g().any(found);
                Ok((value, !some))
            }
            (Builtin::BitAnd | Builtin::BitOr | Builtin::BitXor, [Value::Whole(a), Value::Whole(b)]) => {
                sure(self.bitwise(f, ty, a, b))
            }
            (
                Builtin::Shl | Builtin::Shr | Builtin::Rol | Builtin::Ror,
                [Value::Whole(v), Value::Whole(by)],
            ) => Ok(self.shifted(f, ty, v, by)),
            _ => Err(Part::Function(f)),
        }
    }

    /// The lowest bits of a number, as many as the type has.
    fn low_bits(&mut self, ty: Type, w: &Word) -> Vec<Signal> {
        let n = ty.elementary().map_or(64, |row| usize::from(row.bits));
        let wrapped = word::wrapped(self.g(), w, false);
        (0..n).map(|i| wrapped.bits().get(i).copied().unwrap_or(Signal::FALSE)).collect()
    }

    /// The value of a type with these bits.
    fn of_bits(ty: Type, mut bits: Vec<Signal>) -> Value {
        let (low, high) = bounds(ty);
        if low >= 0 {
            bits.push(Signal::FALSE);
        }
        Value::Whole(Word::of(bits, 1, low, high))
    }

    fn transferred(&mut self, to: Type, w: &Word) -> Value {
        let bits = self.low_bits(to, w);
        Self::of_bits(to, bits)
    }

    fn bitwise(&mut self, f: Builtin, ty: Type, a: &Word, b: &Word) -> Value {
        let (a, b) = (self.low_bits(ty, a), self.low_bits(ty, b));
        let bits = a.into_iter().zip(b).map(|(a, b)| match f {
            Builtin::BitAnd => self.g().and(a, b),
            Builtin::BitOr => self.g().or(a, b),
            _ => self.g().xor(a, b),
        });
        let bits = bits.collect();
        Self::of_bits(ty, bits)
    }

    fn shifted(&mut self, f: Builtin, ty: Type, v: &Word, by: &Word) -> (Value, Signal) {
        let n = ty.elementary().map_or(64, |row| usize::from(row.bits));
        let v = word::wrapped(self.g(), v, false);
        let bit =
            |i: usize| if i < n { v.bits().get(i).copied().unwrap_or(Signal::FALSE) } else { Signal::FALSE };
        let shift = |k: usize| {
            let pick = |i: usize| match f {
                Builtin::Shl => i.checked_sub(k).map_or(Signal::FALSE, bit),
                Builtin::Shr => bit(i + k),
                Builtin::Rol => bit((i + n - k % n) % n),
                _ => bit((i + k) % n),
            };
            let mut bits: Vec<Signal> = (0..n).map(pick).collect();
            bits.push(Signal::FALSE);
            Word::of(bits, 1, 0, (1i128 << n) - 1)
        };
        let negative = word::less(self.g(), by, &Word::constant(0));
        let rotates = matches!(f, Builtin::Rol | Builtin::Ror);
        let count =
            if rotates { word::divide(self.g(), by, &Word::constant(n as i128)).1 } else { by.clone() };
        let mut value = Word::constant(0);
        for k in 0..n {
            let here = word::equal(self.g(), &count, &Word::constant(k as i128));
            value = word::choose(self.g(), here, &shift(k), &value);
        }
        (Value::Whole(word::choose(self.g(), negative, &Word::constant(0), &value)), negative)
    }

    /// A value that bits do not give: any of its type.
    pub(crate) fn unknown(&mut self, ty: Type, part: Part) -> Value {
        let n = match ty {
            Type::String(_) => 0,
            Type::Real | Type::Lreal => real_bits(ty),
            _ => ty.elementary().map_or(1, |row| usize::from(row.bits)),
        };
        let bits: Vec<Signal> = (0..n).map(|_| self.system.input()).collect();
        self.note_limit(part, &bits);
        free(ty, bits)
    }
}

/// The value of free bits.
pub(crate) fn free(ty: Type, mut bits: Vec<Signal>) -> Value {
    if ty.is_real() {
        return Value::Real(bits);
    }
    if matches!(ty, Type::String(_)) {
        return Value::Text(None);
    }
    let (low, high) = bounds(ty);
    if low >= 0 {
        bits.push(Signal::FALSE);
    }
    Value::Whole(Word::of(bits, 1, low, high))
}

/// The value of an operation on constants, as the engine has it.
fn folded(e: &Expr, ty: Type, args: &[Value]) -> Option<(Value, Signal)> {
    if matches!(ty, Type::String(_)) {
        return None;
    }
    let words: Vec<u64> = args.iter().map(Value::known).collect::<Option<_>>()?;
    let done = match (e, words.as_slice()) {
        (Expr::Neg(ty, _), [a]) => number::negate(num(*ty), *a),
        (Expr::Arith(op, ty, ..), [a, b]) => number::arith(*op, num(*ty), *a, *b),
        (Expr::Convert(from, to, _), [a]) if num(*from) != num(*to) => {
            number::convert(num(*from), num(*to), *a)
        }
        (Expr::Trunc(from, to, _), [a]) => number::truncate(num(*from), num(*to), *a),
        (Expr::Call(f, ty, _), list) => number::call(*f, num(*ty), list),
        _ => return None,
    };
    match done {
        Ok(word) => Some((Value::of_word(ty, word), Signal::FALSE)),
        // A value that does not fit may wrap; the circuits know how.
        Err(_) if args.iter().all(|a| matches!(a, Value::Whole(_))) => None,
        Err(_) => Some((Value::zero(ty), Signal::TRUE)),
    }
}
