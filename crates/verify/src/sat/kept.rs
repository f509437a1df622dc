//! Candidates for lemmas: cubes that the chart suggests no run reaches. The cubes that one step shows to be
//! unreachable are kept, the others are dropped.
//!
//! A cube that a step enters from outside of all of them is given up, and the others are looked at again,
//! until all that are left are kept out together (C. Flanagan, K. R. M. Leino, "Houdini, an annotation
//! assistant for ESC/Java", FME 2001).

use crate::sat::cnf::{Start, Steps};
use crate::sat::cone::{Cube, next, touches_start};
use crate::sat::graph::{Signal, System};
use crate::sat::solver::{Answer, Batsat, Literal, Solver};

/// Those of the cubes that no run enters, as far as they, those that are known and one step show it. The
/// caller has them certified. None if the ticks or the time are used up.
pub(crate) fn kept(
    system: &System,
    known: &[Cube],
    mut cubes: Vec<Cube>,
    ticks: u64,
    stop: &(dyn Fn() -> bool + Sync),
) -> Option<Vec<Cube>> {
    cubes.retain(|c| !touches_start(system, c));
    let mut left = ticks;
    loop {
        let mut solver = Batsat::new(stop);
        solver.stop_at(left);
        let mut steps = Steps::new(system, &mut solver, Start::Any, false);
        let mut literal = |solver: &mut Batsat<'_>, s: Signal| steps.literal(system, solver, 0, s);
        let behind: Vec<Vec<Literal>> = cubes
            .iter()
            .map(|cube| cube.iter().map(|s| literal(&mut solver, next(system, *s))).collect())
            .collect();
        for cube in known.iter().chain(&cubes) {
            let clause: Vec<Literal> = cube.iter().map(|s| !literal(&mut solver, *s)).collect();
            solver.add(&clause);
        }
        let mut lost = vec![false; cubes.len()];
        for (i, assumed) in behind.iter().enumerate() {
            if lost.get(i) == Some(&true) {
                continue;
            }
            match solver.solve(assumed) {
                Answer::Stopped => return None,
                Answer::No => {}
                Answer::Yes => {
                    for (lost, literals) in lost.iter_mut().zip(&behind) {
                        *lost |= literals.iter().all(|l| solver.value(*l));
                    }
                }
            }
        }
        left = left.saturating_sub(solver.ticks());
        if !lost.contains(&true) {
            return Some(cubes);
        }
        let mut gone = lost.iter();
        cubes.retain(|_| gone.next() == Some(&false));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sat::check::Checker;
    use crate::sat::graph::Init;

    /// A token in a ring of four, and a latch that an input sets.
    #[test]
    fn what_a_step_enters_is_given_up_with_all_that_rests_on_it() {
        let mut s = System::default();
        let (go, set) = (s.input(), s.input());
        let ring: Vec<Signal> = (0..4).map(|i| s.latch((i == 0).into())).collect();
        for i in 0..4 {
            let next = s.graph.mux(go, ring[(i + 3) % 4], ring[i]);
            s.set_next(ring[i], next);
        }
        let free = s.latch(Init::Zero);
        s.set_next(free, set);
        let behind = s.latch(Init::Zero);
        s.set_next(behind, free);
        let mut right = Vec::new();
        for (i, a) in ring.iter().enumerate() {
            right.extend(ring.iter().skip(i + 1).map(|b| vec![*a, *b]));
        }
        let mut all = right.clone();
        // The first state is in this one; an input enters the next; the last holds only if that one does.
        all.extend([vec![ring[0]], vec![free], vec![behind]]);
        let found = kept(&s, &[], all, 1 << 30, &|| false);
        assert_eq!(found.as_ref(), Some(&right));
        assert!(Checker::new(&s, &|| false).certifies(&right, Signal::FALSE));
        assert_eq!(kept(&s, &[], right, 0, &|| false), None, "without ticks it says nothing");
    }
}
