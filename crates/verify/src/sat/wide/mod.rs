//! A search for all states of a system at once for several hundred scans, where a chart has more states than
//! a search with the engine visits in the time, and a solver finds no reason.
//!
//! ```text
//! System, Signals -> program (gates in order) -> expand (inputs that matter, 512 scans at a time: lanes)
//!                                             -> search (levels, threads) -> set -> Wide
//! ```
//!
//! # Invariants
//!
//! - Two states are one only if all their bits agree.
//! - *Never* is said only after all states were expanded by all combinations of inputs that matter, and a
//!   sample of them was tried again by [`evaluate`] with inputs at random: each led to a state that was visited.
//! - A run is given only if [`shows`] repeats it. None is shorter.
//! - The answers do not depend on the number of threads.

mod expand;
mod lanes;
mod program;
mod search;
mod set;
#[cfg(test)]
mod tests;
mod wanted;

use crate::layer::Budget;
use crate::reason::Reason;
use crate::sat::dead::Ends;
use crate::sat::decide::{Found, Proof};
use crate::sat::graph::{Signal, System};
use crate::sat::simulate::{Trace, evaluate, random, shows};
use program::Program;
use search::Search;
pub use wanted::Tries;
pub(crate) use wanted::Wanted;

/// States of which moves at random are tried again.
const SAMPLE: usize = 512;
/// Most words of a state.
const WIDEST: usize = 64;

/// The result of a search.
#[derive(Clone, Debug)]
pub(crate) struct Wide {
    /// For each signal.
    pub(crate) found: Vec<Found>,
    /// States in which no inputs satisfy the constraints in all states.
    pub(crate) ends: Ends,
    /// Number of states, the first included.
    pub(crate) states: usize,
    /// Number of scans made.
    pub(crate) scans: usize,
    /// Levels that were expanded: fewest steps to the state that is farthest away, and one more.
    pub(crate) depth: usize,
    /// Bytes in which the states are kept and found, and those for the runs.
    pub(crate) bytes: [usize; 2],
    /// Why not all states were visited.
    pub(crate) open: Option<Reason>,
}

/// Searches all states. Nothing where the system has states that begin with any value, or too many bits.
pub(crate) fn wide(system: &System, wanted: &Wanted<'_>, budget: &Budget<'_>) -> Option<Wide> {
    let Wanted { signals, guards, all, tries, .. } = *wanted;
    let stages = Program::stages(system, signals, guards, all);
    let program = stages.last()?;
    let mut start = vec![0u64; program.latches.len() / 64 + 1];
    for (k, latch) in program.latches.iter().enumerate() {
        let value = system.latches.get(*latch)?.init.value()?;
        *start.get_mut(k / 64)? |= u64::from(value) << (k % 64);
    }
    if start.len() > WIDEST {
        return None;
    }
    let mut search = Search::new(&stages, &start, wanted);
    search.run(budget, all);
    if search.is_whole() && tries == Tries::All && !is_closed(system, signals, program, &search) {
        search.open = Some(Reason::NotRepeated);
    }
    let whole = search.is_whole();
    let found = signals.iter().enumerate().map(|(k, signal)| {
        let trace = search.run_to(k).map(|inputs| trace(system, program, &inputs));
        match trace.filter(|t| shows(system, t, *signal)) {
            Some(trace) => Found::Reached(trace),
            None if whole && !search.is_shown(k) => {
                Found::Never(Proof::Visited { states: search.states(), scans: search.scans })
            }
            None => Found::Open(search.depth),
        }
    });
    let found = found.collect();
    let ends = match search.stuck {
        Some(depth) => Ends::Behind(depth),
        None if whole => Ends::None,
        None => Ends::Open,
    };
    let bytes = search.bytes();
    Some(Wide {
        found,
        ends,
        states: search.states(),
        scans: search.scans,
        depth: search.depth,
        bytes: [bytes.0, bytes.1],
        open: search.open,
    })
}

/// A run with the values of all inputs and latches.
fn trace(system: &System, program: &Program, inputs: &[Vec<u64>]) -> Trace {
    let latches = system.latches.iter().map(|l| l.init.value() == Some(true)).collect();
    let vector = |words: &Vec<u64>| {
        let mut vector = vec![false; system.inputs.len()];
        for (k, place) in program.inputs.iter().enumerate() {
            if let (Some(to), Some(w)) = (vector.get_mut(*place), words.get(k / 64)) {
                *to = w >> (k % 64) & 1 != 0;
            }
        }
        vector
    };
    Trace { latches, inputs: inputs.iter().map(vector).collect() }
}

/// True if moves at random from some of the states lead to states that were visited, and show no signal
/// that no run is said to show. It reads the system itself, and all inputs are any.
fn is_closed(system: &System, signals: &[Signal], program: &Program, search: &Search<'_>) -> bool {
    let mut random = random();
    let width = program.latches.len() / 64 + 1;
    search.some(SAMPLE).all(|row| {
        let mut latches = vec![0; system.latches.len()];
        for (k, place) in program.latches.iter().enumerate() {
            if let (Some(to), Some(w)) = (latches.get_mut(*place), row.get(k / 64)) {
                *to = 0u64.wrapping_sub(w >> (k % 64) & 1);
            }
        }
        let inputs: Vec<u64> = system.inputs.iter().map(|_| random()).collect();
        let values = evaluate(&system.graph, &latches, &inputs);
        let valid = system.constraints.iter().fold(u64::MAX, |v, c| v & values.get(*c));
        let mut absent = signals.iter().enumerate().filter(|(k, _)| !search.is_shown(*k));
        if absent.any(|(_, s)| values.get(*s) & valid != 0) {
            return false;
        }
        let latches = program.latches.iter().filter_map(|l| system.latches.get(*l));
        let next: Vec<u64> = latches.map(|l| values.get(l.next)).collect();
        (0..64).filter(|k| valid >> k & 1 != 0).all(|pattern| {
            let mut row = vec![0u64; width];
            for (k, word) in next.iter().enumerate() {
                if let Some(to) = row.get_mut(k / 64) {
                    *to |= (word >> pattern & 1) << (k % 64);
                }
            }
            search.contains(&row)
        })
    })
}
