//! Whole numbers as vectors of bits, and the circuits of their arithmetic.
//!
//! A word stands for an exact whole number, whatever its type: the results of sums and
//! products are as wide as they need be, and whoever stores them asks whether they fit. So
//! each width is the smallest that is known to do, and overflow is a comparison.

use crate::sat::{Graph, Signal};

/// A whole number: `scale` times the number of the bits, which is at least `low` and at most
/// `high`. The bits are in two's complement, the lowest first, the sign last.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Word {
    bits: Vec<Signal>,
    scale: i128,
    low: i128,
    high: i128,
}

/// Bits of a number in two's complement that lies between two bounds.
pub(crate) fn width(low: i128, high: i128) -> usize {
    let one = |v: i128| 129 - (if v < 0 { !v } else { v }).leading_zeros() as usize;
    one(low).max(one(high)).min(127)
}

/// The greatest common divisor; 0 divides by everything.
pub(crate) fn gcd(a: i128, b: i128) -> i128 {
    let (mut a, mut b) = (a.abs(), b.abs());
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

impl Word {
    /// A constant.
    pub(crate) fn constant(v: i128) -> Word {
        let bits = (0..width(v, v)).map(|i| Signal::from(v >> i & 1 != 0)).collect();
        Word { bits, scale: 1, low: v, high: v }
    }

    /// 1 or 0.
    pub(crate) fn truth(s: Signal) -> Word {
        Word::of(vec![s, Signal::FALSE], 1, 0, 1)
    }

    /// `scale` times the number of these bits, which is known to lie between the bounds.
    pub(crate) fn of(mut bits: Vec<Signal>, scale: i128, low: i128, high: i128) -> Word {
        if low == high {
            let c = Word::constant(low);
            return if low == 0 { c } else { Word { scale, ..c } };
        }
        let sign = bits.last().copied().unwrap_or(Signal::FALSE);
        bits.resize(width(low, high), sign);
        while let [.., a, b] = bits.as_slice()
            && a == b
        {
            bits.pop();
        }
        let half = 1i128 << (bits.len() - 1);
        let sign = bits.last().copied().unwrap_or(Signal::FALSE).constant();
        let (least, most) =
            (if sign == Some(false) { 0 } else { -half }, if sign == Some(true) { -1 } else { half - 1 });
        if let Some(v) = number(&bits) {
            let c = Word::constant(v);
            return if v == 0 { c } else { Word { scale, ..c } };
        }
        Word { bits, scale, low: low.max(least), high: high.min(most) }
    }

    /// The same number in other signals.
    pub(crate) fn moved(&self, of: impl Fn(Signal) -> Signal) -> Word {
        Word { bits: self.bits.iter().map(|s| of(*s)).collect(), ..self.clone() }
    }

    /// The value, if it is a constant.
    pub(crate) fn known(&self) -> Option<i128> {
        Some(number(&self.bits)? * self.scale)
    }

    /// The least and the greatest value.
    pub(crate) fn range(&self) -> (i128, i128) {
        (self.low.saturating_mul(self.scale), self.high.saturating_mul(self.scale))
    }

    /// The bits of the number behind the scale.
    pub(crate) fn bits(&self) -> &[Signal] {
        &self.bits
    }

    fn bit(&self, i: usize) -> Signal {
        self.bits.get(i).or(self.bits.last()).copied().unwrap_or(Signal::FALSE)
    }

    /// Its value is a multiple of this.
    fn step(&self) -> i128 {
        self.known().unwrap_or(self.scale)
    }

    /// The same number with a scale that divides the present one.
    fn scaled(&self, g: &mut Graph, scale: i128) -> Word {
        if let Some(v) = self.known() {
            return if v == 0 { Word::constant(0) } else { Word { scale, ..Word::constant(v / scale) } };
        }
        let factor = self.scale / scale;
        if factor == 1 {
            return self.clone();
        }
        let mut sum = Word::constant(0);
        for i in (0..126).filter(|i| factor >> i & 1 != 0) {
            let mut bits = vec![Signal::FALSE; i];
            bits.extend(&self.bits);
            sum = add(g, &sum, &Word::of(bits, 1, self.low << i, self.high << i));
        }
        Word { scale, ..sum }
    }
}

fn number(bits: &[Signal]) -> Option<i128> {
    let mut v = 0i128;
    for (i, b) in bits.iter().enumerate() {
        let one = b.constant()?;
        let weight = if i + 1 == bits.len() { -1 } else { 1 };
        v += if one { weight << i } else { 0 };
    }
    Some(v)
}

/// Two numbers with one scale.
fn aligned(g: &mut Graph, a: &Word, b: &Word) -> (Word, Word) {
    let scale = gcd(a.step(), b.step()).max(1);
    (a.scaled(g, scale), b.scaled(g, scale))
}

/// The sum of two numbers of one scale and a bit.
fn sum(g: &mut Graph, a: &Word, b: &Word, invert: bool, low: i128, high: i128) -> Vec<Signal> {
    let mut carry = Signal::from(invert);
    let mut bits = Vec::new();
    for i in 0..width(low, high) {
        let (x, y) = (a.bit(i), b.bit(i).negated_if(invert));
        let half = g.xor(x, y);
        bits.push(g.xor(half, carry));
        let (both, passed) = (g.and(x, y), g.and(half, carry));
        carry = g.or(both, passed);
    }
    bits
}

/// Sum.
pub(crate) fn add(g: &mut Graph, a: &Word, b: &Word) -> Word {
    let (a, b) = aligned(g, a, b);
    let (low, high) = (a.low + b.low, a.high + b.high);
    let bits = sum(g, &a, &b, false, low, high);
    Word::of(bits, a.scale.max(b.scale), low, high)
}

/// Difference.
pub(crate) fn sub(g: &mut Graph, a: &Word, b: &Word) -> Word {
    let (a, b) = aligned(g, a, b);
    let (low, high) = (a.low - b.high, a.high - b.low);
    let bits = sum(g, &a, &b, true, low, high);
    Word::of(bits, a.scale.max(b.scale), low, high)
}

/// Product; the bits of both together are at most 120.
pub(crate) fn mul(g: &mut Graph, a: &Word, b: &Word) -> Word {
    let (a, b) = if a.known().is_some() { (b, a) } else { (a, b) };
    if let Some(k) = b.known() {
        if k == 0 {
            return Word::constant(0);
        }
        let scale = a.scale * k.abs();
        let word = Word { scale, ..a.clone() };
        return if k < 0 { sub(g, &Word::constant(0), &word) } else { word };
    }
    let ends = [a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high];
    let (low, high) =
        (ends.iter().copied().fold(i128::MAX, i128::min), ends.into_iter().fold(i128::MIN, i128::max));
    let mut total = Word::constant(0);
    for (i, bit) in b.bits.iter().enumerate() {
        let mut bits = vec![Signal::FALSE; i];
        bits.extend(a.bits.iter().map(|s| g.and(*s, *bit)));
        let part = Word::of(bits, 1, (a.low << i).min(0), (a.high << i).max(0));
        total = if i + 1 == b.bits.len() { sub(g, &total, &part) } else { add(g, &total, &part) };
    }
    let total = total.scaled(g, 1);
    Word::of(total.bits, a.scale * b.scale, low, high)
}

/// 1 if `a` is less than `b`.
pub(crate) fn less(g: &mut Graph, a: &Word, b: &Word) -> Signal {
    let ((al, ah), (bl, bh)) = (a.range(), b.range());
    if ah < bl {
        return Signal::TRUE;
    }
    if al >= bh {
        return Signal::FALSE;
    }
    // Against a constant the scale need not be multiplied out.
    let (a, b) = if let Some(c) = b.known() {
        (Word { scale: 1, ..a.clone() }, Word::constant(-(-c).div_euclid(a.scale)))
    } else if let Some(c) = a.known() {
        (Word::constant(c.div_euclid(b.scale)), Word { scale: 1, ..b.clone() })
    } else {
        aligned(g, a, b)
    };
    let n = a.bits.len().max(b.bits.len());
    let mut less = Signal::FALSE;
    for i in 0..n {
        // The sign weighs the other way.
        let (x, y) = if i + 1 == n { (b.bit(i), a.bit(i)) } else { (a.bit(i), b.bit(i)) };
        let differ = g.xor(x, y);
        less = g.mux(differ, y, less);
    }
    less
}

/// 1 if the two are equal.
pub(crate) fn equal(g: &mut Graph, a: &Word, b: &Word) -> Signal {
    let (a, b) = if a.known().is_some() { (b, a) } else { (a, b) };
    if let Some(c) = b.known()
        && a.known().is_none()
    {
        if c % a.scale != 0 {
            return Signal::FALSE;
        }
        return same(g, a, &Word::constant(c / a.scale));
    }
    let (a, b) = aligned(g, a, b);
    same(g, &a, &b)
}

fn same(g: &mut Graph, a: &Word, b: &Word) -> Signal {
    let n = a.bits.len().max(b.bits.len());
    let bits: Vec<Signal> = (0..n).map(|i| g.equal(a.bit(i), b.bit(i))).collect();
    g.all(bits)
}

/// 1 if the number is not 0.
pub(crate) fn is_true(g: &mut Graph, a: &Word) -> Signal {
    g.any(a.bits.iter().copied())
}

/// `a` where the condition holds, else `b`.
pub(crate) fn choose(g: &mut Graph, condition: Signal, a: &Word, b: &Word) -> Word {
    match condition.constant() {
        Some(true) => return a.clone(),
        Some(false) => return b.clone(),
        None if a == b => return a.clone(),
        None => {}
    }
    let (a, b) = aligned(g, a, b);
    let n = a.bits.len().max(b.bits.len());
    let bits = (0..n).map(|i| g.mux(condition, a.bit(i), b.bit(i))).collect();
    Word::of(bits, a.scale.max(b.scale), a.low.min(b.low), a.high.max(b.high))
}

/// 1 if the number lies between these bounds, both included.
pub(crate) fn within(g: &mut Graph, a: &Word, low: i128, high: i128) -> Signal {
    let (below, above) = (less(g, a, &Word::constant(low)), less(g, &Word::constant(high), a));
    !g.or(below, above)
}

/// The low 64 bits, as a number with or without a sign.
pub(crate) fn wrapped(g: &mut Graph, a: &Word, signed: bool) -> Word {
    let a = a.scaled(g, 1);
    let mut bits: Vec<Signal> = (0..64).map(|i| a.bit(i)).collect();
    let (low, high) = if signed {
        (i64::MIN.into(), i64::MAX.into())
    } else {
        bits.push(Signal::FALSE);
        (0, u64::MAX.into())
    };
    Word::of(bits, 1, low, high)
}

/// The absolute value.
pub(crate) fn absolute(g: &mut Graph, a: &Word) -> Word {
    if a.low >= 0 {
        return a.clone();
    }
    let negative = a.bit(a.bits.len());
    let minus = sub(g, &Word::constant(0), a);
    let word = choose(g, negative, &minus, a);
    let (scale, most) = (word.scale, a.high.max(-a.low).max(0));
    // Both alternatives have the scale of `a` here.
    if scale == a.scale { Word::of(word.bits, scale, 0, most) } else { word }
}

/// Quotient toward zero and remainder with the sign of `a`; both are 0 where `b` is 0.
pub(crate) fn divide(g: &mut Graph, a: &Word, b: &Word) -> (Word, Word) {
    let (x, y) = aligned(g, a, b);
    let scale = x.scale.max(y.scale);
    let strip = |w: &Word| {
        if w.known().is_some() {
            w.known().map_or(w.clone(), |v| Word::constant(v / scale))
        } else {
            Word { scale: 1, ..w.clone() }
        }
    };
    let (x, y) = (strip(&x), strip(&y));
    let (n, d) = (absolute(g, &x), absolute(g, &y));
    let (q, r) = magnitudes(g, &n, &d);
    let (sx, sy) = (x.bit(x.bits.len()), y.bit(y.bits.len()));
    let zero = Word::constant(0);
    let by_zero = !is_true(g, &y);
    let opposed = g.xor(sx, sy);
    let (mq, mr) = (sub(g, &zero, &q), sub(g, &zero, &r));
    let (q, r) = (choose(g, opposed, &mq, &q), choose(g, sx, &mr, &r));
    let r = mul(g, &r, &Word::constant(scale));
    (choose(g, by_zero, &zero, &q), choose(g, by_zero, &zero, &r))
}

/// The same for two numbers that are not negative, the second not 0.
fn magnitudes(g: &mut Graph, n: &Word, d: &Word) -> (Word, Word) {
    let (n, d) = (&n.scaled(g, 1), &d.scaled(g, 1));
    let mut rest = Word::constant(0);
    let mut quotient = vec![Signal::FALSE; n.bits.len()];
    for i in (0..n.bits.len().saturating_sub(1)).rev() {
        let mut bits = vec![n.bit(i)];
        bits.extend(&rest.bits);
        rest = Word::of(bits, 1, 0, rest.high * 2 + 1);
        let fits = !less(g, &rest, d);
        if let Some(q) = quotient.get_mut(i) {
            *q = fits;
        }
        let smaller = sub(g, &rest, d);
        let next = choose(g, fits, &smaller, &rest);
        // Where it fits it does not fall below 0; then it is less than the divisor.
        rest = Word::of(next.scaled(g, 1).bits, 1, 0, rest.high.min((d.high - 1).max(0)));
    }
    (Word::of(quotient, 1, 0, n.high.max(0)), rest)
}

/// The same number where it lies between the bounds, in no more bits than that needs.
pub(crate) fn clipped(a: &Word, low: i128, high: i128) -> Word {
    let low = a.low.max(-(-low).div_euclid(a.scale));
    let high = a.high.min(high.div_euclid(a.scale));
    if low > high { Word::constant(0) } else { Word::of(a.bits.clone(), a.scale, low, high) }
}

/// The bits of the number divided by `scale`, which divides it where the number matters.
pub(crate) fn divided(g: &mut Graph, a: &Word, scale: i128) -> Word {
    if let Some(v) = a.known() {
        return Word::constant(v / scale);
    }
    if a.scale % scale == 0 {
        let w = a.scaled(g, scale);
        return Word { scale: 1, ..w };
    }
    let common = gcd(a.scale, scale);
    let w = a.scaled(g, common);
    divide(g, &Word { scale: 1, ..w }, &Word::constant(scale / common)).0
}

#[cfg(test)]
impl Word {
    /// The number for given values of the bits.
    pub(crate) fn read(&self, bit: impl Fn(Signal) -> bool) -> i128 {
        let bits: Vec<Signal> = self.bits.iter().map(|s| Signal::from(bit(*s))).collect();
        number(&bits).unwrap_or(0) * self.scale
    }
}
