//! The functions of a system as a list of gates, evaluated for many patterns at once: with the values of
//! all latches and inputs, or with inputs that may be either.
//!
//! Values stand in one list: 0, the inputs, the latches, then each gate behind those that it reads. A code
//! is the place of a value times 2, and 1 more for its negation.

use super::lanes::{Lanes, NONE, any, both, negated};
use crate::sat::cone::cone;
use crate::sat::graph::{Init, Node, Signal, System};

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
    /// The code of the guard: where it is 1, a later stage has the values.
    pub(super) guard: u32,
    /// The constraints do not depend on the guard.
    pub(super) is_bound: bool,
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
    /// The part on which these signals depend, with `all` the part on which all latches do: first as it is
    /// where the first guard is 0, then where the second is, and so on; the last one as it always is. Guards
    /// are signals of which one that is 0 leaves little to do.
    pub(super) fn stages(system: &System, asked: &[Signal], guards: &[Signal], all: bool) -> Vec<Program> {
        let more = system.latches.iter().filter(|_| all).map(|l| l.signal);
        let roots = system.constraints.iter().chain(asked).copied().chain(more);
        let inside = cone(system, roots);
        let whole = Program::new(system, &inside, asked, None);
        let mut stages: Vec<Program> = Vec::new();
        let (mut at, mut step) = (0, 1);
        let guards: Vec<Signal> = guards.iter().copied().filter(|g| g.constant().is_none()).collect();
        while let Some(guard) = guards.get(at) {
            let stage = Program::new(system, &inside, asked, Some(*guard));
            // One that saves little is left out.
            if stage.gates.len() * 4 < whole.gates.len() * 3 {
                stages.push(stage);
            }
            (at, step) = (at + step, at / 2 + 1);
        }
        stages.push(whole);
        stages
    }

    fn new(system: &System, inside: &[bool], asked: &[Signal], guard_of: Option<Signal>) -> Program {
        let is_in = |s: Signal| inside.get(s.node() as usize) == Some(&true);
        let mut made = System::default();
        let mut map = vec![Signal::FALSE; system.graph.nodes().len()];
        let put = |map: &mut Vec<Signal>, old: Signal, new: Signal| {
            if let Some(slot) = map.get_mut(old.node() as usize) {
                *slot = new.negated_if(old.is_negated());
            }
        };
        let (mut inputs, mut latches) = (Vec::new(), Vec::new());
        for (place, s) in system.inputs.iter().enumerate().filter(|(_, s)| is_in(**s)) {
            put(&mut map, *s, made.input());
            inputs.push(place);
        }
        for (place, l) in system.latches.iter().enumerate().filter(|(_, l)| is_in(l.signal)) {
            put(&mut map, l.signal, made.latch(Init::Zero));
            latches.push(place);
        }
        let of = |map: &[Signal], s: Signal| {
            map.get(s.node() as usize).map_or(Signal::FALSE, |m| m.negated_if(s.is_negated()))
        };
        let mut judged = Signal::FALSE;
        for (number, node) in (0u32..).zip(system.graph.nodes()) {
            if let (Node::And(a, b), true) = (node, is_in(Signal::of(number, false))) {
                let new = made.graph.and(of(&map, *a), of(&map, *b));
                put(&mut map, Signal::of(number, false), new);
            }
            if let Some(guard) = guard_of.filter(|g| g.node() == number) {
                judged = of(&map, guard);
                put(&mut map, guard, Signal::FALSE);
            }
        }
        let next = latches.iter().filter_map(|l| system.latches.get(*l)).map(|l| of(&map, l.next)).collect();
        let list = |list: &[Signal]| -> Vec<Signal> { list.iter().map(|s| of(&map, *s)).collect() };
        let lists = [next, list(&system.constraints), list(asked), vec![judged]];
        let (gates, codes) = coded(&made, &lists);
        let [next, constraints, asked, guard] = codes;
        let is_bound = guard_of.is_none_or(|g| !within(system, &system.constraints, g));
        Program {
            inputs,
            latches,
            gates,
            next,
            constraints,
            asked,
            guard: guard.first().copied().unwrap_or(0),
            is_bound,
        }
    }

    fn first_gate(&self) -> usize {
        1 + self.inputs.len() + self.latches.len()
    }

    /// Evaluates all gates; `set` gives the latches and the inputs their values.
    pub(super) fn evaluate(&self, values: &mut Plain, set: impl FnOnce(&mut [Lanes], &mut [Lanes])) {
        let list = &mut values.0;
        list.clear();
        list.resize(self.first_gate(), NONE);
        if let Some((inputs, latches)) =
            list.get_mut(1..).and_then(|l| l.split_at_mut_checked(self.inputs.len()))
        {
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
        for code in self.next.iter().chain(&self.constraints).chain(&self.asked).chain([&self.guard]) {
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

/// True if some of these signals reads another in the same step.
fn within(system: &System, of: &[Signal], read: Signal) -> bool {
    let mut seen = vec![false; system.graph.nodes().len()];
    let mut work = of.to_vec();
    while let Some(s) = work.pop() {
        if s.node() == read.node() {
            return true;
        }
        if let (Some(slot), Node::And(a, b)) = (seen.get_mut(s.node() as usize), system.graph.node(s))
            && !std::mem::replace(slot, true)
        {
            work.extend([a, b]);
        }
    }
    false
}

/// The gates on which these signals depend, and the codes of the signals. The inputs and latches are those of
/// the system, in order.
fn coded<const N: usize>(system: &System, lists: &[Vec<Signal>; N]) -> (Vec<[u32; 2]>, [Vec<u32>; N]) {
    let nodes = system.graph.nodes();
    let mut used = vec![false; nodes.len()];
    let mark = |used: &mut Vec<bool>, s: Signal| {
        used.get_mut(s.node() as usize).into_iter().for_each(|u| *u = true);
    };
    lists.iter().flatten().for_each(|s| mark(&mut used, *s));
    for (k, node) in nodes.iter().enumerate().rev() {
        if let (Node::And(a, b), Some(true)) = (node, used.get(k)) {
            mark(&mut used, *a);
            mark(&mut used, *b);
        }
    }
    let mut codes = vec![0u32; nodes.len()];
    let code = |codes: &[u32], s: Signal| {
        codes.get(s.node() as usize).copied().unwrap_or(0) ^ u32::from(s.is_negated())
    };
    let mut gates = Vec::new();
    let first = 1 + system.inputs.len() + system.latches.len();
    for (k, node) in nodes.iter().enumerate() {
        let place = match node {
            Node::False => 0,
            Node::Input(i) => 1 + *i as usize,
            Node::Latch(l) => 1 + system.inputs.len() + *l as usize,
            Node::And(a, b) if used.get(k) == Some(&true) => {
                gates.push([code(&codes, *a), code(&codes, *b)]);
                first + gates.len() - 1
            }
            Node::And(..) => continue,
        };
        codes.get_mut(k).into_iter().for_each(|c| *c = 2 * place as u32);
    }
    let of = |list: &Vec<Signal>| list.iter().map(|s| code(&codes, *s)).collect();
    (gates, lists.each_ref().map(of))
}

impl Plain {
    /// The values of a code.
    #[inline(always)]
    pub(super) fn get(&self, code: u32) -> Lanes {
        at(&self.0, code)
    }

    /// Patterns in which some latch changes.
    pub(super) fn moved(&self, p: &Program) -> Lanes {
        let mut moved = NONE;
        for (next, place) in p.next.iter().zip(1 + p.inputs.len() as u32..) {
            let change = both(self.get(*next), self.get(place * 2), |a, b| a ^ b);
            moved = both(moved, change, |a, b| a | b);
        }
        moved
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
    match list.get(code as usize / 2) {
        Some(lanes) => negated(*lanes, code),
        None => negated(NONE, code),
    }
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
