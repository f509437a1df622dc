//! States in which no inputs satisfy the constraints. A run ends there, so "no run shows it"
//! would say less than it seems to.
//!
//! A few vectors of inputs are tried in every state at once: is there a state in which none of
//! them satisfies the constraints? If there is one, the solver looks for a vector that does,
//! which is tried too from then on, until none is left to be found or none is needed.

use crate::sat::cnf::{Start, Steps};
use crate::sat::decide::{Effort, Found, decide};
use crate::sat::graph::{Init, Signal, System};
use crate::sat::simulate::{Trace, evaluate};
use crate::sat::solver::{Answer, Batsat, Solver};
use crate::sat::unrolled::Unrolled;

/// Most vectors of inputs that are tried.
const MOST: usize = 24;

/// The answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ends {
    /// In every state that is reached some inputs satisfy the constraints.
    None,
    /// Behind a run of so many steps no inputs do.
    Behind(usize),
    /// Not decided.
    Open,
}

/// Looks for states in which no inputs satisfy the constraints.
pub fn ends(system: &System, effort: &Effort<'_>) -> Ends {
    if system.constraints.is_empty() {
        return Ends::None;
    }
    // Without constraints, but with a latch that says that they have held so far.
    let mut open = system.clone();
    let kept = open.latch(Init::One);
    let constraints = std::mem::take(&mut open.constraints);
    let whole = open.graph.all(constraints);
    let next = open.graph.and(kept, whole);
    open.set_next(kept, next);
    let mut vectors = vec![vec![false; system.inputs.len()]];
    let mut bad = kept;
    while vectors.len() <= MOST {
        let Some(vector) = vectors.last() else { break };
        let given = [vector.clone()];
        let mut unrolled = Unrolled::new(&given);
        let all = system.constraints.iter();
        let all: Vec<Signal> = all.map(|c| unrolled.signal(system, &mut open.graph, 0, *c)).collect();
        let holds = open.graph.all(all);
        bad = open.graph.and(bad, !holds);
        match decide(&open, &[bad], effort).into_iter().next() {
            Some(Found::Never(_)) => return Ends::None,
            Some(Found::Reached(trace)) => match satisfying(system, &state(&open, &trace), effort) {
                Some(Some(vector)) => vectors.push(vector),
                Some(None) => return Ends::Behind(trace.inputs.len() - 1),
                None => break,
            },
            Some(Found::Open(_)) | None => break,
        }
    }
    Ends::Open
}

/// The latches at the last step of a run.
pub(crate) fn state(system: &System, trace: &Trace) -> Vec<bool> {
    let word = |b: &bool| u64::from(*b);
    let mut latches: Vec<u64> = trace.latches.iter().map(word).collect();
    for inputs in trace.inputs.iter().take(trace.inputs.len().saturating_sub(1)) {
        let inputs: Vec<u64> = inputs.iter().map(word).collect();
        let values = evaluate(&system.graph, &latches, &inputs);
        latches = system.latches.iter().map(|l| values.get(l.next)).collect();
    }
    latches.iter().map(|w| w & 1 != 0).collect()
}

/// Inputs that satisfy the constraints in a state; no answer if the solver was stopped.
fn satisfying(system: &System, latches: &[bool], effort: &Effort<'_>) -> Option<Option<Vec<bool>>> {
    let mut solver = Batsat::new(effort.stop);
    let steps = Steps::new(system, &mut solver, Start::Any, true);
    let known = system.latches.iter().zip(latches);
    let assumed: Vec<_> =
        known.filter_map(|(l, v)| steps.get(0, l.signal).map(|s| s.negated_if(!v))).collect();
    match solver.solve(&assumed) {
        Answer::Stopped => None,
        Answer::No => Some(None),
        Answer::Yes => {
            let value = |s: &Signal| steps.get(0, *s).is_some_and(|l| solver.value(l));
            Some(Some(system.inputs.iter().map(value).collect()))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn effort() -> Effort<'static> {
        Effort { bytes: 1 << 28, turns: 30, stop: &|| false }
    }

    /// A counter of two bits, and two inputs.
    fn counter() -> (System, [Signal; 2], [Signal; 2]) {
        let mut s = System::default();
        let (a, b) = (s.input(), s.input());
        let (low, high) = (s.latch(Init::Zero), s.latch(Init::Zero));
        let carry = s.graph.xor(low, high);
        s.set_next(low, !low);
        s.set_next(high, carry);
        (s, [a, b], [low, high])
    }

    #[test]
    fn constraints_that_inputs_can_always_satisfy() {
        let (mut s, [a, b], [low, high]) = counter();
        assert_eq!(ends(&s, &effort()), Ends::None);
        // a follows one bit, b is the opposite of the other.
        let (first, second) = (s.graph.equal(a, low), s.graph.xor(b, high));
        s.constraints.extend([first, second]);
        assert_eq!(ends(&s, &effort()), Ends::None);
    }

    #[test]
    fn constraints_that_no_inputs_satisfy_at_last() {
        let (mut s, [a, b], [low, high]) = counter();
        // Both inputs are wanted at 3, and never together.
        let three = s.graph.and(low, high);
        let both = s.graph.and(a, b);
        let wanted = s.graph.implies(three, both);
        s.constraints.extend([wanted, !both]);
        assert_eq!(ends(&s, &effort()), Ends::Behind(3));
        s.constraints.push(Signal::FALSE);
        assert_eq!(ends(&s, &effort()), Ends::Behind(0));
    }

    #[test]
    fn a_state_that_the_constraints_keep_out_does_not_count() {
        let (mut s, [a, _], [low, high]) = counter();
        // At 1 the run ends already.
        let one = s.graph.and(low, !high);
        let two = s.graph.and(!low, high);
        s.constraints.push(!two);
        assert_eq!(ends(&s, &effort()), Ends::Behind(2));
        s.constraints.push(!one);
        assert_eq!(ends(&s, &effort()), Ends::Behind(1));
        let halt = s.graph.or(one, a);
        s.constraints = vec![halt];
        assert_eq!(ends(&s, &effort()), Ends::None);
    }
}
