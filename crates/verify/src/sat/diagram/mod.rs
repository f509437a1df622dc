//! A search for all states of a system that handles sets of states, not single states. Each set is a decision
//! diagram. A chart of many sequences side by side has too many states to visit one by one, but often a small diagram.
//!
//! ```text
//! System -> order (of the variables) -> functions -> relation (one scan) -> levels -> certificate (count, check)
//!                                                                                  -> runs, backwards through them
//! ```
//!
//! # Invariants
//!
//! - Level `n` has exactly the states that `n` scans reach and fewer do not. So every run that is found is a shortest one.
//! - Guesses about the states (for example: two steps of a sequence are never active together) keep diagrams small.
//!   Each level is checked against them. If a level contradicts a guess, the guess is dropped and the search starts again.
//! - The answer is *never* only if all levels were made, and the solver of the checker confirmed the set or random
//!   runs stayed in it.
//! - A run is given only if [`shows`] repeats it.
//! - The result depends only on the system and on the room for nodes. Two exceptions: the caller stops the work, or
//!   the nodes run out before the library has removed unused ones.

mod certificate;
mod functions;
mod order;
mod relation;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use g7_sat::diagram::{Diagrams, Function};

use crate::layer::Budget;
use crate::sat::cone::{Cube, cone};
use crate::sat::dead::Ends;
use crate::sat::decide::{Found, Proof};
use crate::sat::graph::{Latch, Signal, System};
use crate::sat::simulate::{Trace, evaluate, random, shows};
use crate::sat::wide::{Tries, Wanted};
use certificate::{count, is_checked};
use functions::{Functions, Stop};
use order::order;
use relation::Relation;

/// The search gives up after this many levels. A time counted scan by scan has more; the zones answer such charts.
const LEVELS: usize = 4096;
/// If guesses were wrong, the search starts again with fewer of them, at most this many times. Then it starts with none.
const AGAIN: usize = 3;
/// Scans of the random runs (64 runs side by side) that must stay in the set if the solver did not check it.
const SAMPLES: usize = 64;

/// How much may be done.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effort {
    /// Room for this many nodes in all diagrams together.
    pub(crate) nodes: usize,
    /// The solver that checks the result stops after this many ticks.
    pub(crate) ticks: u64,
}

/// The result of a search.
#[derive(Clone, Debug)]
pub(crate) struct Seen {
    /// For each signal.
    pub(crate) found: Vec<Found>,
    /// States in which no inputs satisfy the constraints.
    pub(crate) ends: Ends,
    /// Number of states, the first included; nothing where there are more than fit.
    pub(crate) states: Option<u128>,
    /// Levels that were expanded.
    pub(crate) depth: usize,
    /// No state is left out.
    pub(crate) is_whole: bool,
}

/// Searches all states. `None` if a latch has no fixed initial value, or if the functions do not fit into the room.
/// `never` has cubes that the chart suggests are never reached; they are guesses and need not be true.
pub(crate) fn diagram(
    system: &System,
    wanted: &Wanted<'_>,
    never: &[Cube],
    effort: Effort,
    budget: &Budget<'_>,
) -> Option<Seen> {
    let Wanted { signals, guards, all, tries, .. } = *wanted;
    let more = system.latches.iter().filter(|_| all).map(|l| l.signal);
    let inside = cone(system, system.constraints.iter().chain(signals).copied().chain(more));
    let is_in = |s: Signal| inside.get(s.node() as usize) == Some(&true);
    if system.latches.iter().any(|l| is_in(l.signal) && l.init.value().is_none()) {
        return None;
    }
    let order = order(system, &inside, guards);
    let nodes = effort.nodes.min(budget.bytes / Diagrams::BYTES);
    let mut never: Vec<Cube> = never.iter().filter(|c| c.iter().all(|s| is_in(*s))).cloned().collect();
    let mut again = 0;
    loop {
        let made = Functions::new(system, &order, &never, tries == Tries::One, nodes, budget.stop);
        let made = made.and_then(|mut f| {
            let next = system.latches.iter().filter(|l| is_in(l.signal)).map(|l| l.next);
            f.make(&inside, next.chain(system.constraints.iter().chain(signals).copied()))?;
            let relation = Relation::new(&f)?;
            Ok((f, relation))
        });
        let (f, relation) = made.ok()?;
        let mut search = Search::new(&f, &relation, signals, all);
        match search.run() {
            // Too many guesses are wrong.
            Ok(Some(_)) if again == AGAIN => never.clear(),
            Ok(Some(outside)) => never
                .retain(|c| f.cube(c).and_then(|c| Ok(c.and(&outside)?)).is_ok_and(|both| both.is_none())),
            Ok(None) | Err(_) => return Some(search.seen(effort.ticks, budget)),
        }
        again += 1;
    }
}

