//! The functions of a system as a list of gates, evaluated for many patterns at once: with the values of
//! all latches and inputs, or with inputs that may be either.
//!
//! Values stand in one list: 0, the inputs, the latches, then each gate behind those that it reads. A code
//! is the place of a value times 2, and 1 more for its negation.

use std::collections::HashMap;

use super::lanes::{Lanes, NONE, any, both, negated};
use crate::sat::cone::cone;
use crate::sat::graph::{Node, Signal, System};

/// The part of a system that its constraints and some signals depend on.
pub(super) struct Program {
    /// For each input: its place in [`System::inputs`].
    pub(super) inputs: Vec<usize>,
    /// For each latch: its place in [`System::latches`].
    pub(super) latches: Vec<usize>,
    /// The codes that each gate reads.
    gates: Vec<[u32; 2]>,
    /// The code of the next value of each latch.
    pub(super) next: Vec<u32>,
    /// Codes that are 1 at each step.
    pub(super) constraints: Vec<u32>,
    /// Codes of the signals that are asked for.
    pub(super) asked: Vec<u32>,
}

/// The values of all places.
#[derive(Default)]
pub(super) struct Plain(Vec<Lanes>);

/// Which values each place may have, if inputs are not known.
#[derive(Default)]
pub(super) struct Open {
    /// Patterns in which it may be 1, and in which it may be 0.
    may: Vec<[Lanes; 2]>,
    /// Patterns in which an open result reads it.
    read: Vec<Lanes>,
}

impl Program {
    /// The part on which these signals depend; with `all`, the part on which all latches do.
    pub(super) fn new(system: &System, asked: &[Signal], all: bool) -> Program {
        let more = system.latches.iter().filter(|_| all).map(|l| l.signal);
        let roots = system.constraints.iter().chain(asked).copied().chain(more);
        let inside = cone(system, roots);
        let is_in = |s: &Signal| inside.get(s.node() as usize) == Some(&true);
        let places = |list: &mut dyn Iterator<Item = Signal>| -> Vec<usize> {
            list.enumerate().filter(|(_, s)| is_in(s)).map(|(place, _)| place).collect()
        };
        let inputs = places(&mut system.inputs.iter().copied());
        let latches = places(&mut system.latches.iter().map(|l| l.signal));
        let mut codes = HashMap::from([(0, 0)]);
        let known = inputs.iter().filter_map(|i| system.inputs.get(*i).copied());
        let known = known.chain(latches.iter().filter_map(|l| system.latches.get(*l)).map(|l| l.signal));
        for (signal, place) in known.zip(1u32..) {
            codes.insert(signal.node(), place * 2 + u32::from(signal.is_negated()));
        }
        let mut gates = Vec::new();
        let first = (1 + inputs.len() + latches.len()) as u32;
        let code = |codes: &HashMap<u32, u32>, s: Signal| {
            codes.get(&s.node()).copied().unwrap_or(0) ^ u32::from(s.is_negated())
        };
        for (number, node) in system.graph.nodes().iter().enumerate() {
            if let (Node::And(a, b), Some(true)) = (node, inside.get(number)) {
                gates.push([code(&codes, *a), code(&codes, *b)]);
                codes.insert(number as u32, (first + gates.len() as u32 - 1) * 2);
            }
        }
        let of = |s: &Signal| code(&codes, *s);
        let next = latches.iter().filter_map(|l| system.latches.get(*l)).map(|l| of(&l.next)).collect();
        let constraints = system.constraints.iter().map(of).collect();
        Program { inputs, latches, gates, next, constraints, asked: asked.iter().map(of).collect() }
    }

    /// The number of gates.
    pub(super) fn size(&self) -> usize {
        self.gates.len()
    }

    fn first_gate(&self) -> usize {
        1 + self.inputs.len() + self.latches.len()
    }

