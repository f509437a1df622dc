//! States that wait for something and cannot reach it any more.
//!
//! For a proof, a few sequences of inputs are tried in every state at once: is there a state that waits and
//! in which none of them reaches the goal? If there is one, the solver looks for a sequence that does, which
//! is tried too from then on. If it finds none, the state may be a trap: then no run from there reaches the goal,
//! which is proved as for any other signal, or by the caller with a search.
//!
//! Time passes without a bound on it: while some inputs are held, a state without a way to the goal comes
//! to rest, if each memory only rises or only falls there. Then only states at rest are asked about, in
//! which all timers are over. That memories do so is asked of the solver, for all states.

use crate::sat::cnf::{Start, Steps};
use crate::sat::cone::cone;
use crate::sat::dead::state;
use crate::sat::decide::{Effort, Found, Proof, decide};
use crate::sat::graph::{Init, Node, Signal, System};
use crate::sat::simulate::{Trace, evaluate};
use crate::sat::solver::{Answer, Batsat, Literal, Solver};
use crate::sat::unrolled::Unrolled;

/// Most sequences of inputs that are tried.
const MOST: usize = 40;
/// Most steps of one.
const LONGEST: usize = 12;
/// Steps with inputs held, behind which a memory only rises or only falls.
const SETTLING: usize = 3;
/// Nodes beyond which no sequence is added.
const NODES: usize = 1_000_000;

/// The question.
pub(crate) struct Trap<'a> {
    /// A function of the latches: the state waits.
    pub(crate) waits: Signal,
    /// The step reaches what is waited for.
    pub(crate) goal: Signal,
    /// The step reaches it, or it is not known whether it does.
    pub(crate) may: Signal,
    /// Latches that make a number together, the lowest bit first.
    pub(crate) words: &'a [Vec<Signal>],
}

/// The clauses of an invariant.
pub(crate) type Clauses = Vec<Vec<Signal>>;

/// The answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    /// From each state that waits some steps lead to the goal; with the clauses of the proof.
    Always(Clauses),
    /// There is a trap behind this run: its last step begins in the trap.
    Trap(Trace),
    /// Not decided: no run of so many steps leads to a trap.
    Open(usize),
}

/// Looks for traps. `is_trap` judges the state in which the last step of a run begins. The constraints must
/// never run out of inputs.
pub(crate) fn traps(
    system: &System,
    trap: &Trap<'_>,
    effort: &Effort<'_>,
    is_trap: &mut dyn FnMut(&Trace) -> bool,
) -> Way {
    let held = vec![false; system.inputs.len()];
    let mut work = Work { system, trap, effort, open: system.clone(), none: trap.waits };
    if work.comes_to_rest(&held) {
        let rest = work.at_rest(&held);
        work.none = work.open.graph.and(work.none, rest);
    }
    let ones = vec![true; system.inputs.len()];
    let turn = |a: &[bool], b: &[bool]| [a, b, a, b].map(<[bool]>::to_vec);
    for first in [turn(&ones, &ones), turn(&held, &ones), turn(&ones, &held)] {
        work.try_also(&first);
    }
    let mut sure = 0;
    for _ in 0..MOST {
        if work.open.graph.nodes().len() > NODES {
            break;
        }
        match decide(&work.open, &[work.none], effort).into_iter().next() {
            Some(Found::Never(Proof::Invariant(clauses))) => return Way::Always(clauses),
            Some(Found::Never(Proof::Induction(_) | Proof::Visited { .. } | Proof::Diagram { .. })) => {
                return Way::Always(Vec::new());
            }
            Some(Found::Reached(trace)) => {
                sure = trace.inputs.len() - 1;
                match work.way(&state(&work.open, &trace)) {
                    Some(Some(sequence)) => work.try_also(&sequence),
                    Some(None) => match work.first_trap(&trace) {
                        Some(trace) => return Way::Trap(trace),
                        None if is_trap(&trace) => return Way::Trap(trace),
                        None => break,
                    },
                    None => break,
                }
            }
            Some(Found::Open(steps)) => return Way::Open(steps),
            None => break,
        }
    }
    Way::Open(sure)
}

