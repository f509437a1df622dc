//! Relations between latches: pairs that are equal or opposite, that exclude or imply each other, and
//! latches that never change.
//!
//! Two charts that do the same have steps that are active together, and a proof of it needs to
//! know which. Random runs show which relations may hold; those that a step does not keep are given up
//! until all that are left are kept together. After C. A. J. van Eijk, "Sequential equivalence checking
//! based on structural similarities" (IEEE Transactions on CAD, 2000), with implications as well.

use std::collections::BTreeMap;

use crate::sat::cnf::{Start, Steps};
use crate::sat::cone::{Cube, cone, next};
use crate::sat::graph::{Signal, System};
use crate::sat::kept::kept;
use crate::sat::simulate::evaluate;
use crate::sat::solver::{Answer, Batsat, Literal, Solver};

/// Steps of the random runs, each of which is 64 runs at once.
const STEPS: usize = 192;
/// Most latches whose pairs are all looked at.
const LATCHES: usize = 3000;
/// Most pairs that are tried.
const MOST: usize = 30_000;

/// Cubes that no run reaches, of one or two latches that these signals depend on. They are kept by
/// each step together; the caller has them certified. Fewer if the ticks or the time are used up.
pub(crate) fn relations(
    system: &System,
    of: &[Signal],
    ticks: u64,
    stop: &(dyn Fn() -> bool + Sync),
) -> Vec<Cube> {
    let inside = cone(system, of.iter().chain(&system.constraints).copied());
    let all = system.latches.iter().enumerate();
    let latches: Vec<usize> =
        all.filter(|(_, l)| inside.get(l.signal.node() as usize) == Some(&true)).map(|(i, _)| i).collect();
    if stop() {
        return Vec::new();
    }
    let (classes, mut pairs) = candidates(system, &latches, &history(system));
    // Equal latches are kept without the other relations; these are looked at with the help of them.
    let mut all = refined(system, classes, ticks, stop).unwrap_or_default();
    pairs.truncate(MOST);
    let more = kept(system, &all, pairs, ticks, stop).unwrap_or_default();
    all.extend(more);
    all
}

/// The values of each latch in random runs from the first step.
fn history(system: &System) -> Vec<Vec<u64>> {
    let mut random = 0x9E37_79B9_7F4A_7C15u64;
    let mut draw = || {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        random
    };
    let first = |l: &crate::sat::graph::Latch, free: u64| match l.init.value() {
        Some(true) => u64::MAX,
        Some(false) => 0,
        None => free,
    };
    let mut latches: Vec<u64> = system.latches.iter().map(|l| first(l, draw())).collect();
    let mut inputs: Vec<u64> = system.inputs.iter().map(|_| draw()).collect();
    let mut history = vec![Vec::with_capacity(STEPS); latches.len()];
    for step in 0..STEPS {
        for (row, word) in history.iter_mut().zip(&latches) {
            row.push(*word);
        }
        let values = evaluate(&system.graph, &latches, &inputs);
        // A run whose inputs break a constraint stays where it is, and tries others.
        let goes_on = system.constraints.iter().fold(u64::MAX, |w, c| w & values.get(*c));
        for (l, word) in system.latches.iter().zip(&mut latches) {
            *word = values.get(l.next) & goes_on | *word & !goes_on;
        }
        for word in &mut inputs {
            *word ^= match step % 3 {
                0 => draw(),
                1 => draw() & draw(),
                _ => draw() & draw() & draw(),
            };
        }
    }
    history
}

/// The relations that the runs show no exception to: classes of latches that are equal (negated, where they are
/// opposite), those that never change with the constant first, and pairs of others that exclude or imply each other.
fn candidates(system: &System, latches: &[usize], history: &[Vec<u64>]) -> (Vec<Vec<Signal>>, Vec<Cube>) {
    let none = Vec::new();
    let row = |i: usize| history.get(i).unwrap_or(&none);
    let signal = |i: usize| system.latches.get(i).map_or(Signal::FALSE, |l| l.signal);
    let mut classes: BTreeMap<Vec<u64>, Vec<Signal>> = BTreeMap::new();
    classes.insert(vec![0; STEPS], vec![Signal::FALSE]);
    let mut heads: Vec<usize> = Vec::new();
    for i in latches {
        let negated = row(*i).first().is_some_and(|w| w & 1 != 0);
        let key: Vec<u64> = row(*i).iter().map(|w| if negated { !w } else { *w }).collect();
        let class = classes.entry(key).or_default();
        if class.is_empty() {
            heads.push(*i);
        }
        class.push(signal(*i).negated_if(negated));
    }
    let alike = classes.into_values().collect();
    let mut pairs = Vec::new();
    if heads.len() > LATCHES {
        return (alike, pairs);
    }
    for (k, i) in heads.iter().enumerate() {
        for j in heads.iter().skip(k + 1) {
            let mut seen = [false; 4];
            for (a, b) in row(*i).iter().zip(row(*j)) {
                for (s, word) in seen.iter_mut().zip([a & b, a & !b, !a & b, !a & !b]) {
                    *s |= word != 0;
                }
                if seen == [true; 4] {
                    break;
                }
            }
            let (a, b) = (signal(*i), signal(*j));
            for (seen, pair) in seen.iter().zip([[a, b], [a, !b], [!a, b], [!a, !b]]) {
                pairs.extend((!seen).then(|| sorted(pair)));
            }
        }
    }
    (alike, pairs)
}