    /// Evaluates all gates; `set` gives the latches and the inputs their values.
    pub(super) fn evaluate(&self, values: &mut Plain, set: impl FnOnce(&mut [Lanes], &mut [Lanes])) {
        let list = &mut values.0;
        list.clear();
        list.resize(self.first_gate(), NONE);
        if let Some((inputs, latches)) = list.get_mut(1..).and_then(|l| l.split_at_mut_checked(self.inputs.len())) {
            set(latches, inputs);
        }
        list.reserve(self.gates.len());
        for [a, b] in &self.gates {
            let value = both(at(list, *a), at(list, *b), |a, b| a & b);
            list.push(value);
        }
    }

    /// The same with inputs that may be either: `set` gives the latches their values, and each input its
    /// values and where it has one.
    pub(super) fn evaluate_open(&self, open: &mut Open, set: impl FnOnce(&mut [Lanes], &mut [[Lanes; 2]])) {
        let list = &mut open.may;
        list.clear();
        list.resize(self.first_gate(), [NONE; 2]);
        let mut latches = vec![NONE; self.latches.len()];
        if let Some(inputs) = list.get_mut(1..=self.inputs.len()) {
            set(&mut latches, inputs);
        }
        let known = std::iter::once(&NONE).chain(&latches);
        let slots = (0..).zip(list.iter_mut()).filter(|(k, _)| *k == 0 || *k > self.inputs.len());
        for ((_, slot), value) in slots.zip(known) {
            *slot = [*value, negated(*value, 1)];
        }
        list.reserve(self.gates.len());
        for [a, b] in &self.gates {
            let ([a1, a0], [b1, b0]) = (may(list, *a), may(list, *b));
            list.push([both(a1, b1, |a, b| a & b), both(a0, b0, |a, b| a | b)]);
        }
    }

    /// Marks what the open results read, behind [`Program::evaluate_open`]. A result that has one value
    /// depends on nothing that is open; one that is open depends on what is open among what it reads.
    pub(super) fn trace(&self, open: &mut Open) {
        open.read.clear();
        open.read.resize(open.may.len(), NONE);
        for code in self.next.iter().chain(&self.constraints).chain(&self.asked) {
            mark(&mut open.read, *code, &[u64::MAX; super::lanes::WORDS]);
        }
        let first = self.first_gate();
        for (k, [a, b]) in self.gates.iter().enumerate().rev() {
            let read = open.is_read(first + k);
            if any(&read) {
                mark(&mut open.read, *a, &read);
                mark(&mut open.read, *b, &read);
            }
        }
    }
}

impl Plain {
    /// The values of a code.
    #[inline(always)]
    pub(super) fn get(&self, code: u32) -> Lanes {
        at(&self.0, code)
    }
}

impl Open {
    /// Patterns in which a code is 0 whatever the open inputs are.
    pub(super) fn is_zero(&self, code: u32) -> Lanes {
        negated(may(&self.may, code)[0], 1)
    }

    /// Patterns in which a place is open, and an open result depends on it.
    fn is_read(&self, place: usize) -> Lanes {
        let open = self.may.get(place).map_or(NONE, |[one, zero]| both(*one, *zero, |a, b| a & b));
        both(open, self.read.get(place).copied().unwrap_or(NONE), |a, b| a & b)
    }

    /// Patterns in which an open result depends on an input.
    pub(super) fn needs(&self, input: usize) -> Lanes {
        self.is_read(1 + input)
    }
}

#[inline(always)]
fn at(list: &[Lanes], code: u32) -> Lanes {
    negated(list.get(code as usize / 2).copied().unwrap_or(NONE), code)
}

#[inline(always)]
fn may(list: &[[Lanes; 2]], code: u32) -> [Lanes; 2] {
    let [one, zero] = list.get(code as usize / 2).copied().unwrap_or([NONE; 2]);
    if code & 1 == 0 { [one, zero] } else { [zero, one] }
}

fn mark(read: &mut [Lanes], code: u32, patterns: &Lanes) {
    if let Some(slot) = read.get_mut(code as usize / 2) {
        *slot = both(*slot, *patterns, |a, b| a | b);
    }
}
