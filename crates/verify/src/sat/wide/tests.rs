//! The search beside one that tries each combination of inputs by itself, on random systems and on systems with
//! numbers.

use super::{Tries, Wanted, Wide, wide};
use crate::layer::Budget;
use crate::reason::Reason;
use crate::sat::brute::{Random, shortest, system};
use crate::sat::cone::cone;
use crate::sat::dead::Ends;
use crate::sat::graph::{Signal, System};
use crate::sat::simulate::shows;
use crate::sat::{Found, Proof};

fn budget() -> Budget<'static> {
    Budget { states: usize::MAX, scans: usize::MAX, bytes: usize::MAX, stop: &|| false }
}

/// The number of steps of the run, if there is one; the run is repeated.
fn steps(s: &System, signal: Signal, found: &Found) -> Option<usize> {
    match found {
        Found::Reached(trace) => {
            assert!(shows(s, trace, signal));
            Some(trace.inputs.len())
        }
        Found::Never(Proof::Visited { .. }) => None,
        other => panic!("{other:?}"),
    }
}

/// A system with more inputs than are tried together: numbers are compared and added up, and the constraint
/// couples them.
fn numbers(seed: u64) -> (System, Vec<Signal>) {
    let mut r = Random(seed);
    let mut s = System::default();
    let inputs: Vec<Signal> = (0..10).map(|_| s.input()).collect();
    let latches: Vec<Signal> = (0..5).map(|_| s.latch(false.into())).collect();
    let mut above = Signal::FALSE;
    let most = r.below(1024);
    // inputs > most, the lowest bit first.
    for (k, i) in inputs.iter().enumerate() {
        let same = if most >> k & 1 == 1 { s.graph.and(*i, above) } else { s.graph.or(*i, above) };
        above = same;
    }
    let some = s.graph.xor(inputs[r.below(10)], inputs[r.below(10)]);
    let (mut carry, step) = (s.graph.and(above, some), latches[r.below(5)]);
    for l in &latches {
        let (next, over) = (s.graph.xor(*l, carry), s.graph.and(*l, carry));
        s.set_next(*l, next);
        carry = over;
    }
    let kept = s.graph.implies(inputs[9], !inputs[r.below(9)]);
    let more = s.graph.implies(step, inputs[r.below(10)]);
    s.constraints = vec![kept, more];
    let all = s.graph.all(latches.iter().copied());
    let odd = s.graph.all([latches[0], !latches[1], latches[4], above]);
    (s, vec![all, odd, carry])
}

/// States that all inputs lead to, each by itself, and the least number of steps to each signal.
fn by_hand(s: &System, signals: &[Signal]) -> (usize, Vec<Option<usize>>, bool) {
    use crate::sat::simulate::evaluate;
    let mut seen = std::collections::BTreeSet::from([0u64]);
    let (mut level, mut first, mut depth, mut stuck) = (vec![0u64], vec![None; signals.len()], 0, false);
    while !level.is_empty() {
        depth += 1;
        let mut next = Vec::new();
        for state in level {
            let latches: Vec<u64> = (0..s.latches.len()).map(|k| 0u64.wrapping_sub(state >> k & 1)).collect();
            let mut fed = false;
            for pattern in 0..1u64 << s.inputs.len() {
                let inputs: Vec<u64> = (0..s.inputs.len()).map(|k| pattern >> k & 1).collect();
                let values = evaluate(&s.graph, &latches, &inputs);
                if s.constraints.iter().any(|c| !values.bit(*c)) {
                    continue;
                }
                fed = true;
                for (signal, first) in signals.iter().zip(&mut first) {
                    if first.is_none() && values.bit(*signal) {
                        *first = Some(depth);
                    }
                }
                let to = s.latches.iter().enumerate().map(|(k, l)| u64::from(values.bit(l.next)) << k).sum();
                if seen.insert(to) {
                    next.push(to);
                }
            }
            stuck |= !fed;
        }
        level = next;
    }
    (seen.len(), first, stuck)
}

