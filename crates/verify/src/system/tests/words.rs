//! Each circuit of whole numbers gives the number, for all values of its operands.

use super::Rng;
use crate::sat::{Signal, System, Values, evaluate};
use crate::system::word::{self, Word, width};

/// A free number between bounds, with a scale, and its bits in the list of inputs.
fn operand(s: &mut System, low: i128, high: i128, scale: i128) -> Word {
    let mut bits: Vec<Signal> = (0..width(low, high)).map(|_| s.input()).collect();
    if low >= 0 {
        bits.pop();
        bits.push(Signal::FALSE);
    }
    Word::of(bits, scale, low, high)
}

/// The operands with every sign, width and scale that times and integers have, and constants.
fn operands(s: &mut System) -> Vec<Word> {
    let rows = [(-8, 7, 1), (0, 15, 1), (0, 5, 10), (-3, 9, 4), (0, 1, 1), (-1, 0, 6), (-128, 127, 1)];
    let mut list: Vec<Word> =
        rows.into_iter().map(|(low, high, scale)| operand(s, low, high, scale)).collect();
    list.extend([0, 1, -1, 7, 10, -40, 100].map(Word::constant));
    list
}

#[test]
fn arithmetic() {
    let mut s = System::default();
    let list = operands(&mut s);
    let g = &mut s.graph;
    type Of = fn(i128, i128) -> i128;
    let mut rows: Vec<(&str, Word, Of, usize, usize)> = Vec::new();
    for (i, a) in list.iter().enumerate() {
        for (k, b) in list.iter().enumerate() {
            let mut row = |name, word, of: Of| rows.push((name, word, of, i, k));
            row("add", word::add(g, a, b), |a, b| a + b);
            row("sub", word::sub(g, a, b), |a, b| a - b);
            row("mul", word::mul(g, a, b), |a, b| a * b);
            let (q, r) = word::divide(g, a, b);
            row("div", q, |a, b| a.checked_div(b).unwrap_or(0));
            row("mod", r, |a, b| a.checked_rem(b).unwrap_or(0));
            row("less", Word::truth(word::less(g, a, b)), |a, b| (a < b).into());
            row("equal", Word::truth(word::equal(g, a, b)), |a, b| (a == b).into());
            row("abs", word::absolute(g, a), |a, _| a.abs());
            row("within", Word::truth(word::within(g, a, -5, 9)), |a, _| (-5..=9).contains(&a).into());
            row("true", Word::truth(word::is_true(g, a)), |a, _| (a != 0).into());
            let on = word::less(g, a, b);
            row("choose", word::choose(g, on, a, b), |a, b| a.min(b));
            row("wrapped", word::wrapped(g, a, false), |a, _| a as u64 as i128);
        }
    }
    let mut rng = Rng(1);
    for _ in 0..40 {
        let inputs: Vec<u64> = s.inputs.iter().map(|_| rng.next()).collect();
        let values = evaluate(&s.graph, &[], &inputs);
        for lane in 0..64 {
            let read = |w: &Word, v: &Values| w.read(|s| v.get(s) >> lane & 1 != 0);
            let numbers: Vec<i128> = list.iter().map(|w| read(w, &values)).collect();
            // Only values within the bounds that an operand was made with.
            let bounds =
                [(-8, 7, 1), (0, 15, 1), (0, 5, 10), (-3, 9, 4), (0, 1, 1), (-1, 0, 6), (-128, 127, 1)];
            let fits = |i: usize| bounds.get(i).is_none_or(|(l, h, s)| (l * s..=h * s).contains(&numbers[i]));
            for (name, word, of, i, k) in rows.iter().filter(|r| fits(r.3) && fits(r.4)) {
                let (a, b) = (numbers[*i], numbers[*k]);
                assert_eq!(read(word, &values), of(a, b), "{name} {a} {b}");
            }
        }
    }
}

/// Times of an hour in periods of 10 ms have as many bits as periods: no more.
#[test]
fn numbers_are_as_wide_as_their_bounds() {
    assert_eq!([width(0, 0), width(-1, 0), width(0, 1), width(-8, 7), width(0, 8)], [1, 1, 2, 4, 5]);
    let mut s = System::default();
    let clock = operand(&mut s, 0, 360_000, 10_000_000);
    assert_eq!(clock.bits().len(), 20, "19 and a sign");
    let next = word::add(&mut s.graph, &clock, &Word::constant(10_000_000));
    assert_eq!(next.bits().len(), 20);
    assert_eq!(next.range(), (10_000_000, 360_001 * 10_000_000));
}
