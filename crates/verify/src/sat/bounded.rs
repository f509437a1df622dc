//! Bounded search: the first step at which a signal is 1, for many signals at once.

use crate::sat::cnf::{Start, Steps};
use crate::sat::cone::Cube;
use crate::sat::frames::Stopped;
use crate::sat::graph::{Signal, System};
use crate::sat::simulate::{Trace, evaluate};
use crate::sat::solver::{Answer, Batsat, Literal, Solver};

/// The search, which goes on where it was stopped.
pub(crate) struct Bounded<'a> {
    system: &'a System,
    solver: Batsat<'a>,
    steps: Steps,
    /// No run of so many steps shows a signal that is still asked for.
    done: usize,
}

impl<'a> Bounded<'a> {
    pub(crate) fn new(system: &'a System, stop: &'a (dyn Fn() -> bool + Sync)) -> Bounded<'a> {
        let mut solver = Batsat::new(stop);
        let steps = Steps::new(system, &mut solver, Start::First, false);
        Bounded { system, solver, steps, done: 0 }
    }

    /// No run of so many steps shows a signal that is still asked for.
    pub(crate) fn done(&self) -> usize {
        self.done
    }

    pub(crate) fn ticks(&self) -> u64 {
        self.solver.ticks()
    }

    pub(crate) fn bytes(&self) -> usize {
        self.solver.bytes() + self.steps.bytes()
    }

    /// Lets the search go on for so many ticks.
    pub(crate) fn allow(&mut self, ticks: u64) {
        self.solver.stop_at(self.solver.ticks() + ticks);
    }

    /// Looks one step further. `wanted` has a number for each signal; those that a run of so
    /// many steps shows are taken out and given with a run, which is a shortest one. No
    /// signal may be wanted that was not from the first step on.
    pub(crate) fn go_on(
        &mut self,
        wanted: &mut Vec<(usize, Signal)>,
    ) -> Result<Vec<(usize, Trace)>, Stopped> {
        let mut found = Vec::new();
        let step = self.done;
        if step == self.steps.len() {
            self.steps.grow(self.system, &mut self.solver);
        }
        while !wanted.is_empty() {
            let bad: Vec<Literal> = wanted
                .iter()
                .map(|(_, s)| self.steps.literal(self.system, &mut self.solver, step, *s))
                .collect();
            let switch = self.solver.variable(true);
            let mut clause = bad.clone();
            clause.push(!switch);
            self.solver.add(&clause);
            let answer = self.solver.solve(&[switch]);
            self.solver.add(&[!switch]);
            match answer {
                // A run that was found counts.
                Answer::Stopped if found.is_empty() => return Err(Stopped),
                Answer::Stopped => return Ok(found),
                Answer::No => {
                    bad.iter().for_each(|l| self.solver.add(&[!*l]));
                    break;
                }
                Answer::Yes => {
                    let trace = self.trace(step);
                    let shown = last_values(self.system, &trace);
                    let before = wanted.len();
                    wanted.retain(|(i, s)| {
                        let is_shown = shown.bit(*s);
                        found.extend(is_shown.then(|| (*i, trace.clone())));
                        !is_shown
                    });
                    if wanted.len() == before {
                        // Solver and simulator do not agree: no answer is better than a wrong one.
                        return Err(Stopped);
                    }
                }
            }
        }
        self.done += 1;
        Ok(found)
    }

    /// The run of the model.
    fn trace(&self, last: usize) -> Trace {
        let value = |step: usize, s: Signal| self.steps.get(step, s).is_some_and(|l| self.solver.value(l));
        let first = |l: &crate::sat::graph::Latch| l.init.value().unwrap_or_else(|| value(0, l.signal));
        Trace {
            latches: self.system.latches.iter().map(first).collect(),
            inputs: (0..=last)
                .map(|step| self.system.inputs.iter().map(|s| value(step, *s)).collect())
                .collect(),
        }
    }
}

/// All values at the last step of a run.
fn last_values(system: &System, trace: &Trace) -> crate::sat::simulate::Values {
    let word = |b: &bool| u64::from(*b);
    let mut latches: Vec<u64> = trace.latches.iter().map(word).collect();
    let mut values = crate::sat::simulate::Values::default();
    for inputs in &trace.inputs {
        let inputs: Vec<u64> = inputs.iter().map(word).collect();
        values = evaluate(&system.graph, &latches, &inputs);
        latches = system.latches.iter().map(|l| values.get(l.next)).collect();
    }
    values
}