/// A search level by level.
struct Search<'a> {
    f: &'a Functions<'a>,
    relation: &'a Relation,
    signals: &'a [Signal],
    all: bool,
    /// The states of each level that no earlier one has.
    levels: Vec<Function>,
    /// All states of the levels.
    reached: Function,
    /// For each signal the run that shows it.
    runs: Vec<Option<Trace>>,
    stuck: Option<usize>,
    is_whole: bool,
    /// For each variable of a latch the latch.
    of_variable: BTreeMap<u32, usize>,
}

impl<'a> Search<'a> {
    fn new(f: &'a Functions<'a>, relation: &'a Relation, signals: &'a [Signal], all: bool) -> Search<'a> {
        let reached = f.diagrams.constant(false);
        Search {
            f,
            relation,
            signals,
            all,
            levels: Vec::new(),
            reached,
            runs: vec![None; signals.len()],
            stuck: None,
            is_whole: false,
            of_variable: f.latches.iter().map(|(l, v)| (*v, *l)).collect(),
        }
    }

    /// Makes all levels. If a level contradicts the guesses, it stops there and returns the states that do.
    fn run(&mut self) -> Result<Option<Function>, Stop> {
        let mut level = self.f.cube(&self.start())?;
        let fed = self.relation.valid.exists(&self.relation.inputs)?;
        let asked: Result<Vec<Function>, Stop> =
            self.signals.iter().map(|s| Ok(self.f.get(*s)?.and(&self.relation.valid)?)).collect();
        let asked = asked?;
        while !level.is_none() {
            if self.levels.len() == LEVELS {
                return Err(Stop);
            }
            let outside = level.without(&self.f.thought)?;
            if !outside.is_none() {
                return Ok(Some(outside));
            }
            self.reached = self.reached.or(&level)?;
            if self.stuck.is_none() && !level.without(&fed)?.is_none() {
                self.stuck = Some(self.levels.len());
            }
            self.levels.push(level.clone());
            for k in 0..asked.len() {
                if let (Some(asked), Some(None)) = (asked.get(k), self.runs.get(k)) {
                    let run = self.shown(&level.and(asked)?)?;
                    self.runs.get_mut(k).into_iter().for_each(|slot| slot.clone_from(&run));
                }
            }
            if !self.all && !self.runs.is_empty() && self.runs.iter().all(Option::is_some) {
                return Ok(None);
            }
            self.f.look()?;
            level = self.relation.image(self.f, &level)?.without(&self.reached)?;
        }
        self.is_whole = true;
        Ok(None)
    }

    /// The values of all latches at the first step.
    fn start(&self) -> Cube {
        let latch = |l: &usize| self.f.system.latches.get(*l);
        let latches = self.f.latches.keys().filter_map(latch);
        latches.map(|l| l.signal.negated_if(l.init.value() != Some(true))).collect()
    }

    /// The run whose last step is one of these states of the last level, with its inputs.
    fn shown(&self, last: &Function) -> Result<Option<Trace>, Stop> {
        let Some(values) = last.pick() else { return Ok(None) };
        let mut inputs = vec![self.inputs(&values)];
        let mut row = self.row(&values);
        for level in self.levels.iter().rev().skip(1) {
            self.f.look()?;
            // The states of the level from which some inputs lead to this one.
            let mut before = level.and(&self.relation.valid)?;
            for (l, value) in &row {
                let next = self.f.system.latches.get(*l).map_or(Signal::FALSE, |l| l.next);
                before = before.and(&self.f.get(next.negated_if(!value))?)?;
            }
            let Some(values) = before.pick() else { return Ok(None) };
            inputs.push(self.inputs(&values));
            row = self.row(&values);
        }
        inputs.reverse();
        let latches = self.f.system.latches.iter().map(|l| l.init.value() == Some(true)).collect();
        Ok(Some(Trace { latches, inputs }))
    }

    fn inputs(&self, values: &[bool]) -> Vec<bool> {
        let value = |k: usize| self.f.inputs.get(&k).and_then(|v| values.get(*v as usize)) == Some(&true);
        (0..self.f.system.inputs.len()).map(value).collect()
    }

    fn row(&self, values: &[bool]) -> BTreeMap<usize, bool> {
        self.f.latches.iter().map(|(l, v)| (*l, values.get(*v as usize) == Some(&true))).collect()
    }

    fn seen(self, ticks: u64, budget: &Budget<'_>) -> Seen {
        let system = self.f.system;
        let states = count(self.f, &self.reached);
        let none = self.signals.iter().zip(&self.runs).filter(|(_, run)| run.is_none());
        let never: Vec<Signal> = none.map(|(s, _)| *s).collect();
        let nodes = self.reached.nodes();
        let checked = self.is_whole
            && !never.is_empty()
            && is_checked(self.f, &self.reached, &never, ticks, budget.stop);
        let is_sure = self.is_whole && (checked || self.is_closed(&never));
        let depth = self.levels.len();
        let found = self.signals.iter().zip(self.runs).map(|(signal, run)| match run {
            Some(run) if shows(system, &run, *signal) => Found::Reached(run),
            None if is_sure => Found::Never(Proof::Diagram { states, nodes, checked }),
            Some(_) | None => Found::Open(depth),
        });
        let ends = match self.stuck {
            Some(depth) => Ends::Behind(depth),
            None if self.is_whole => Ends::None,
            None => Ends::Open,
        };
        Seen { found: found.collect(), ends, states, depth, is_whole: self.is_whole }
    }

    /// True if random runs from the first state stay in the set and show none of these signals. The runs evaluate the
    /// graph of the system; they do not use the diagrams.
    fn is_closed(&self, never: &[Signal]) -> bool {
        let system = self.f.system;
        let mut random = random();
        let start = |l: &Latch| 0u64.wrapping_sub(u64::from(l.init.value() == Some(true)));
        let first: Vec<u64> = system.latches.iter().map(start).collect();
        let mut latches = first.clone();
        // Where the random inputs break a constraint, that run starts again from the first state.
        (0..SAMPLES).all(|_| {
            let inputs: Vec<u64> = system.inputs.iter().map(|_| random() & random()).collect();
            let values = evaluate(&system.graph, &latches, &inputs);
            let valid = system.constraints.iter().fold(u64::MAX, |v, c| v & values.get(*c));
            let next = system.latches.iter().zip(&first);
            latches = next.map(|(l, first)| values.get(l.next) & valid | first & !valid).collect();
            never.iter().all(|s| values.get(*s) & valid == 0) && (0..64).all(|k| self.has(&latches, k))
        })
    }

    /// True if the state of one pattern is in the set.
    fn has(&self, latches: &[u64], pattern: u32) -> bool {
        let mut at = self.reached.clone();
        while let Some((variable, one, zero)) = at.branches() {
            let latch = self.of_variable.get(&variable);
            let value = latch.and_then(|l| latches.get(*l)).is_some_and(|w| w >> pattern & 1 != 0);
            at = if value { one } else { zero };
        }
        !at.is_none()
    }
}
