//! The search beside one that tries each combination of inputs by itself, on random systems and on systems with
//! numbers.

use super::{Tries, Wanted, Wide, wide};
use crate::layer::Budget;
use crate::reason::Reason;
use crate::sat::brute::{by_hand, counter, numbers, shortest, system, unlimited};
use crate::sat::cone::cone;
use crate::sat::dead::Ends;
use crate::sat::graph::{Signal, System};
use crate::sat::simulate::shows;
use crate::sat::{Found, Proof};

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

#[test]
fn runs_are_the_shortest_and_no_state_is_left_out() {
    let (mut reached, mut never) = (0, 0);
    for seed in 0..3000 {
        let (s, bad) = system(seed);
        for (together, threads) in [(0, 1), (6, 1), (1, 3)] {
            let signals = [bad, !bad];
            let Some(seen) =
                wide(&s, &Wanted { together, ..Wanted::of(&signals, &[bad], threads) }, &unlimited())
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
                &unlimited(),
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
        wide(&s, &Wanted { all: true, tries, ..Wanted::of(&[l], &[], 1) }, &unlimited())
            .expect("it is small")
            .states
    };
    assert_eq!((of(Tries::All), of(Tries::One)), (2, 1));
}

#[test]
fn a_budget_that_is_used_up_is_no_proof() {
    let (s, carry) = counter();
    let of = |budget: &Budget<'_>| -> Wide {
        wide(&s, &Wanted::of(&[carry], &[], 2), budget).expect("it is small")
    };
    assert_eq!(steps(&s, carry, &of(&unlimited()).found[0]), Some(1024));
    let few = Budget { states: 100, ..unlimited() };
    let seen = of(&few);
    assert!(matches!(seen.found[0], Found::Open(n) if (90..110).contains(&n)), "{seen:?}");
    assert_eq!((seen.open, seen.ends), (Some(Reason::States(100)), Ends::Open));
    let none = Budget { stop: &|| true, ..unlimited() };
    assert_eq!(of(&none).open, Some(Reason::Stopped));
}
