//! The checker of proofs. It shares no code with the engines that find them but the graph,
//! the clauses of one step and the solver, of which it has one of its own.
//!
//! Cubes that no run reaches are certified in turn: each list holds at the first step, and is
//! kept by each step together with those that were certified before. A signal that cannot
//! be 1 outside of them is never 1. An induction begins outside of them.

use crate::sat::cnf::{Start, Steps};
use crate::sat::cone::{Cube, next, touches_start};
use crate::sat::graph::{Signal, System};
use crate::sat::solver::{Answer, Batsat, Literal, Solver};

/// A checker, with what it has certified so far.
pub(crate) struct Checker<'a> {
    system: &'a System,
    solver: Batsat<'a>,
    steps: Steps,
    certified: Vec<Cube>,
    stop: &'a (dyn Fn() -> bool + Sync),
}

impl<'a> Checker<'a> {
    /// A checker that has certified nothing.
    pub(crate) fn new(system: &'a System, stop: &'a (dyn Fn() -> bool + Sync)) -> Checker<'a> {
        let mut solver = Batsat::new(stop);
        let steps = Steps::new(system, &mut solver, Start::Any, true);
        Checker { system, solver, steps, certified: Vec::new(), stop }
    }

    fn literal(&mut self, s: Signal) -> Literal {
        self.steps.literal(self.system, &mut self.solver, 0, s)
    }

    /// Checks that no state of a run lies in one of these cubes, or in one certified before, and that then
    /// the signal is never 1. If so, the cubes are certified too. If the solver was stopped, the answer is false.
    pub(crate) fn certifies(&mut self, cubes: &[Cube], bad: Signal) -> bool {
        let system = self.system;
        if cubes.iter().any(|cube| touches_start(system, cube)) {
            return false;
        }
        // For this question alone until it is answered.
        let switch = self.solver.variable(true);
        for cube in cubes {
            let mut clause: Vec<Literal> = cube.iter().map(|s| !self.literal(*s)).collect();
            clause.push(!switch);
            self.solver.add(&clause);
        }
        let is_kept = cubes.iter().all(|cube| {
            let mut entered = vec![switch];
            entered.extend(cube.iter().map(|s| self.literal(next(system, *s))));
            self.solver.solve(&entered) == Answer::No
        });
        let bad = self.literal(bad);
        let certified = is_kept && self.solver.solve(&[switch, bad]) == Answer::No;
        self.solver.add(&[switch.negated_if(!certified)]);
        if certified {
            self.certified.extend_from_slice(cubes);
        }
        certified
    }

    /// True if a signal is 0 at the first steps, so many of them, and a signal that is 0 at so many steps, the first
    /// of them outside of all cubes that were certified, is 0 at the next.
    pub(crate) fn certifies_induction(&self, bad: Signal, depth: usize) -> bool {
        let system = self.system;
        let shows = |start: Start| {
            let mut solver = Batsat::new(self.stop);
            let mut steps = Steps::new(system, &mut solver, start, true);
            let count = if start == Start::First { depth } else { depth + 1 };
            (1..count).for_each(|_| steps.grow(system, &mut solver));
            let bad: Vec<Literal> = (0..count).map(|k| steps.literal(system, &mut solver, k, bad)).collect();
            match bad.split_last() {
                Some((last, before)) if start == Start::Any => {
                    before.iter().for_each(|l| solver.add(&[!*l]));
                    solver.add(&[*last]);
                    for cube in &self.certified {
                        let outside: Vec<Literal> =
                            cube.iter().map(|s| !steps.literal(system, &mut solver, 0, *s)).collect();
                        solver.add(&outside);
                    }
                }
                _ => solver.add(&bad),
            }
            solver.solve(&[])
        };
        depth > 0 && shows(Start::First) == Answer::No && shows(Start::Any) == Answer::No
    }
}