/// Induction: a signal that is 0 at so many steps is 0 at the next one, whatever the first state was, but for
/// those of which it is known that no run reaches them. With a bounded search over the same number of steps that is
/// a proof.
pub(crate) struct Induction<'a> {
    system: &'a System,
    solver: Batsat<'a>,
    steps: Steps,
}

impl<'a> Induction<'a> {
    pub(crate) fn new(system: &'a System, stop: &'a (dyn Fn() -> bool + Sync)) -> Induction<'a> {
        let mut solver = Batsat::new(stop);
        let steps = Steps::new(system, &mut solver, Start::Any, false);
        Induction { system, solver, steps }
    }

    /// Lets the search go on for so many ticks.
    pub(crate) fn allow(&mut self, ticks: u64) {
        self.solver.stop_at(self.solver.ticks() + ticks);
    }

    /// No run reaches a state in one of these cubes. They are kept by each step, so it is enough that the first state
    /// is outside.
    pub(crate) fn exclude(&mut self, cubes: &[Cube]) {
        for cube in cubes {
            let outside: Vec<Literal> =
                cube.iter().map(|s| !self.steps.literal(self.system, &mut self.solver, 0, *s)).collect();
            self.solver.add(&outside);
        }
    }

    /// True if a signal that is 0 at so many steps is 0 at the next one.
    pub(crate) fn keeps(&mut self, bad: Signal, steps: usize) -> Result<bool, Stopped> {
        while self.steps.len() <= steps {
            self.steps.grow(self.system, &mut self.solver);
        }
        let mut assumed: Vec<Literal> =
            (0..steps).map(|k| !self.steps.literal(self.system, &mut self.solver, k, bad)).collect();
        assumed.push(self.steps.literal(self.system, &mut self.solver, steps, bad));
        match self.solver.solve(&assumed) {
            Answer::Stopped => Err(Stopped),
            answer => Ok(answer == Answer::No),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sat::brute::{shortest, system};
    use crate::sat::check::Checker;
    use crate::sat::simulate::shows;

    #[test]
    fn runs_are_the_shortest_ones() {
        let mut reached = 0;
        for seed in 0..3000 {
            let (s, bad) = system(seed);
            let mut search = Bounded::new(&s, &|| false);
            let mut wanted = vec![(7, bad), (8, !bad)];
            let mut found = Vec::new();
            for _ in 0..70 {
                found.extend(search.go_on(&mut wanted).unwrap_or_else(|_| panic!("nothing stops it")));
            }
            for (i, signal) in [(7, bad), (8, !bad)] {
                let mine = found.iter().find(|(n, _)| *n == i).map(|(_, t)| t);
                assert_eq!(mine.map(|t| t.inputs.len()), shortest(&s, signal), "seed {seed}");
                assert!(mine.is_none_or(|t| shows(&s, t, signal)), "seed {seed}");
                reached += usize::from(mine.is_some());
            }
        }
        assert!((500..5500).contains(&reached), "{reached}");
    }

    #[test]
    fn induction_over_one_step_is_not_always_enough() {
        // a follows b, b follows c, c stays: with all 0 at the start, a stays 0. From a state
        // with c alone, a is 0 twice before it is 1.
        let mut s = System::default();
        let [a, b, c] = [(); 3].map(|()| s.latch(false.into()));
        s.set_next(a, b);
        s.set_next(b, c);
        s.set_next(c, Signal::FALSE);
        let mut induction = Induction::new(&s, &|| false);
        let keeps: Vec<bool> =
            (1..5).map(|k| induction.keeps(a, k).unwrap_or_else(|_| panic!("nothing stops it"))).collect();
        assert_eq!(keeps, [false, false, true, true]);
        let checker = Checker::new(&s, &|| false);
        assert!(checker.certifies_induction(a, 3));
        assert!(!checker.certifies_induction(a, 2), "not deep enough");
        assert!(!checker.certifies_induction(a, 0));
        assert!(!checker.certifies_induction(!a, 3), "it is 1 at the first step");
        // Without the states in which c is 1, two steps are enough.
        induction.exclude(&[vec![c]]);
        assert!(matches!(induction.keeps(a, 1), Ok(false)));
        assert!(matches!(induction.keeps(a, 2), Ok(true)));
    }
}
