//! Compares the sets with a search that tries every combination of inputs, on random systems and on systems with
//! numbers.

use super::{Effort, Seen, diagram};
use crate::layer::Budget;
use crate::sat::brute::{Random, by_hand, counter, numbers, shortest, system, unlimited};
use crate::sat::cone::{Cube, cone};
use crate::sat::dead::Ends;
use crate::sat::graph::{Signal, System};
use crate::sat::simulate::shows;
use crate::sat::{Found, Proof, Tries, Wanted};

const EFFORT: Effort = Effort { nodes: 1 << 14, ticks: 1 << 20 };
const ROOMY: Effort = Effort { nodes: 1 << 18, ..EFFORT };

/// The number of steps of the run, if there is one; the run is repeated, a proof is one that the solver checked.
fn steps(s: &System, signal: Signal, found: &Found) -> Option<usize> {
    match found {
        Found::Reached(trace) => {
            assert!(shows(s, trace, signal));
            Some(trace.inputs.len())
        }
        Found::Never(Proof::Diagram { checked: true, .. }) => None,
        other => panic!("{other:?}"),
    }
}

/// Random guesses. Some of them are wrong: a run reaches the cube, and the search must drop it.
fn thoughts(s: &System, seed: u64) -> Vec<Cube> {
    let mut r = Random(seed);
    let cube = |r: &mut Random| -> Cube {
        (0..1 + r.below(2))
            .map(|_| s.latches[r.below(s.latches.len())].signal.negated_if(r.below(2) == 1))
            .collect()
    };
    (0..r.below(6)).map(|_| cube(&mut r)).collect()
}

#[test]
fn runs_are_the_shortest_and_no_state_is_left_out() {
    let (mut reached, mut never) = (0, 0);
    for seed in 0..1500 {
        let (s, bad) = system(seed);
        let signals = [bad, !bad];
        let guards = [bad];
        let wanted = Wanted::of(&signals, &guards, 1);
        let Some(seen) = diagram(&s, &wanted, &thoughts(&s, seed), EFFORT, &unlimited()) else {
            let inside = cone(&s, s.constraints.iter().copied().chain(signals));
            let is_in = |l: &Signal| inside[l.node() as usize];
            assert!(s.latches.iter().any(|l| is_in(&l.signal) && l.init.value().is_none()), "seed {seed}");
            continue;
        };
        for (signal, found) in signals.iter().zip(&seen.found) {
            let mine = steps(&s, *signal, found);
            assert_eq!(mine, shortest(&s, *signal), "seed {seed}");
            reached += usize::from(mine.is_some());
            never += usize::from(mine.is_none());
        }
    }
    assert!(reached > 500 && never > 500, "{reached} {never}");
}

#[test]
fn states_are_counted() {
    for seed in 0..60 {
        let (s, signals) = numbers(seed);
        let (states, first, stuck) = by_hand(&s, &signals);
        let wanted = Wanted { all: true, ..Wanted::of(&signals, &signals, 1) };
        let seen = diagram(&s, &wanted, &thoughts(&s, seed), EFFORT, &unlimited()).expect("it is small");
        assert_eq!(seen.states, Some(states as u128), "seed {seed}");
        let mine: Vec<_> = signals.iter().zip(&seen.found).map(|(s1, f)| steps(&s, *s1, f)).collect();
        assert_eq!(mine, first, "seed {seed}");
        assert_eq!(matches!(seen.ends, Ends::Behind(_)), stuck, "seed {seed}");
    }
}

#[test]
fn a_state_that_no_inputs_leave_is_seen() {
    // A two-bit counter. In state 3 no inputs are allowed: one constraint asks for both of them, another forbids both.
    let mut s = System::default();
    let (a, b) = (s.input(), s.input());
    let (low, high) = (s.latch(false.into()), s.latch(false.into()));
    let carry = s.graph.xor(low, high);
    s.set_next(low, !low);
    s.set_next(high, carry);
    let (three, both) = (s.graph.and(low, high), s.graph.and(a, b));
    let wanted = s.graph.implies(three, both);
    let ends = |s: &System| {
        let signals = [carry];
        diagram(s, &Wanted { all: true, ..Wanted::of(&signals, &[], 1) }, &[], EFFORT, &unlimited())
            .expect("it is small")
            .ends
    };
    s.constraints = vec![wanted];
    assert_eq!(ends(&s), Ends::None);
    s.constraints.push(!both);
    assert_eq!(ends(&s), Ends::Behind(3));
    s.constraints.push(Signal::FALSE);
    assert_eq!(ends(&s), Ends::Behind(0));
}

/// So many bits, each of which an input of its own inverts.
fn bits(count: usize) -> System {
    let mut s = System::default();
    for _ in 0..count {
        let (l, i) = (s.latch(false.into()), s.input());
        let next = s.graph.xor(l, i);
        s.set_next(l, next);
    }
    s
}

fn all_of(s: &System, tries: Tries) -> Seen {
    diagram(s, &Wanted { all: true, tries, ..Wanted::of(&[], &[], 1) }, &[], ROOMY, &unlimited())
        .expect("it is small")
}

#[test]
fn numbers_of_states_that_no_search_visits() {
    let s = bits(120);
    let (together, alone) = (all_of(&s, Tries::All), all_of(&s, Tries::One));
    assert_eq!([together.states, alone.states], [Some(1 << 120); 2]);
    assert_eq!([together.depth, alone.depth], [2, 121], "all bits in one step, or one in each");
    assert_eq!(all_of(&bits(128), Tries::All).states, None, "2^128 does not fit");
}

#[test]
fn a_budget_that_is_used_up_is_no_proof() {
    let (s, carry) = counter();
    let signals = [carry];
    let wanted = Wanted::of(&signals, &[], 1);
    let of = |budget: &Budget<'_>| diagram(&s, &wanted, &[], EFFORT, budget);
    assert_eq!(steps(&s, carry, &of(&unlimited()).expect("it is small").found[0]), Some(1024));
    assert!(of(&Budget { stop: &|| true, ..unlimited() }).is_none());
    let looks = std::sync::atomic::AtomicUsize::new(0);
    let later = || looks.fetch_add(1, std::sync::atomic::Ordering::Relaxed) > 200;
    let seen = of(&Budget { stop: &later, ..unlimited() }).expect("its functions are made");
    assert!(matches!(seen.found[0], Found::Open(n) if n > 5), "{seen:?}");
    assert_eq!((seen.ends, seen.is_whole), (Ends::Open, false));
}

/// If the solver has no time to check a set, random runs try it, and the proof says so.
#[test]
fn a_set_that_is_not_checked_says_so() {
    let (s, signals) = numbers(3);
    let wanted = Wanted { all: true, ..Wanted::of(&signals, &[], 1) };
    let seen = diagram(&s, &wanted, &[], Effort { ticks: 0, ..EFFORT }, &unlimited()).expect("it is small");
    let proofs =
        seen.found.iter().filter(|f| matches!(f, Found::Never(Proof::Diagram { checked: false, .. })));
    assert!(proofs.count() > 0 || seen.found.iter().all(|f| matches!(f, Found::Reached(_))));
}