fn sorted(pair: [Signal; 2]) -> Cube {
    let mut cube = pair.to_vec();
    cube.sort_unstable();
    cube
}

/// That two signals are equal.
fn alike(a: Signal, b: Signal) -> Vec<Cube> {
    if a == Signal::FALSE { vec![vec![b]] } else { vec![sorted([a, !b]), sorted([!a, b])] }
}

/// Divides classes until each step keeps what they say; gives the cubes that they exclude. None if the
/// ticks or the time are used up.
fn refined(
    system: &System,
    mut classes: Vec<Vec<Signal>>,
    ticks: u64,
    stop: &(dyn Fn() -> bool + Sync),
) -> Option<Vec<Cube>> {
    let mut left = ticks;
    loop {
        classes.retain(|class| class.len() > 1);
        let cubes: Vec<Cube> = classes
            .iter()
            .flat_map(|class| {
                class.iter().skip(1).flat_map(|s| alike(class.first().copied().unwrap_or(*s), *s))
            })
            .collect();
        let mut solver = Batsat::new(stop);
        solver.stop_at(left);
        let mut steps = Steps::new(system, &mut solver, Start::Any, false);
        let mut literal = |solver: &mut Batsat<'_>, s: Signal| steps.literal(system, solver, 0, s);
        for cube in &cubes {
            let clause: Vec<Literal> = cube.iter().map(|s| !literal(&mut solver, *s)).collect();
            solver.add(&clause);
        }
        // All signals one behind the other, with the place of the first of their class and their present class.
        let mut rows: Vec<(Signal, Literal, usize)> = Vec::new();
        let mut label: Vec<usize> = Vec::new();
        for (k, class) in classes.iter().enumerate() {
            let head = rows.len();
            for s in class {
                rows.push((*s, literal(&mut solver, next(system, *s)), head));
                label.push(k);
            }
        }
        let before = label.clone();
        for (i, (_, mine, head)) in rows.iter().enumerate() {
            let Some((_, first, _)) = rows.get(*head).filter(|_| i != *head) else { continue };
            for assumed in [[*first, !*mine], [!*first, *mine]] {
                if label.get(i) != label.get(*head) {
                    break;
                }
                match solver.solve(&assumed) {
                    Answer::Stopped => return None,
                    Answer::No => {}
                    Answer::Yes => {
                        let mut known: BTreeMap<(usize, bool), usize> = BTreeMap::new();
                        for ((_, l, _), label) in rows.iter().zip(&mut label) {
                            let count = known.len();
                            *label = *known.entry((*label, solver.value(*l))).or_insert(count);
                        }
                    }
                }
            }
        }
        left = left.saturating_sub(solver.ticks());
        let mut divided: BTreeMap<usize, Vec<Signal>> = BTreeMap::new();
        for ((s, _, _), label) in rows.iter().zip(&label) {
            divided.entry(*label).or_default().push(*s);
        }
        if divided.len() == before.last().map_or(0, |last| last + 1) {
            return Some(cubes);
        }
        classes = divided.into_values().collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sat::brute::{shortest, system};
    use crate::sat::check::Checker;
    use crate::sat::graph::Init;

    /// Each relation holds in all states that are reached, and the checker agrees.
    #[test]
    fn relations_hold_in_every_state_that_is_reached() {
        let mut count = 0;
        for seed in 0..1500 {
            let (s, bad) = system(seed);
            let found = relations(&s, &[bad], 1 << 30, &|| false);
            assert!(Checker::new(&s, &|| false).certifies(&found, Signal::FALSE), "seed {seed}");
            for cube in &found {
                let mut s = s.clone();
                let inside = s.graph.all(cube.iter().copied());
                assert_eq!(shortest(&s, inside), None, "seed {seed}: {cube:?}");
            }
            count += found.len();
        }
        assert!(count > 1500, "{count}");
    }

    /// A ring of three steps beside the same ring whose second step is kept as its opposite.
    #[test]
    fn steps_that_belong_together_are_found() {
        let mut s = System::default();
        let go = s.input();
        let mut rings = Vec::new();
        for opposite in [false, true] {
            let init = |i: usize| Init::from((i == 0) != (opposite && i == 1));
            let ring: Vec<Signal> = (0..3).map(|i| s.latch(init(i)).negated_if(opposite && i == 1)).collect();
            for i in 0..3 {
                let next = s.graph.mux(go, ring[(i + 2) % 3], ring[i]);
                s.set_next(ring[i], next);
            }
            rings.push(ring);
        }
        let all: Vec<Signal> = rings.concat();
        let found = relations(&s, &all, 1 << 30, &|| false);
        for i in 0..3 {
            let (a, b) = (rings[0][i], rings[1][i]);
            for cube in [[a, !b], [!a, b]] {
                assert!(found.contains(&sorted(cube)), "{i}: {found:?}");
            }
            assert!(found.contains(&sorted([a, rings[0][(i + 1) % 3]])), "steps exclude each other");
        }
    }
}
