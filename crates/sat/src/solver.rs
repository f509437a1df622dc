//! A solver for clauses, behind a trait, so that another library can take its place.
//!
//! A solver is asked again and again, with other assumptions and more clauses each time. It
//! asks inside a call whether to stop, and counts what it does in *ticks* (decisions,
//! assumptions, conflicts and what follows from them, each with its weight). Ticks depend on the
//! clauses alone, never on a clock: work that is divided by them gives the same answers on every
//! machine.

use std::cell::Cell;
use std::ops::Not;

use batsat::{Callbacks, Lit, SolverInterface, SolverOpts, Var, lbool};

/// A variable of a solver or its negation: variable * 2, and 1 more if it is negated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Literal(u32);

impl Literal {
    /// The literal itself, or its negation where `negate` holds.
    #[must_use]
    pub fn negated_if(self, negate: bool) -> Literal {
        Literal(self.0 ^ u32::from(negate))
    }
}

impl Not for Literal {
    type Output = Literal;
    fn not(self) -> Literal {
        Literal(self.0 ^ 1)
    }
}

/// The answer of a solver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// There is a model: [`Solver::value`].
    Yes,
    /// There is none, because of some assumptions: [`Solver::is_needed`].
    No,
    /// The time is over, or the ticks are used up.
    Stopped,
}

/// A solver that can be asked again.
pub trait Solver {
    /// A new variable. One that follows from others by its clauses need not be decided.
    fn variable(&mut self, decide: bool) -> Literal;

    /// One of these is to be true.
    fn add(&mut self, clause: &[Literal]);

    /// Asks for a model in which all assumptions are true.
    fn solve(&mut self, assumptions: &[Literal]) -> Answer;

    /// The value of a literal in the model found last.
    fn value(&self, literal: Literal) -> bool;

    /// True if the last answer was [`Answer::No`] and this assumption was needed for it.
    fn is_needed(&self, assumption: Literal) -> bool;

    /// The work done so far.
    fn ticks(&self) -> u64;

    /// Bytes in use, about.
    fn bytes(&self) -> usize;

    /// From now on calls end with [`Answer::Stopped`] when [`Solver::ticks`] reaches this.
    fn stop_at(&mut self, ticks: u64);
}

/// Decisions between two questions whether to stop.
const PATIENCE: u32 = 32;
/// Ticks of a conflict, beside those for the literals of the clause that is learnt from it.
const CONFLICT: u64 = 16;
/// Literals that follow from others, or that stand in a new clause, for one tick.
const FOLLOWING: u64 = 16;
/// Decisions of the first part of a call.
const PART: u64 = 512;

/// Counts what the solver does, and tells it to stop.
struct Watch<'b> {
    stop: &'b (dyn Fn() -> bool + Sync),
    patience: Cell<u32>,
    stopped: Cell<bool>,
    ticks: Cell<u64>,
    most: Cell<u64>,
}

impl Callbacks for Watch<'_> {
    fn on_new_clause(&mut self, clause: &[Lit], _: batsat::ClauseKind) {
        self.ticks.set(self.ticks.get() + CONFLICT + clause.len() as u64);
    }

    /// Is called before each decision and each assumption.
    fn stop(&self) -> bool {
        let ticks = self.ticks.get() + 1;
        self.ticks.set(ticks);
        let left = self.patience.get();
        if left > 0 {
            self.patience.set(left - 1);
        } else {
            self.patience.set(PATIENCE);
            if (self.stop)() {
                self.stopped.set(true);
            }
        }
        self.stopped.get() || ticks >= self.most.get()
    }
}

/// The library `batsat`, a solver of the family of MiniSat.
pub struct Batsat<'b> {
    inner: batsat::Solver<Watch<'b>>,
    buffer: Vec<Lit>,
    literals: usize,
    most: u64,
}

impl<'b> Batsat<'b> {
    /// A solver without clauses.
    pub fn new(stop: &'b (dyn Fn() -> bool + Sync)) -> Batsat<'b> {
        let watch = Watch {
            stop,
            patience: Cell::new(PATIENCE),
            stopped: Cell::new(false),
            ticks: Cell::new(0),
            most: Cell::new(u64::MAX),
        };
        let options = SolverOpts { min_learnts_lim: 2000, ..SolverOpts::default() };
        Batsat { inner: batsat::Solver::new(options, watch), buffer: Vec::new(), literals: 0, most: u64::MAX }
    }
}

fn lit(literal: Literal) -> Lit {
    Lit::new(Var::unsafe_from_idx(literal.0 / 2), literal.0 & 1 == 0)
}

impl Solver for Batsat<'_> {
    fn variable(&mut self, decide: bool) -> Literal {
        Literal(self.inner.new_var(lbool::UNDEF, decide).idx() * 2)
    }

