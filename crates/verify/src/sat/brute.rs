//! Small random systems, and all of their states one by one: what the engines are compared with.

use std::collections::BTreeSet;

use crate::layer::Budget;
use crate::sat::graph::{Init, Signal, System};
use crate::sat::simulate::evaluate;

/// A sequence of numbers that is the same in each run.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// A number below another.
    pub(crate) fn below(&mut self, most: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % most.max(1)
    }
}

/// A system of few latches and inputs, with one signal that is asked for.
pub(crate) fn system(seed: u64) -> (System, Signal) {
    let mut r = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0xABCD);
    let mut s = System::default();
    let (latches, inputs) = (2 + r.below(6), r.below(4));
    let mut known: Vec<Signal> = Vec::new();
    for _ in 0..latches {
        let init = [Init::Zero, Init::Zero, Init::One, Init::Free];
        known.push(s.latch(init[r.below(if seed.is_multiple_of(3) { 4 } else { 3 })]));
    }
    (0..inputs).for_each(|_| known.push(s.input()));
    for _ in 0..r.below(30) + 4 {
        let pick = |r: &mut Random, known: &[Signal]| known[r.below(known.len())].negated_if(r.below(2) == 1);
        let (a, b, c) = (pick(&mut r, &known), pick(&mut r, &known), pick(&mut r, &known));
        let g = &mut s.graph;
        known.push(match r.below(5) {
            0 => g.xor(a, b),
            1 => g.mux(a, b, c),
            2 => g.or(a, b),
            _ => g.and(a, b),
        });
    }
    let last = |r: &mut Random, known: &[Signal]| {
        known[known.len() - 1 - r.below(known.len().min(12))].negated_if(r.below(2) == 1)
    };
    for latch in s.latches.clone() {
        // Some keep their value unless something happens, as steps do.
        let (set, clear) = (last(&mut r, &known), last(&mut r, &known));
        let next = match r.below(3) {
            0 => set,
            _ => {
                let kept = s.graph.and(latch.signal, !clear);
                s.graph.or(kept, set)
            }
        };
        s.set_next(latch.signal, next);
    }
    if r.below(3) == 0 {
        let c = last(&mut r, &known);
        s.constraints.push(c);
    }
    let some: Vec<Signal> =
        (0..1 + r.below(3)).map(|_| known[r.below(latches)].negated_if(r.below(2) == 1)).collect();
    let mut bad = s.graph.all(some);
    if r.below(3) == 0 {
        let more = last(&mut r, &known);
        bad = s.graph.and(bad, more);
    }
    (s, bad)
}

/// The number of steps of a shortest run that shows the signal.
pub(crate) fn shortest(s: &System, bad: Signal) -> Option<usize> {
    let bits = |code: u64, n: usize| (0..n).map(move |i| code >> i & 1);
    let count = s.latches.len();
    let starts = |code: &u64| {
        s.latches.iter().zip(bits(*code, count)).all(|(l, v)| l.init.value().is_none_or(|i| i == (v == 1)))
    };
    let mut level: BTreeSet<u64> = (0..1u64 << count).filter(starts).collect();
    let mut seen = level.clone();
    for steps in 1.. {
        let mut next = BTreeSet::new();
        for state in &level {
            let latches: Vec<u64> = bits(*state, count).map(|b| if b == 1 { u64::MAX } else { 0 }).collect();
            // All inputs at once, one pattern each.
            let all = 1u64 << s.inputs.len();
            let inputs: Vec<u64> = (0..s.inputs.len())
                .map(|i| (0..all).filter(|p| p >> i & 1 == 1).fold(0, |word, p| word | 1 << p))
                .collect();
            let values = evaluate(&s.graph, &latches, &inputs);
            let allowed = s.constraints.iter().fold((1u64 << all) - 1, |word, c| word & values.get(*c));
            if values.get(bad) & allowed != 0 {
                return Some(steps);
            }
            for p in (0..all).filter(|p| allowed >> p & 1 == 1) {
                let to = (0u64..).zip(&s.latches).map(|(i, l)| (values.get(l.next) >> p & 1) << i).sum();
                if seen.insert(to) {
                    next.insert(to);
                }
            }
        }
        if next.is_empty() {
            return None;
        }
        level = next;
    }
    None
}