struct Work<'a> {
    system: &'a System,
    trap: &'a Trap<'a>,
    effort: &'a Effort<'a>,
    /// The system with the signals of this question.
    open: System,
    /// 1 where none of the sequences reaches the goal.
    none: Signal,
}

impl Work<'_> {
    /// Excludes the states in which a sequence of inputs reaches the goal.
    fn try_also(&mut self, sequence: &[Vec<bool>]) {
        let mut unrolled = Unrolled::new(sequence);
        let graph = &mut self.open.graph;
        let mut reaches = Signal::FALSE;
        for step in (0..sequence.len()).rev() {
            let mut may = Vec::new();
            for c in &self.system.constraints {
                may.push(unrolled.signal(self.system, graph, step, *c));
            }
            let goal = unrolled.signal(self.system, graph, step, self.trap.goal);
            may.push(graph.or(goal, reaches));
            reaches = graph.all(may);
        }
        self.none = graph.and(self.none, !reaches);
    }

    /// The latches that the goal depends on, in any number of steps.
    fn latches(&self) -> Vec<usize> {
        let system = self.system;
        let roots = system.constraints.iter().copied().chain([self.trap.goal, self.trap.waits]);
        let inside = cone(system, roots);
        let all = system.latches.iter().enumerate();
        all.filter(|(_, l)| inside.get(l.signal.node() as usize) == Some(&true)).map(|(i, _)| i).collect()
    }

    /// 1 in the states that held inputs do not change.
    fn at_rest(&mut self, held: &[bool]) -> Signal {
        let latches = self.latches();
        let inputs = [held.to_vec()];
        let mut unrolled = Unrolled::new(&inputs);
        let mut same = Vec::new();
        for i in latches {
            let Some(latch) = self.system.latches.get(i) else { continue };
            let next = unrolled.signal(self.system, &mut self.open.graph, 0, latch.next);
            same.push(self.open.graph.equal(latch.signal, next));
        }
        self.open.graph.all(same)
    }

    /// True if these inputs are always allowed and, held for long, bring each state to rest that waits and does
    /// not reach the goal: behind a few steps each word only rises or only falls.
    fn comes_to_rest(&self, held: &[bool]) -> bool {
        let system = self.system;
        if !self.is_always_allowed(held) {
            return false;
        }
        let latches = self.latches();
        let mut solver = Batsat::new(self.effort.stop);
        solver.stop_at(1 << 22);
        let mut steps = Steps::new(system, &mut solver, Start::Any, true);
        for step in 0..=SETTLING + 1 {
            if step > 0 {
                steps.grow(system, &mut solver);
            }
            let waits = steps.literal(system, &mut solver, step, self.trap.waits);
            // A state that waits goes on to wait, if no goal is reached.
            if step == 1 && solver.solve(&[!waits]) != Answer::No {
                return false;
            }
            solver.add(&[waits]);
            if step <= SETTLING {
                for (signal, value) in system.inputs.iter().zip(held) {
                    let l = steps.literal(system, &mut solver, step, *signal);
                    solver.add(&[l.negated_if(!value)]);
                }
                let goal = steps.literal(system, &mut solver, step, self.trap.goal);
                solver.add(&[!goal]);
            }
        }
        let mut alone = vec![true; system.latches.len()];
        let place = |s: &Signal| match system.graph.node(*s) {
            Node::Latch(i) => Some(i as usize),
            Node::False | Node::Input(_) | Node::And(..) => None,
        };
        for word in self.trap.words {
            word.iter().filter_map(place).for_each(|i| alone.get_mut(i).into_iter().for_each(|a| *a = false));
        }
        let signal = |i: &usize| system.latches.get(*i).map_or(Signal::FALSE, |l| l.signal);
        let single = latches.iter().filter(|i| alone.get(**i) == Some(&true)).map(|i| vec![signal(i)]);
        let whole =
            self.trap.words.iter().filter(|w| w.iter().filter_map(place).any(|i| latches.contains(&i)));
        let words: Vec<Vec<Signal>> = single.chain(whole.cloned()).collect();
        words.iter().all(|word| {
            let mut row = |step| -> Vec<Literal> {
                word.iter().map(|s| steps.literal(system, &mut solver, step, *s)).collect()
            };
            let (before, behind) = (row(SETTLING), row(SETTLING + 1));
            let falls = less(&mut solver, &behind, &before);
            if solver.solve(&[falls]) == Answer::No {
                return true;
            }
            let rises = less(&mut solver, &before, &behind);
            solver.solve(&[rises]) == Answer::No
        })
    }

    fn is_always_allowed(&self, held: &[bool]) -> bool {
        if self.system.constraints.is_empty() {
            return true;
        }
        let mut open = self.system.clone();
        let inputs = [held.to_vec()];
        let mut unrolled = Unrolled::new(&inputs);
        let all: Vec<Signal> = self
            .system
            .constraints
            .iter()
            .map(|c| unrolled.signal(self.system, &mut open.graph, 0, *c))
            .collect();
        let bad = !open.graph.all(all);
        matches!(decide(&open, &[bad], self.effort).first(), Some(Found::Never(_)))
    }

    /// The shortest beginning of a run to a trap that leads there too; none if no trap was proved.
    fn first_trap(&self, trace: &Trace) -> Option<Trace> {
        let mut found = None;
        for steps in (1..=trace.inputs.len()).rev() {
            let inputs = trace.inputs.get(..steps)?.to_vec();
            let shorter = Trace { latches: trace.latches.clone(), inputs };
            let latches = state(&self.open, &shorter);
            if !self.is_trap(&latches) {
                break;
            }
            found = Some(shorter);
        }
        found
    }

    /// True if a state waits and a proof says that no run from it reaches the goal.
    fn is_trap(&self, latches: &[bool]) -> bool {
        let word: Vec<u64> = latches.iter().map(|b| u64::from(*b)).collect();
        if !evaluate(&self.system.graph, &word, &[]).bit(self.trap.waits) {
            return false;
        }
        let mut from = self.system.clone();
        for (latch, value) in from.latches.iter_mut().zip(latches) {
            latch.init = Init::from(*value);
        }
        matches!(decide(&from, &[self.trap.may], self.effort).first(), Some(Found::Never(_)))
    }

    /// Inputs with which a state reaches the goal; no answer if the solver was stopped.
    fn way(&self, latches: &[bool]) -> Option<Option<Vec<Vec<bool>>>> {
        let system = self.system;
        let mut solver = Batsat::new(self.effort.stop);
        let mut steps = Steps::new(system, &mut solver, Start::Any, false);
        for (l, value) in system.latches.iter().zip(latches) {
            let l = steps.literal(system, &mut solver, 0, l.signal);
            solver.add(&[l.negated_if(!value)]);
        }
        for step in 0..LONGEST {
            if step > 0 {
                steps.grow(system, &mut solver);
            }
            let goal = steps.literal(system, &mut solver, step, self.trap.goal);
            match solver.solve(&[goal]) {
                Answer::Stopped => return None,
                Answer::No => {}
                Answer::Yes => {
                    let value = |k: usize, s: Signal| steps.get(k, s).is_some_and(|l| solver.value(l));
                    let row = |k| system.inputs.iter().map(|s| value(k, *s)).collect();
                    return Some(Some((0..=step).map(row).collect()));
                }
            }
        }
        Some(None)
    }
}

