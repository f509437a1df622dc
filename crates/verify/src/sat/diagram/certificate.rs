//! Counts the states of a set, and turns the set into a signal of the system, so that a separate solver can check it.

use std::collections::HashMap;

use g7_sat::diagram::Function;

use super::functions::Functions;
use crate::sat::check::keeps;
use crate::sat::graph::{Signal, System};

/// A node of a diagram: a constant, or the variable that chooses between two nodes before it.
enum Row {
    Constant(bool),
    Choice(u32, usize, usize),
}

/// The nodes of a function, each behind its branches; the last one is the function.
fn rows(set: &Function) -> Vec<Row> {
    let (mut places, mut rows) = (HashMap::new(), Vec::new());
    let mut work = vec![set.clone()];
    while let Some(top) = work.last().cloned() {
        let row = match top.branches() {
            _ if places.contains_key(&top) => None,
            None => Some(Row::Constant(!top.is_none())),
            Some((variable, one, zero)) => match (places.get(&one), places.get(&zero)) {
                (Some(a), Some(b)) => Some(Row::Choice(variable, *a, *b)),
                (a, b) => {
                    let (a, b) = (a.is_none().then_some(one), b.is_none().then_some(zero));
                    work.extend(a.into_iter().chain(b));
                    continue;
                }
            },
        };
        work.pop();
        if let Some(row) = row {
            places.insert(top, rows.len());
            rows.push(row);
        }
    }
    rows
}

/// The number of states in a set; nothing if it does not fit.
pub(super) fn count(f: &Functions<'_>, set: &Function) -> Option<u128> {
    // A variable that a branch skips may have either value, so it doubles the number of states.
    let mut variables: Vec<u32> = f.latches.values().copied().collect();
    variables.sort_unstable();
    let level = |variable: u32| variables.binary_search(&variable).unwrap_or_else(|at| at);
    let mut counted: Vec<(usize, u128)> = Vec::new();
    for row in rows(set) {
        let new = match row {
            Row::Constant(value) => (variables.len(), u128::from(value)),
            Row::Choice(variable, one, zero) => {
                let here = level(variable);
                let states = |branch: usize| {
                    let (at, n) = *counted.get(branch)?;
                    scaled(n, at.checked_sub(here + 1)?)
                };
                (here, states(one)?.checked_add(states(zero)?)?)
            }
        };
        counted.push(new);
    }
    let (at, n) = *counted.last()?;
    scaled(n, at)
}

/// A number, doubled so often.
fn scaled(n: u128, times: usize) -> Option<u128> {
    if n == 0 {
        return Some(0);
    }
    let factor = u32::try_from(times).ok().and_then(|t| 1u128.checked_shl(t))?;
    n.checked_mul(factor)
}

/// The system with two signals more: the state is in the set, and the state behind the scan is.
fn with_set(f: &Functions<'_>, set: &Function) -> (System, [Signal; 2]) {
    let mut system = f.system.clone();
    let rows = rows(set);
    let of_latch: HashMap<u32, usize> = f.latches.iter().map(|(l, v)| (*v, *l)).collect();
    let signals = [false, true].map(|behind| {
        let mut made: Vec<Signal> = Vec::with_capacity(rows.len());
        for row in &rows {
            let new = match row {
                Row::Constant(value) => Signal::from(*value),
                Row::Choice(variable, one, zero) => {
                    let of = |at: &usize| made.get(*at).copied().unwrap_or(Signal::FALSE);
                    let latch = of_latch.get(variable).and_then(|l| f.system.latches.get(*l));
                    let choice = latch.map_or(Signal::FALSE, |l| if behind { l.next } else { l.signal });
                    system.graph.mux(choice, of(one), of(zero))
                }
            };
            made.push(new);
        }
        made.last().copied().unwrap_or(Signal::FALSE)
    });
    (system, signals)
}

/// True if a solver agrees, within so many ticks: the first state is in the set, no scan leads out of it, and in its
/// states none of these signals is 1.
pub(super) fn is_checked(
    f: &Functions<'_>,
    set: &Function,
    never: &[Signal],
    ticks: u64,
    stop: &(dyn Fn() -> bool + Sync),
) -> bool {
    let (system, [here, behind]) = with_set(f, set);
    keeps(&system, here, behind, never, ticks, stop)
}