#[test]
fn runs_are_the_shortest_and_no_state_is_left_out() {
    let (mut reached, mut never) = (0, 0);
    for seed in 0..3000 {
        let (s, bad) = system(seed);
        for (together, threads) in [(0, 1), (6, 1), (1, 3)] {
            let signals = [bad, !bad];
            let Some(seen) =
                wide(&s, &Wanted { together, ..Wanted::of(&signals, &[bad], threads) }, &budget())
            else {
                let inside = cone(&s, s.constraints.iter().copied().chain(signals));
                let is_in = |l: &Signal| inside[l.node() as usize];
                assert!(
                    s.latches.iter().any(|l| is_in(&l.signal) && l.init.value().is_none()),
                    "seed {seed}"
                );
                continue;
            };
            for (signal, found) in signals.iter().zip(&seen.found) {
                let mine = steps(&s, *signal, found);
                assert_eq!(
                    mine,
                    shortest(&s, *signal),
                    "seed {seed}, {together} together, {threads} threads"
                );
                reached += usize::from(mine.is_some());
                never += usize::from(mine.is_none());
            }
        }
    }
    assert!(reached > 1000 && never > 1000, "{reached} {never}");
}

#[test]
fn many_inputs_are_split_where_they_matter() {
    let mut scans = [0, 0];
    let mut seen = Vec::new();
    for seed in 0..60 {
        let (s, signals) = numbers(seed);
        let (states, first, stuck) = by_hand(&s, &signals);
        for (together, threads) in [(0, 1), (6, 1), (3, 2)] {
            let w = wide(
                &s,
                &Wanted { all: true, together, ..Wanted::of(&signals, &signals, threads) },
                &budget(),
            )
            .expect("it is small");
            assert_eq!(w.states, states, "seed {seed}");
            let mine: Vec<_> = signals.iter().zip(&w.found).map(|(s1, f)| steps(&s, *s1, f)).collect();
            assert_eq!(mine, first, "seed {seed}");
            assert_eq!(matches!(w.ends, Ends::Behind(_)), stuck, "seed {seed}");
            if together == 0 {
                scans[0] += w.scans;
                scans[1] += states << s.inputs.len();
            }
        }
        seen.extend(first.iter().map(|f| f.is_some()));
    }
    assert!(seen.contains(&true) && seen.contains(&false));
    assert!(scans[0] * 4 < scans[1], "most combinations make no difference: {scans:?}");
}

#[test]
fn at_most_one_input_is_1_if_it_is_asked_for() {
    // Both inputs together lead to the state that is looked for.
    let mut s = System::default();
    let (a, b) = (s.input(), s.input());
    let l = s.latch(false.into());
    let both = s.graph.and(a, b);
    s.set_next(l, both);
    let of = |tries| {
        wide(&s, &Wanted { all: true, tries, ..Wanted::of(&[l], &[], 1) }, &budget())
            .expect("it is small")
            .states
    };
    assert_eq!((of(Tries::All), of(Tries::One)), (2, 1));
}

#[test]
fn a_budget_that_is_used_up_is_no_proof() {
    // A number of ten bits that counts.
    let mut s = System::default();
    let latches: Vec<Signal> = (0..10).map(|_| s.latch(false.into())).collect();
    let mut carry = s.input();
    for l in &latches {
        let (next, over) = (s.graph.xor(*l, carry), s.graph.and(*l, carry));
        s.set_next(*l, next);
        carry = over;
    }
    let of = |budget: &Budget<'_>| -> Wide {
        wide(&s, &Wanted::of(&[carry], &[], 2), budget).expect("it is small")
    };
    assert_eq!(steps(&s, carry, &of(&budget()).found[0]), Some(1024));
    let few = Budget { states: 100, ..budget() };
    let seen = of(&few);
    assert!(matches!(seen.found[0], Found::Open(n) if (90..110).contains(&n)), "{seen:?}");
    assert_eq!((seen.open, seen.ends), (Some(Reason::States(100)), Ends::Open));
    let none = Budget { stop: &|| true, ..budget() };
    assert_eq!(of(&none).open, Some(Reason::Stopped));
}