/// 1 only if one number is less than another. The lowest bits come first.
fn less(solver: &mut Batsat<'_>, a: &[Literal], b: &[Literal]) -> Literal {
    // From the lowest bit on: less so far, where a higher bit does not decide otherwise.
    let mut so_far = solver.variable(true);
    solver.add(&[!so_far]);
    for (x, y) in a.iter().zip(b) {
        let new = solver.variable(true);
        // new -> (not x and y) or ((x = y) and so_far)
        solver.add(&[!new, !*x, *y]);
        solver.add(&[!new, so_far, !*x]);
        solver.add(&[!new, so_far, *y]);
        so_far = new;
    }
    so_far
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sat::brute::{Random, system};
    use std::collections::BTreeSet;

    fn effort() -> Effort<'static> {
        Effort { bytes: 1 << 28, turns: 16, stop: &|| false }
    }

    /// The states behind a state, each with whether the step reaches the goal.
    fn after(s: &System, goal: Signal, state: &[bool]) -> Vec<(Vec<bool>, bool)> {
        let latches: Vec<u64> = state.iter().map(|b| u64::from(*b)).collect();
        let mut found = Vec::new();
        for p in 0..1u64 << s.inputs.len() {
            let inputs: Vec<u64> = (0..s.inputs.len()).map(|i| p >> i & 1).collect();
            let values = evaluate(&s.graph, &latches, &inputs);
            if s.constraints.iter().all(|c| values.bit(*c)) {
                found.push((s.latches.iter().map(|l| values.bit(l.next)).collect(), values.bit(goal)));
            }
        }
        found
    }

    /// All states that are reached, and for each whether some run from it reaches the goal.
    fn all(s: &System, goal: Signal) -> Vec<(Vec<bool>, bool)> {
        let after = |state: &Vec<bool>| after(s, goal, state);
        let first: Vec<bool> = s.latches.iter().map(|l| l.init.value() == Some(true)).collect();
        let mut seen = BTreeSet::from([first.clone()]);
        let mut work = vec![first];
        while let Some(state) = work.pop() {
            for (next, _) in after(&state) {
                if seen.insert(next.clone()) {
                    work.push(next);
                }
            }
        }
        let states: Vec<Vec<bool>> = seen.into_iter().collect();
        let mut good = vec![false; states.len()];
        loop {
            let before = good.clone();
            for (i, state) in states.iter().enumerate() {
                let on = |(next, goal): &(Vec<bool>, bool)| {
                    *goal || states.binary_search(next).is_ok_and(|k| before[k])
                };
                good[i] |= after(state).iter().any(on);
            }
            if good == before {
                return states.into_iter().zip(good).collect();
            }
        }
    }

    #[test]
    fn answers_are_those_of_all_states() {
        let (mut proved, mut found, mut open, mut bound) = (0, 0, 0, 0);
        let mut r = Random(9);
        for seed in 0..1500 {
            let (s, goal) = system(seed);
            if s.latches.iter().any(|l| l.init == Init::Free) {
                continue;
            }
            let waits = s.latches[r.below(s.latches.len())].signal.negated_if(r.below(2) == 1);
            let states = all(&s, goal);
            // The constraints must never run out of inputs.
            if states.iter().any(|(state, _)| after(&s, goal, state).is_empty()) {
                continue;
            }
            bound += usize::from(!s.constraints.is_empty());
            let bit = |state: &Vec<bool>| {
                let Node::Latch(i) = s.graph.node(waits) else { return false };
                state[i as usize] != waits.is_negated()
            };
            let is_bad =
                |state: &Vec<bool>| bit(state) && states.iter().any(|(other, good)| other == state && !good);
            let expected = states.iter().any(|(state, _)| is_bad(state));
            let trap = Trap { waits, goal, may: goal, words: &[] };
            let mut judged = |trace: &Trace| is_bad(&state(&s, trace));
            // By a proof alone, or with the help of the caller.
            if let Way::Trap(trace) = traps(&s, &trap, &effort(), &mut |_| false) {
                assert!(is_bad(&state(&s, &trace)), "seed {seed}");
            }
            match traps(&s, &trap, &effort(), &mut judged) {
                Way::Always(_) => {
                    assert!(!expected, "seed {seed}");
                    proved += 1;
                }
                Way::Trap(trace) => {
                    assert!(is_bad(&state(&s, &trace)), "seed {seed}");
                    found += 1;
                }
                Way::Open(_) => open += 1,
            }
        }
        assert!(proved > 100 && found > 100 && open < proved + found, "{proved} {found} {open}");
        assert!(bound > 20, "{bound} with constraints");
    }
}
