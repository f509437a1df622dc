//! The clauses of the steps of a system: a variable for each node that was asked for and for
//! those below it, and the clauses that tie it to its operands. A latch behind the first step
//! has the literal of its next value in the step before, and needs no clauses.

use crate::sat::cone::next;
use crate::sat::graph::{Node, Signal, System};
use crate::sat::solver::{Literal, Solver};

/// The states in which the first step may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Start {
    /// Those of the system.
    First,
    /// All.
    Any,
}

/// Steps of a system in a solver, one behind the other.
pub(crate) struct Steps {
    start: Start,
    /// Conjunctions are decided too; else only latches and inputs, from which all follows.
    decide: bool,
    truth: Literal,
    /// For each step and node its literal, once it has one.
    literals: Vec<Vec<Option<Literal>>>,
}

impl Steps {
    /// One step, of which the solver knows that its constraints hold.
    pub(crate) fn new(system: &System, solver: &mut impl Solver, start: Start, decide: bool) -> Steps {
        let truth = solver.variable(true);
        solver.add(&[truth]);
        let mut steps = Steps { start, decide, truth, literals: Vec::new() };
        steps.grow(system, solver);
        steps
    }

    /// Number of steps.
    pub(crate) fn len(&self) -> usize {
        self.literals.len()
    }

    /// Bytes in use, about.
    pub(crate) fn bytes(&self) -> usize {
        self.literals.iter().map(Vec::len).sum::<usize>() * size_of::<Option<Literal>>()
    }

    /// Adds a step, in which the constraints hold.
    pub(crate) fn grow(&mut self, system: &System, solver: &mut impl Solver) {
        let mut row = vec![None; system.graph.nodes().len()];
        if let Some(first) = row.first_mut() {
            *first = Some(!self.truth);
        }
        self.literals.push(row);
        for c in &system.constraints {
            let c = self.literal(system, solver, self.literals.len() - 1, *c);
            solver.add(&[c]);
        }
    }

    /// The literal of a signal in a step, if it has one already.
    pub(crate) fn get(&self, step: usize, signal: Signal) -> Option<Literal> {
        let row = self.literals.get(step)?;
        let literal = row.get(signal.node() as usize).copied().flatten();
        literal.map(|l| l.negated_if(signal.is_negated()))
    }

    /// The literal of a signal in a step that is there. Clauses are added as needed.
    pub(crate) fn literal(
        &mut self,
        system: &System,
        solver: &mut impl Solver,
        step: usize,
        signal: Signal,
    ) -> Literal {
        let mut work = vec![(step, signal)];
        while let Some((step, top)) = work.last().copied() {
            if self.get(step, top).is_some() {
                work.pop();
                continue;
            }
            let literal = match system.graph.node(top) {
                Node::And(a, b) => match (self.get(step, a), self.get(step, b)) {
                    (Some(x), Some(y)) => {
                        let new = solver.variable(self.decide);
                        solver.add(&[!new, x]);
                        solver.add(&[!new, y]);
                        solver.add(&[new, !x, !y]);
                        new
                    }
                    (x, y) => {
                        work.extend(x.is_none().then_some((step, a)));
                        work.extend(y.is_none().then_some((step, b)));
                        continue;
                    }
                },
                Node::Latch(place) => match (step.checked_sub(1), self.start) {
                    (Some(before), _) => {
                        let next = next(system, Signal::of(top.node(), false));
                        match self.get(before, next) {
                            Some(literal) => literal,
                            None => {
                                work.push((before, next));
                                continue;
                            }
                        }
                    }
                    (None, Start::First) => {
                        let init = system.latches.get(place as usize).and_then(|l| l.init.value());
                        init.map_or_else(|| solver.variable(true), |v| self.truth.negated_if(!v))
                    }
                    (None, Start::Any) => solver.variable(true),
                },
                Node::False | Node::Input(_) => solver.variable(true),
            };
            work.pop();
            let row = self.literals.get_mut(step);
            if let Some(slot) = row.and_then(|r| r.get_mut(top.node() as usize)) {
                *slot = Some(literal);
            }
        }
        // The loop ends only when it has one.
        self.get(step, signal).unwrap_or(self.truth)
    }
}
