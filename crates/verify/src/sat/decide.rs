//! Decides for many signals of a system whether a run shows them: bounded search, induction
//! and PDR in turns, each with twice the work of the turn before.
//!
//! The work of a turn is counted in ticks of the solvers. So the answers depend on the system alone,
//! unless the caller stops the work. A proof is given only if the checker accepts it, and a run only
//! if the simulator repeats it.

use crate::sat::bounded::{Bounded, Induction};
use crate::sat::check::Checker;
use crate::sat::cone::{Cube, cone};
use crate::sat::graph::{Signal, System};
use crate::sat::kept::kept;
use crate::sat::needs::Needs;
use crate::sat::pdr::{Outcome, Pdr};
use crate::sat::relate::relations;
use crate::sat::simulate::{Trace, shows};

/// The answer for a signal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Found {
    /// A run whose last step shows it. None is shorter, unless the search was stopped.
    Reached(Trace),
    /// No run shows it.
    Never(Proof),
    /// Not decided: no run of so many steps shows it.
    Open(usize),
}

/// A proof that the checker agreed with, or that all states were visited.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Proof {
    /// An inductive invariant, with its clauses: in each a signal is 1.
    Invariant(Vec<Vec<Signal>>),
    /// A signal that is 0 at so many steps, the first of them outside of an invariant that was certified before, is 0
    /// at the next; and it is 0 at the first steps.
    Induction(usize),
    /// All states were visited, and it is 0 in all scans from there.
    Visited {
        /// Number of states.
        states: usize,
        /// Number of scans made.
        scans: usize,
    },
    /// The set of all states was made as a decision diagram, and it is 0 in all scans from there.
    Diagram {
        /// Number of states; nothing where there are more than fit.
        states: Option<u128>,
        /// Number of nodes of the diagram.
        nodes: usize,
        /// True if the solver of the checker confirmed the set. If false, only random runs were tried; they stayed in it.
        checked: bool,
    },
}

/// Ticks of the first turn.
const FIRST: u64 = 4_000;
/// Signals for which a turn has its ticks each; more share what these have.
const SHARES: u64 = 8;
/// Most ticks to find out which candidates are never reached.
const LEARNING: u64 = 1 << 20;
/// The first turn in which candidates of more than two latches are looked at.
const LATER: u32 = 2;
/// Most steps of an induction.
const DEEPEST: usize = 32;

/// How much may be done.
pub struct Effort<'b> {
    /// Most bytes kept, about.
    pub bytes: usize,
    /// Most turns.
    pub turns: u32,
    /// True as soon as the work is to stop.
    pub stop: &'b (dyn Fn() -> bool + Sync),
}

/// Decides for each of these signals whether a run shows it.
pub fn decide(system: &System, signals: &[Signal], effort: &Effort<'_>) -> Vec<Found> {
    Decide::new(system, signals, effort).run()
}

/// The same, with cubes that are thought never to be reached. Those of which one step shows it help the search.
/// Signals that are not needed any more stay open.
pub(crate) fn decide_with(
    system: &System,
    signals: &[Signal],
    needs: &Needs,
    candidates: &[Cube],
    effort: &Effort<'_>,
) -> Vec<Found> {
    let mut work = Decide::new(system, signals, effort);
    work.needs = Some(needs);
    // To learn is much more work than to see a run of few steps.
    if effort.turns > 0 {
        work.search(FIRST / 4);
    }
    if !work.is_over() {
        work.learn(candidates);
    }
    work.run()
}

/// The same until a run shows one of them: then it is a shortest one that shows any, and the others stay
/// open. Begins with relations between latches, which help where the system is two charts side by side;
/// gives their number, which every proof counts on.
pub(crate) fn decide_related(
    system: &System,
    signals: &[Signal],
    effort: &Effort<'_>,
) -> (Vec<Found>, usize) {
    let mut work = Decide::new(system, signals, effort);
    work.first = true;
    let cubes = relations(system, signals, FIRST << effort.turns.min(40), effort.stop);
    // An invariant by themselves, they hold whatever the signals are.
    if work.checker.certifies(&cubes, Signal::FALSE) {
        work.keep(cubes);
    }
    let count = work.lemmas.len();
    (work.run(), count)
}