/// Checks a set of states. `here` is 1 if the state is in the set, `behind` if the state after the step is. True if the
/// first state is in the set, no step leads out of it, and none of the signals `never` is 1 in it. False if the solver
/// was stopped by the caller or by the limit of ticks.
#[cfg(not(target_family = "wasm"))]
pub(crate) fn keeps(
    system: &System,
    here: Signal,
    behind: Signal,
    never: &[Signal],
    ticks: u64,
    stop: &(dyn Fn() -> bool + Sync),
) -> bool {
    let solves = |start: Start, signals: &[Signal]| {
        let mut solver = Batsat::new(stop);
        solver.stop_at(ticks);
        let mut steps = Steps::new(system, &mut solver, start, true);
        let literals: Vec<Literal> =
            signals.iter().map(|s| steps.literal(system, &mut solver, 0, *s)).collect();
        if start == Start::Any {
            let is_here = steps.literal(system, &mut solver, 0, here);
            solver.add(&[is_here]);
        }
        solver.add(&literals);
        solver.solve(&[])
    };
    // `stop` is asked here too, because a solver that has nothing to decide never asks it. If no inputs satisfy the
    // constraints in the first state, there are no runs at all, and the first question is answered *No*.
    !stop()
        && solves(Start::First, &[!here]) == Answer::No
        && solves(Start::Any, &[!behind]) == Answer::No
        && (never.is_empty() || solves(Start::Any, never) == Answer::No)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sat::graph::Init;

    /// Two bits that exchange their values.
    fn swap() -> (System, [Signal; 2]) {
        let mut s = System::default();
        let (a, b) = (s.latch(Init::One), s.latch(Init::Zero));
        s.set_next(a, b);
        s.set_next(b, a);
        (s, [a, b])
    }

    #[test]
    fn a_right_certificate_is_accepted() {
        let (mut s, [a, b]) = swap();
        let both = s.graph.and(a, b);
        let mut checker = Checker::new(&s, &|| false);
        assert!(checker.certifies(&[vec![a, b]], both));
        assert!(checker.certifies(&[], both), "what was certified stays so");
        assert!(checker.certifies(&[vec![!a, !b]], Signal::FALSE));
    }

    #[test]
    fn a_wrong_certificate_is_refused() {
        let (mut s, [a, b]) = swap();
        let (both, one) = (s.graph.and(a, b), s.graph.or(a, b));
        let mut checker = Checker::new(&s, &|| false);
        assert!(!checker.certifies(&[], both), "nothing excludes it");
        assert!(!checker.certifies(&[vec![a]], both), "a is 1 at the first step");
        assert!(!checker.certifies(&[vec![b]], both), "b becomes 1");
        assert!(!checker.certifies(&[vec![a, b]], one), "it holds, but says nothing of this signal");
        assert!(!checker.certifies(&[], both), "what was refused does not stay");
        assert!(checker.certifies(&[vec![a, b]], both));
    }

    /// A third bit is 1 behind a step with both: one step does not show that this never happens, unless both are
    /// known to be never 1 at once.
    #[test]
    fn an_induction_begins_outside_of_what_was_certified() {
        let (mut s, [a, b]) = swap();
        let c = s.latch(Init::Zero);
        let both = s.graph.and(a, b);
        let next = s.graph.or(c, both);
        s.set_next(c, next);
        let mut checker = Checker::new(&s, &|| false);
        assert!(!checker.certifies_induction(c, 1));
        assert!(!checker.certifies(&[vec![b]], c), "it is refused, so it changes nothing");
        assert!(!checker.certifies_induction(c, 1));
        assert!(checker.certifies(&[vec![a, b]], both));
        assert!(checker.certifies_induction(c, 1));
        assert!(!checker.certifies_induction(a, 1), "it is 1 at the first step");
        assert!(!checker.certifies_induction(b, 1), "it becomes 1");
    }

    #[test]
    fn a_set_of_states_is_kept_or_not() {
        let (mut s, [a, b]) = swap();
        let g = &mut s.graph;
        let (both, one, none) = (g.and(a, b), g.xor(a, b), g.and(!a, !b));
        let keeps = |here, behind, never: &[Signal]| keeps(&s, here, behind, never, 1 << 20, &|| false);
        assert!(keeps(one, one, &[both, none]), "the same signal is 1 behind a step");
        assert!(keeps(Signal::TRUE, Signal::TRUE, &[]));
        assert!(!keeps(one, one, &[both, a]), "a is 1 in some state of the set");
        assert!(!keeps(none, none, &[both]), "the first state is not in it");
        assert!(!keeps(a, b, &[]), "a step leads out of it: a is 1, and behind the step it is what b was");
        assert!(!super::keeps(&s, one, one, &[both], 1 << 20, &|| true), "the solver was stopped");
    }

    #[test]
    fn a_checker_that_is_stopped_certifies_nothing() {
        let (mut s, [a, b]) = swap();
        let both = s.graph.and(a, b);
        // Enough cubes that it asks.
        let cubes = vec![vec![a, b]; 500];
        assert!(!Checker::new(&s, &|| true).certifies(&cubes, both));
    }
}