/// A system with more inputs than the search of `wide` tries together: numbers are compared and added up, and the constraint
/// couples them.
pub(crate) fn numbers(seed: u64) -> (System, Vec<Signal>) {
    let mut r = Random(seed);
    let mut s = System::default();
    let inputs: Vec<Signal> = (0..10).map(|_| s.input()).collect();
    let latches: Vec<Signal> = (0..5).map(|_| s.latch(false.into())).collect();
    let mut above = Signal::FALSE;
    let most = r.below(1024);
    // inputs > most, the lowest bit first.
    for (k, i) in inputs.iter().enumerate() {
        let same = if most >> k & 1 == 1 { s.graph.and(*i, above) } else { s.graph.or(*i, above) };
        above = same;
    }
    let some = s.graph.xor(inputs[r.below(10)], inputs[r.below(10)]);
    let (mut carry, step) = (s.graph.and(above, some), latches[r.below(5)]);
    for l in &latches {
        let (next, over) = (s.graph.xor(*l, carry), s.graph.and(*l, carry));
        s.set_next(*l, next);
        carry = over;
    }
    let kept = s.graph.implies(inputs[9], !inputs[r.below(9)]);
    let more = s.graph.implies(step, inputs[r.below(10)]);
    s.constraints = vec![kept, more];
    let all = s.graph.all(latches.iter().copied());
    let odd = s.graph.all([latches[0], !latches[1], latches[4], above]);
    (s, vec![all, odd, carry])
}

/// States that all inputs lead to, each by itself, and the least number of steps to each signal.
pub(crate) fn by_hand(s: &System, signals: &[Signal]) -> (usize, Vec<Option<usize>>, bool) {
    let mut seen = BTreeSet::from([0u64]);
    let (mut level, mut first, mut depth, mut stuck) = (vec![0u64], vec![None; signals.len()], 0, false);
    while !level.is_empty() {
        depth += 1;
        let mut next = Vec::new();
        for state in level {
            let latches: Vec<u64> = (0..s.latches.len()).map(|k| 0u64.wrapping_sub(state >> k & 1)).collect();
            let mut fed = false;
            for pattern in 0..1u64 << s.inputs.len() {
                let inputs: Vec<u64> = (0..s.inputs.len()).map(|k| pattern >> k & 1).collect();
                let values = evaluate(&s.graph, &latches, &inputs);
                if s.constraints.iter().any(|c| !values.bit(*c)) {
                    continue;
                }
                fed = true;
                for (signal, first) in signals.iter().zip(&mut first) {
                    if first.is_none() && values.bit(*signal) {
                        *first = Some(depth);
                    }
                }
                let to = s.latches.iter().enumerate().map(|(k, l)| u64::from(values.bit(l.next)) << k).sum();
                if seen.insert(to) {
                    next.push(to);
                }
            }
            stuck |= !fed;
        }
        level = next;
    }
    (seen.len(), first, stuck)
}

/// A budget without limits.
pub(crate) fn unlimited() -> Budget<'static> {
    Budget { states: usize::MAX, scans: usize::MAX, bytes: usize::MAX, stop: &|| false }
}

/// A number of ten bits that counts while an input is 1, and the signal of its overflow: 1024 steps lead there.
pub(crate) fn counter() -> (System, Signal) {
    let mut s = System::default();
    let latches: Vec<Signal> = (0..10).map(|_| s.latch(false.into())).collect();
    let mut carry = s.input();
    for l in &latches {
        let (next, over) = (s.graph.xor(*l, carry), s.graph.and(*l, carry));
        s.set_next(*l, next);
        carry = over;
    }
    (s, carry)
}
