//! The content of memories and the values of expressions, as bits.

use std::rc::Rc;

use g7_engine::{Cmp, Num};
use g7_model::Type;

use super::range::{is_whole, number};
use super::word::{self, Word};
use crate::sat::{Graph, Signal};

/// A value of one element.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    /// A truth value, a whole number or a time.
    Whole(Word),
    /// The bits of a REAL or LREAL, the lowest first.
    Real(Vec<Signal>),
    /// A text, where it is known.
    Text(Option<Rc<[u8]>>),
}

/// Bits of a type of floating-point numbers.
pub(crate) fn real_bits(ty: Type) -> usize {
    if ty == Type::Real { 32 } else { 64 }
}

impl Value {
    /// The value of a word of the engine.
    pub(crate) fn of_word(ty: Type, word: u64) -> Value {
        if is_whole(ty) {
            return Value::Whole(Word::constant(number(ty, word)));
        }
        if matches!(ty, Type::String(_)) {
            return Value::Text(None);
        }
        Value::Real((0..real_bits(ty)).map(|i| Signal::from(word >> i & 1 != 0)).collect())
    }

    /// TRUE or FALSE.
    pub(crate) fn truth(s: Signal) -> Value {
        Value::Whole(Word::truth(s))
    }

    /// 0, or an empty text.
    pub(crate) fn zero(ty: Type) -> Value {
        match ty {
            Type::String(_) => Value::Text(Some(Rc::from([]))),
            _ => Value::of_word(ty, 0),
        }
    }

    /// The whole number; 0 for others.
    pub(crate) fn whole(&self) -> Word {
        match self {
            Value::Whole(w) => w.clone(),
            Value::Real(_) | Value::Text(_) => Word::constant(0),
        }
    }

    /// The word of the engine, where it is a constant.
    pub(crate) fn known(&self) -> Option<u64> {
        match self {
            Value::Whole(w) => w.known().map(|v| v as u64),
            Value::Real(bits) => {
                let mut word = 0;
                for (i, b) in bits.iter().enumerate() {
                    word |= u64::from(b.constant()?) << i;
                }
                Some(word)
            }
            Value::Text(_) => None,
        }
    }
}

/// One of two values of a type, by a condition.
pub(crate) fn choose(g: &mut Graph, condition: Signal, a: &Value, b: &Value) -> Value {
    match (condition.constant(), a, b) {
        (Some(true), _, _) => a.clone(),
        (Some(false), _, _) => b.clone(),
        (None, Value::Whole(a), Value::Whole(b)) => Value::Whole(word::choose(g, condition, a, b)),
        (None, Value::Real(a), Value::Real(b)) => {
            Value::Real(a.iter().zip(b).map(|(a, b)| g.mux(condition, *a, *b)).collect())
        }
        (None, Value::Text(a), Value::Text(b)) if a == b => Value::Text(a.clone()),
        (None, ..) => Value::Text(None),
    }
}

/// 1 if the words of two values are equal. Texts are not asked here.
pub(crate) fn same(g: &mut Graph, a: &Value, b: &Value) -> Signal {
    match (a, b) {
        (Value::Whole(a), Value::Whole(b)) => word::equal(g, a, b),
        (Value::Real(a), Value::Real(b)) => {
            let bits: Vec<Signal> = a.iter().zip(b).map(|(a, b)| g.equal(*a, *b)).collect();
            g.all(bits)
        }
        _ => Signal::from(a == b),
    }
}

/// A comparison of two whole numbers or of two floating-point numbers.
pub(crate) fn compare(g: &mut Graph, c: Cmp, a: &Value, b: &Value) -> Signal {
    let (less, equal, more) = match (a, b) {
        (Value::Real(a), Value::Real(b)) => order(g, a, b),
        _ => {
            let (a, b) = (a.whole(), b.whole());
            return match c {
                Cmp::Eq => word::equal(g, &a, &b),
                Cmp::Ne => !word::equal(g, &a, &b),
                Cmp::Lt => word::less(g, &a, &b),
                Cmp::Ge => !word::less(g, &a, &b),
                Cmp::Gt => word::less(g, &b, &a),
                Cmp::Le => !word::less(g, &b, &a),
            };
        }
    };
    match c {
        Cmp::Eq => equal,
        Cmp::Ne => !equal,
        Cmp::Lt => less,
        Cmp::Gt => more,
        Cmp::Le => g.or(less, equal),
        Cmp::Ge => g.or(more, equal),
    }
}

/// Less, equal, more; none of them where one is NaN (IEEE 754, 5.11).
fn order(g: &mut Graph, a: &[Signal], b: &[Signal]) -> (Signal, Signal, Signal) {
    let fraction = if a.len() == 32 { 23 } else { 52 };
    let mut parts = Vec::new();
    for x in [a, b] {
        let (sign, size) = x.split_last().map_or((Signal::FALSE, &[][..]), |(s, m)| (*s, m));
        let (low, high) = size.split_at(fraction.min(size.len()));
        let (full, rest) = (g.all(high.iter().copied()), g.any(low.iter().copied()));
        let nan = g.and(full, rest);
        let mut bits = size.to_vec();
        bits.push(Signal::FALSE);
        let most = (1i128 << size.len()) - 1;
        let size = Word::of(bits, 1, 0, most);
        let zero = !word::is_true(g, &size);
        parts.push((sign, size, nan, zero));
    }
    let [(sa, ma, na, za), (sb, mb, nb, zb)] = parts.as_slice() else {
        return (Signal::FALSE, Signal::FALSE, Signal::FALSE);
    };
    let (numbers, zeros) = (!g.or(*na, *nb), g.and(*za, *zb));
    let (smaller, larger, alike) = (word::less(g, ma, mb), word::less(g, mb, ma), word::equal(g, ma, mb));
    let one_sign = g.equal(*sa, *sb);
    let by_size = g.mux(*sa, larger, smaller);
    let less = g.mux(one_sign, by_size, *sa);
    let same = g.and(one_sign, alike);
    let (less, same) = (g.and(less, !zeros), g.or(same, zeros));
    let (less, same) = (g.and(less, numbers), g.and(same, numbers));
    let not_more = g.or(less, same);
    (less, same, g.and(numbers, !not_more))
}

/// The kind of numbers of a type.
pub(crate) fn num(ty: Type) -> Num {
    g7_compile::lower::num(ty)
}