    fn add(&mut self, clause: &[Literal]) {
        self.buffer.clear();
        self.buffer.extend(clause.iter().map(|l| lit(*l)));
        self.literals += clause.len();
        // Without a model it answers No from now on.
        self.inner.add_clause_reuse(&mut self.buffer);
    }

    fn solve(&mut self, assumptions: &[Literal]) -> Answer {
        self.buffer.clear();
        self.buffer.extend(assumptions.iter().map(|l| lit(*l)));
        // The library shows decisions alone while it works, so it works in parts.
        let mut part = PART;
        loop {
            let left = self.most.saturating_sub(self.ticks());
            let watch = self.inner.cb();
            watch.most.set(watch.ticks.get().saturating_add(left.min(part)));
            if watch.stopped.get() || left == 0 {
                return Answer::Stopped;
            }
            match self.inner.solve_limited(&self.buffer) {
                answer if answer == lbool::TRUE => return Answer::Yes,
                answer if answer == lbool::FALSE => return Answer::No,
                _ => part = part.saturating_mul(2),
            }
        }
    }

    fn value(&self, literal: Literal) -> bool {
        self.inner.value_lit(lit(literal)) == lbool::TRUE
    }

    fn is_needed(&self, assumption: Literal) -> bool {
        self.inner.unsat_core_contains_lit(!lit(assumption))
    }

    fn ticks(&self) -> u64 {
        let quick = self.inner.num_propagations() + self.literals as u64;
        self.inner.cb().ticks.get() + quick / FOLLOWING
    }

    fn bytes(&self) -> usize {
        // Clauses with their two watches; what is kept of a variable; learnt clauses.
        self.literals * 24 + self.inner.num_vars() as usize * 96
    }

    fn stop_at(&mut self, ticks: u64) {
        self.most = ticks;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_models_and_needed_assumptions() {
        let mut s = Batsat::new(&|| false);
        let v: Vec<Literal> = (0..4).map(|_| s.variable(true)).collect();
        s.add(&[!v[0], v[1]]);
        s.add(&[!v[1], v[2]]);
        assert_eq!(s.solve(&[v[0]]), Answer::Yes);
        assert!(s.value(v[1]) && s.value(v[2]) && !s.value(!v[2]));
        assert_eq!(s.solve(&[v[3], v[0], !v[2]]), Answer::No);
        assert!(s.is_needed(v[0]) && s.is_needed(!v[2]) && !s.is_needed(v[3]));
        assert_eq!(s.solve(&[v[3]]), Answer::Yes);
        s.add(&[v[0]]);
        s.add(&[!v[2]]);
        assert_eq!(s.solve(&[]), Answer::No);
        assert!(!s.is_needed(v[3]));
    }

    /// Ten pigeons in nine holes: more work than a call is allowed here.
    fn pigeons(s: &mut Batsat<'_>) {
        let v: Vec<Vec<Literal>> = (0..10).map(|_| (0..9).map(|_| s.variable(true)).collect()).collect();
        v.iter().for_each(|row| s.add(row));
        for hole in 0..9 {
            for (i, a) in v.iter().enumerate() {
                v.iter().skip(i + 1).for_each(|b| s.add(&[!a[hole], !b[hole]]));
            }
        }
    }

    #[test]
    fn a_call_stops_when_its_caller_or_its_ticks_say_so() {
        let asked = std::sync::atomic::AtomicU32::new(0);
        let stop = || asked.fetch_add(1, std::sync::atomic::Ordering::Relaxed) >= 3;
        let mut s = Batsat::new(&stop);
        pigeons(&mut s);
        assert_eq!(s.solve(&[]), Answer::Stopped);
        assert_eq!(asked.load(std::sync::atomic::Ordering::Relaxed), 4);
        assert_eq!(s.solve(&[]), Answer::Stopped, "from then on it does nothing");

        let mut s = Batsat::new(&|| false);
        pigeons(&mut s);
        s.stop_at(100);
        assert_eq!(s.solve(&[]), Answer::Stopped);
        assert!((100..1000).contains(&s.ticks()), "{}", s.ticks());
        s.stop_at(2000);
        assert_eq!(s.solve(&[]), Answer::Stopped);
        assert!(s.ticks() >= 2000);
    }
}