/// A signal that is not decided.
struct Wanted<'a> {
    signal: Signal,
    /// Nodes that it depends on.
    size: usize,
    search: Option<Pdr<'a>>,
    /// A run that may not be a shortest one.
    long: Option<Trace>,
    /// Steps up to which induction was tried.
    tried: usize,
}

struct Decide<'a> {
    system: &'a System,
    effort: &'a Effort<'a>,
    wanted: Vec<Wanted<'a>>,
    answers: Vec<Option<Found>>,
    bounded: Bounded<'a>,
    induction: Induction<'a>,
    checker: Checker<'a>,
    /// Cubes that the checker certified.
    lemmas: Vec<Cube>,
    /// Cubes that are thought never to be reached and were not looked at yet.
    later: Vec<Cube>,
    /// A run that shows one signal ends the work.
    first: bool,
    /// The signals that runs make needless.
    needs: Option<&'a Needs>,
}

impl<'a> Decide<'a> {
    fn new(system: &'a System, signals: &[Signal], effort: &'a Effort<'a>) -> Decide<'a> {
        let wanted = signals.iter().map(|s| {
            let size = cone(system, std::iter::once(*s)).into_iter().filter(|seen| *seen).count();
            Wanted { signal: *s, size, search: None, long: None, tried: 0 }
        });
        Decide {
            system,
            effort,
            wanted: wanted.collect(),
            answers: vec![None; signals.len()],
            bounded: Bounded::new(system, effort.stop),
            induction: Induction::new(system, effort.stop),
            checker: Checker::new(system, effort.stop),
            lemmas: Vec::new(),
            later: Vec::new(),
            first: false,
            needs: None,
        }
    }

    /// Certifies those of these cubes that are never reached, and sees what follows from them at once. Cubes of more
    /// than two latches are much more work: they wait for a later turn.
    fn learn(&mut self, candidates: &[Cube]) {
        let wanted = self.wanted.iter().map(|w| w.signal);
        let inside = cone(self.system, self.system.constraints.iter().copied().chain(wanted));
        let is_inside = |c: &&Cube| c.iter().all(|s| inside.get(s.node() as usize) == Some(&true));
        let cubes = candidates.iter().filter(is_inside).cloned();
        let (cubes, later): (Vec<Cube>, Vec<Cube>) = cubes.partition(|c| c.len() < 3);
        self.later = later;
        if !cubes.is_empty() && self.effort.turns > 0 && self.certify(cubes, LEARNING) {
            self.prove(FIRST);
        }
    }

    /// Keeps those of these cubes that are never reached. False if the ticks or the time are used up.
    fn certify(&mut self, cubes: Vec<Cube>, ticks: u64) -> bool {
        let Some(cubes) = kept(self.system, &self.lemmas, cubes, ticks, self.effort.stop) else {
            return false;
        };
        let certified = self.checker.certifies(&cubes, Signal::FALSE);
        if certified {
            self.keep(cubes);
        }
        certified
    }

    /// The checker has certified these cubes.
    fn keep(&mut self, cubes: Vec<Cube>) {
        self.induction.exclude(&cubes);
        self.lemmas.extend(cubes);
    }

    fn run(mut self) -> Vec<Found> {
        for turn in 0..self.effort.turns {
            let ticks = FIRST << turn.min(40);
            if turn >= LATER && !self.later.is_empty() && self.certify(self.later.clone(), ticks / 4) {
                self.later.clear();
            }
            // A search that finds nothing is the longest part of a turn.
            self.search(ticks / 4);
            if self.is_over() {
                break;
            }
            let share = |open: usize| ticks * SHARES / SHARES.max(open as u64);
            self.induce(share(self.open().len()) / 4);
            self.prove(share(self.open().len()));
            if self.is_over() {
                break;
            }
        }
        let sure = self.bounded.done();
        let rest = self.wanted.into_iter().zip(self.answers).map(|(w, answer)| {
            let steps = sure.max(w.search.map_or(0, |s| s.steps()));
            answer.unwrap_or_else(|| w.long.map_or(Found::Open(steps), Found::Reached))
        });
        rest.collect()
    }

    /// True if there is nothing left to do, or no time.
    fn is_over(&self) -> bool {
        let reached = || self.answers.iter().any(|a| matches!(a, Some(Found::Reached(_))));
        (0..self.answers.len()).all(|i| !self.is_open(i)) || self.first && reached() || (self.effort.stop)()
    }

    /// True if a signal is not decided and still needed.
    fn is_open(&self, i: usize) -> bool {
        let is_shown = |k: usize| matches!(self.answers.get(k), Some(Some(Found::Reached(_))));
        self.answers.get(i).is_some_and(Option::is_none)
            && self.needs.is_none_or(|n| n.is_needed(i, is_shown))
    }

    /// The numbers of the signals that are not decided, those that depend on little first.
    fn open(&self) -> Vec<usize> {
        let mut open: Vec<usize> = (0..self.wanted.len()).filter(|i| self.is_open(*i)).collect();
        open.sort_by_key(|i| self.wanted.get(*i).map(|w| w.size));
        open
    }

    fn answer(&mut self, i: usize, found: Found) {
        if let Some(w) = self.wanted.get_mut(i) {
            w.search = None;
        }
        if let Some(slot) = self.answers.get_mut(i) {
            *slot = Some(found);
        }
    }

    /// Bounded search, step by step.
    fn search(&mut self, ticks: u64) {
        let mut wanted: Vec<(usize, Signal)> = (0..self.wanted.len())
            .filter(|i| self.is_open(*i))
            .filter_map(|i| self.wanted.get(i).map(|w| (i, w.signal)))
            .collect();
        self.bounded.allow(ticks);
        let end = self.bounded.ticks() + ticks;
        // Steps that are decided without a tick grow the solver too.
        let mut left = 1 + ticks / 64;
        while !wanted.is_empty() && self.bounded.ticks() < end && left > 0 && !self.is_over() {
            if self.bounded.bytes() > self.effort.bytes / 2 {
                break;
            }
            left -= 1;
            let Ok(found) = self.bounded.go_on(&mut wanted) else { break };
            for (i, trace) in found {
                let signal = self.wanted.get(i).map_or(Signal::FALSE, |w| w.signal);
                if shows(self.system, &trace, signal) {
                    self.answer(i, Found::Reached(trace));
                }
            }
            let done = self.bounded.done();
            // A run that PDR found is a shortest one once all shorter ones are excluded.
            let shortest: Vec<(usize, Trace)> = wanted
                .iter()
                .filter_map(|(i, _)| {
                    let long = self.wanted.get(*i)?.long.as_ref()?;
                    (done + 1 >= long.inputs.len()).then(|| (*i, long.clone()))
                })
                .collect();
            for (i, trace) in shortest {
                wanted.retain(|(n, _)| *n != i);
                self.answer(i, Found::Reached(trace));
            }
        }
    }

    /// Induction over as many steps as the bounded search has decided.
    fn induce(&mut self, ticks: u64) {
        let most = self.bounded.done().min(DEEPEST);
        for i in self.open() {
            // To make clauses of a large part of the system is work as well.
            if self.wanted.get(i).is_some_and(|w| w.size as u64 > ticks * 16) {
                continue;
            }
            self.induction.allow(ticks);
            let Some((signal, tried)) =
                self.wanted.get(i).filter(|w| w.long.is_none()).map(|w| (w.signal, w.tried))
            else {
                continue;
            };
            for depth in tried + 1..=most {
                match self.induction.keeps(signal, depth) {
                    Ok(true) if self.checker.certifies_induction(signal, depth) => {
                        self.answer(i, Found::Never(Proof::Induction(depth)));
                        break;
                    }
                    Ok(_) => {}
                    Err(_) => break,
                }
                if let Some(w) = self.wanted.get_mut(i) {
                    w.tried = depth;
                }
            }
        }
    }

    fn prove(&mut self, ticks: u64) {
        let share = self.effort.bytes / 2;
        for i in self.open() {
            let kept: usize = self.wanted.iter().filter_map(|w| w.search.as_ref()).map(Pdr::bytes).sum();
            let Some(w) = self.wanted.get_mut(i).filter(|w| w.long.is_none()) else { continue };
            let is_new = w.search.is_none();
            if (self.effort.stop)() || is_new && (kept > share || w.size as u64 > ticks * 16) {
                continue;
            }
            let lemmas = &self.lemmas;
            let system = self.system;
            let stop = self.effort.stop;
            let search = w.search.get_or_insert_with(|| {
                let inside = cone(system, system.constraints.iter().copied().chain([w.signal]));
                let is_inside = |c: &&Cube| c.iter().all(|s| inside.get(s.node() as usize) == Some(&true));
                Pdr::new(system, w.signal, lemmas.iter().filter(is_inside).cloned().collect(), stop)
            });
            match search.work(ticks) {
                Outcome::Open => {}
                Outcome::Proved(cubes) => {
                    let signal = w.signal;
                    if self.checker.certifies(&cubes, signal) {
                        // The lemmas that it was given are a part of the proof.
                        let inside = cone(system, system.constraints.iter().copied().chain([signal]));
                        let is_inside =
                            |c: &&Cube| c.iter().all(|s| inside.get(s.node() as usize) == Some(&true));
                        let all = cubes.iter().chain(self.lemmas.iter().filter(is_inside));
                        let clauses = all.map(|c| c.iter().map(|s| !*s).collect()).collect();
                        self.keep(cubes);
                        self.answer(i, Found::Never(Proof::Invariant(clauses)));
                    }
                }
                Outcome::Reached(trace) => {
                    if shows(system, &trace, w.signal) {
                        if trace.inputs.len() <= self.bounded.done() + 1 {
                            self.answer(i, Found::Reached(trace));
                        } else {
                            w.long = Some(trace);
                            w.search = None;
                        }
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sat::brute::{Random, shortest, system};
    use crate::sat::graph::Init;

    fn effort() -> Effort<'static> {
        Effort { bytes: 1 << 28, turns: 30, stop: &|| false }
    }

    #[test]
    fn answers_are_those_of_all_states() {
        for seed in 0..2000 {
            let (s, bad) = system(seed);
            let signals = [bad, !bad, Signal::FALSE];
            for (found, signal) in decide(&s, &signals, &effort()).into_iter().zip(signals) {
                let steps = match found {
                    Found::Reached(trace) => Some(trace.inputs.len()),
                    Found::Never(_) => None,
                    Found::Open(_) => panic!("seed {seed}: open"),
                };
                assert_eq!(steps, shortest(&s, signal), "seed {seed}");
            }
        }
    }

    /// The checker never certifies what is not so, whatever it is given.
    #[test]
    fn certificates_with_a_fault_prove_nothing_that_is_false() {
        let (mut accepted, mut refused) = (0, 0);
        let mut r = Random(5);
        for seed in 0..2000 {
            let (s, bad) = system(seed);
            let Outcome::Proved(mut cubes) = Pdr::new(&s, bad, Vec::new(), &|| false).work(1 << 40) else {
                // A run shows it: no certificate of any kind may pass.
                let random: Vec<Cube> = (0..3)
                    .map(|_| {
                        let mut cube: Cube =
                            s.latches.iter().map(|l| l.signal.negated_if(r.below(2) == 1)).collect();
                        cube.retain(|_| r.below(3) > 0);
                        cube
                    })
                    .collect();
                assert!(!Checker::new(&s, &|| false).certifies(&random, bad), "seed {seed}");
                continue;
            };
            if cubes.is_empty() {
                continue;
            }
            let at = r.below(cubes.len());
            cubes.remove(at);
            match Checker::new(&s, &|| false).certifies(&cubes, bad) {
                true => accepted += 1,
                false => refused += 1,
            }
        }
        assert!(refused > 100 && refused > accepted, "{accepted} accepted, {refused} refused");
    }

    /// Counts up to 2^bits, one each step in which it may.
    fn counter(bits: usize) -> (System, Vec<Signal>) {
        let mut s = System::default();
        let mut carry = s.input();
        let word: Vec<Signal> = (0..bits).map(|_| s.latch(Init::Zero)).collect();
        for bit in &word {
            let next = s.graph.xor(*bit, carry);
            carry = s.graph.and(*bit, carry);
            s.set_next(*bit, next);
        }
        (s, word)
    }

    fn is(s: &mut System, word: &[Signal], value: usize) -> Signal {
        let bits: Vec<Signal> =
            word.iter().enumerate().map(|(i, b)| b.negated_if(value >> i & 1 == 0)).collect();
        s.graph.all(bits)
    }

    #[test]
    fn a_state_at_depth_n_is_shown_by_n_steps_and_one() {
        let (mut s, word) = counter(6);
        let signals: Vec<Signal> = [0, 1, 17, 40].iter().map(|n| is(&mut s, &word, *n)).collect();
        let found = decide(&s, &signals, &effort());
        let steps: Vec<usize> = found
            .iter()
            .map(|f| match f {
                Found::Reached(trace) => trace.inputs.len(),
                Found::Never(_) | Found::Open(_) => 0,
            })
            .collect();
        assert_eq!(steps, [1, 2, 18, 41]);
    }

    #[test]
    fn a_ring_never_has_two_tokens() {
        let mut s = System::default();
        let count = 40;
        let ring: Vec<Signal> = (0..count).map(|i| s.latch((i == 0).into())).collect();
        let go: Vec<Signal> = (0..count).map(|_| s.input()).collect();
        for i in 0..count {
            let before = (i + count - 1) % count;
            let (enters, leaves) = (s.graph.and(ring[before], go[before]), s.graph.and(ring[i], go[i]));
            let stays = s.graph.and(ring[i], !leaves);
            let next = s.graph.or(stays, enters);
            s.set_next(ring[i], next);
        }
        let pairs: Vec<Signal> = (1..count).map(|i| s.graph.and(ring[i - 1], ring[i])).collect();
        let (two, none) = (s.graph.any(pairs), s.graph.any(ring.clone()));
        let found = decide(&s, &[two, !none, ring[39]], &effort());
        assert!(matches!(found[0], Found::Never(_)), "{:?}", found[0]);
        assert!(matches!(found[1], Found::Never(_)), "{:?}", found[1]);
        assert!(matches!(&found[2], Found::Reached(t) if t.inputs.len() == 40), "{:?}", found[2]);
    }

    #[test]
    fn work_that_is_stopped_tells_how_far_it_is_sure() {
        let (mut s, word) = counter(30);
        let far = is(&mut s, &word, 1 << 29);
        let found = decide(&s, &[far], &Effort { turns: 2, ..effort() });
        assert!(matches!(found[..], [Found::Open(steps)] if steps > 2), "{found:?}");
        let found = decide(&s, &[far], &Effort { stop: &|| true, ..effort() });
        assert!(matches!(found[..], [Found::Open(_)]), "{found:?}");
    }
}
