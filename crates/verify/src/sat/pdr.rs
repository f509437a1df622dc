//! Property-directed reachability (PDR, also called IC3): proves that a signal is never 1 by
//! an inductive invariant that it finds clause by clause, or finds a run to it.
//!
//! After A. Bradley, "SAT-based model checking without unrolling" (VMCAI 2011), N. Een, A.
//! Mishchenko, R. Brayton, "Efficient implementation of property directed reachability" (FMCAD
//! 2011), and Z. Hassan, A. Bradley, F. Somenzi, "Better generalization in IC3" (FMCAD 2013).

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::sat::cone::{Cube, leaves_start, touches_start};
use crate::sat::frames::{Before, Consecution, Frames, Stopped};
use crate::sat::graph::{Node, Signal, System};
use crate::sat::simulate::Trace;

/// Counterexamples to a more general clause that are excluded themselves, for each clause.
const DETOURS: usize = 3;

/// The answer of a round of work.
pub(crate) enum Outcome {
    /// These cubes are never reached, and with them nothing that is asked for.
    Proved(Vec<Cube>),
    /// A run, which need not be a shortest one.
    Reached(Trace),
    /// The ticks are used up, or the time is over.
    Open,
}

/// A state from which the signal can be reached.
struct Duty {
    before: Before,
    /// The state behind it.
    then: Option<usize>,
}

/// The search for one signal.
pub(crate) struct Pdr<'a> {
    frames: Frames<'a>,
    bad: Signal,
    /// For each latch, how often it stood in an excluded cube.
    weight: Vec<u32>,
}

impl<'a> Pdr<'a> {
    /// A search that knows no more than `lemmas`: cubes that no run reaches.
    pub(crate) fn new(
        system: &'a System,
        bad: Signal,
        lemmas: Vec<Cube>,
        stop: &'a (dyn Fn() -> bool + Sync),
    ) -> Pdr<'a> {
        Pdr { frames: Frames::new(system, lemmas, stop), bad, weight: vec![0; system.latches.len()] }
    }

    /// No run of so many steps shows the signal.
    pub(crate) fn steps(&self) -> usize {
        self.frames.last()
    }

    /// Bytes in use, about.
    pub(crate) fn bytes(&self) -> usize {
        self.frames.bytes()
    }

    /// Goes on for so many ticks.
    pub(crate) fn work(&mut self, ticks: u64) -> Outcome {
        self.frames.allow(ticks);
        self.search().unwrap_or(Outcome::Open)
    }

    fn search(&mut self) -> Result<Outcome, Stopped> {
        loop {
            while let Some(before) = self.frames.shows(self.bad)? {
                if let Some(trace) = self.block(before)? {
                    return Ok(Outcome::Reached(trace));
                }
            }
            if let Some(invariant) = self.push()? {
                return Ok(Outcome::Proved(invariant));
            }
            self.frames.grow();
        }
    }

    /// Excludes a state of the last frame, and the states before it that lead there; or gives
    /// the run that leads there.
    fn block(&mut self, before: Before) -> Result<Option<Trace>, Stopped> {
        let system = self.frames.system;
        let last = self.frames.last();
        let mut duties = vec![Duty { before, then: None }];
        let mut queue = BinaryHeap::from([Reverse((last, 0usize))]);
        while let Some(Reverse((frame, at))) = queue.pop() {
            let Some(cube) = duties.get(at).map(|d| d.before.cube.clone()) else { continue };
            if frame == 0 || touches_start(system, &cube) {
                return Ok(Some(self.run(&duties, at)));
            }
            if self.frames.excludes(&cube, frame) {
                if frame < last {
                    queue.push(Reverse((frame + 1, at)));
                }
                continue;
            }
            match self.frames.consecution(&cube, frame - 1, true)? {
                Consecution::Open(before) => {
                    duties.push(Duty { before, then: Some(at) });
                    queue.push(Reverse((frame - 1, duties.len() - 1)));
                    queue.push(Reverse((frame, at)));
                }
                Consecution::Blocked(smaller) => {
                    let to = self.exclude(smaller, frame, DETOURS)?;
                    if to < last {
                        queue.push(Reverse((to + 1, at)));
                    }
                }
            }
        }
        Ok(None)
    }

    /// Makes a cube that a frame excludes as large as it can, and excludes it as far on as it
    /// can; gives that frame.
    fn exclude(&mut self, cube: Cube, frame: usize, detours: usize) -> Result<usize, Stopped> {
        let mut cube = self.generalise(cube, frame, detours)?;
        let mut frame = frame;
        while frame < self.frames.last() {
            match self.frames.consecution(&cube, frame, true)? {
                Consecution::Blocked(smaller) => cube = smaller,
                Consecution::Open(_) => break,
            }
            frame += 1;
        }
        for s in &cube {
            if let Node::Latch(place) = self.frames.system.graph.node(*s)
                && let Some(w) = self.weight.get_mut(place as usize)
            {
                *w += 1;
            }
        }
        self.frames.add(cube, frame);
        Ok(frame)
    }

    /// Drops one literal after the other as long as the frame excludes the cube.
    fn generalise(&mut self, cube: Cube, frame: usize, detours: usize) -> Result<Cube, Stopped> {
        let system = self.frames.system;
        let weight = |s: &Signal| match system.graph.node(*s) {
            Node::Latch(place) => self.weight.get(place as usize).copied().unwrap_or(0),
            Node::False | Node::Input(_) | Node::And(..) => 0,
        };
        let mut order: Vec<(u32, Signal)> = cube.iter().map(|s| (weight(s), *s)).collect();
        order.sort_unstable();
        let mut cube = cube;
        for (_, s) in order {
            if cube.len() < 2 || !cube.contains(&s) {
                continue;
            }
            let without: Cube = cube.iter().copied().filter(|c| *c != s).collect();
            if let Some(smaller) = self.down(without, frame, detours)? {
                cube = smaller;
            }
        }
        Ok(cube)
    }

    /// Tries to exclude a cube from a frame; states that are in the way are excluded first, if
    /// that is easy.
    fn down(&mut self, cube: Cube, frame: usize, detours: usize) -> Result<Option<Cube>, Stopped> {
        let system = self.frames.system;
        if !cube.iter().any(|s| leaves_start(system, *s)) {
            return Ok(None);
        }
        for detour in 0..=detours {
            let before = match self.frames.consecution(&cube, frame - 1, true)? {
                Consecution::Blocked(smaller) => return Ok(Some(smaller)),
                Consecution::Open(before) => before.cube,
            };
            if detour == detours || frame < 2 || touches_start(system, &before) {
                return Ok(None);
            }
            let Consecution::Blocked(smaller) = self.frames.consecution(&before, frame - 2, true)? else {
                return Ok(None);
            };
            self.exclude(smaller, frame - 1, 0)?;
        }
        Ok(None)
    }

    /// Moves clauses on to later frames. If nothing stays behind in one of them, the frames
    /// behind it are an invariant.
    fn push(&mut self) -> Result<Option<Vec<Cube>>, Stopped> {
        for frame in 1..self.frames.last() {
            let list = self.frames.cubes.get(frame).cloned().unwrap_or_default();
            for cube in list {
                // One that was added since may have taken its place.
                if !self.frames.cubes.get(frame).is_some_and(|l| l.contains(&cube)) {
                    continue;
                }
                if let Consecution::Blocked(smaller) = self.frames.consecution(&cube, frame, false)? {
                    self.frames.add(smaller, frame + 1);
                }
            }
            if self.frames.cubes.get(frame).is_none_or(Vec::is_empty) {
                return Ok(Some(self.frames.cubes.iter().skip(frame + 1).flatten().cloned().collect()));
            }
        }
        Ok(None)
    }

    /// The run from the first step through these states.
    fn run(&self, duties: &[Duty], first: usize) -> Trace {
        let system = self.frames.system;
        let cube = duties.get(first).map_or(&[][..], |d| &d.before.cube);
        let value = |signal: Signal, init: Option<bool>| init.unwrap_or_else(|| cube.contains(&signal));
        let latches = system.latches.iter().map(|l| value(l.signal, l.init.value())).collect();
        let mut inputs = Vec::new();
        let mut at = Some(first);
        while let Some(duty) = at.and_then(|at| duties.get(at)) {
            inputs.push(duty.before.inputs.clone());
            at = duty.then;
        }
        Trace { latches, inputs }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sat::brute::{shortest, system};
    use crate::sat::check::Checker;
    use crate::sat::simulate::shows;

    /// Both answers are right for small systems, each with a run or a certificate.
    #[test]
    fn what_pdr_finds_is_what_all_states_show() {
        let mut counts = [0; 2];
        for seed in 0..4000 {
            let (s, bad) = system(seed);
            let expected = shortest(&s, bad);
            match Pdr::new(&s, bad, Vec::new(), &|| false).work(u64::MAX / 2) {
                Outcome::Proved(cubes) => {
                    assert_eq!(expected, None, "seed {seed}");
                    assert!(Checker::new(&s, &|| false).certifies(&cubes, bad), "seed {seed}");
                    counts[0] += 1;
                }
                Outcome::Reached(trace) => {
                    assert!(shows(&s, &trace, bad), "seed {seed}");
                    assert!(expected.is_some_and(|e| e <= trace.inputs.len()), "seed {seed}");
                    counts[1] += 1;
                }
                Outcome::Open => panic!("seed {seed}: open"),
            }
        }
        assert!(counts.iter().all(|c| *c > 500), "the systems are of both kinds: {counts:?}");
    }

    /// Work that is cut into pieces comes to the same answer.
    #[test]
    fn the_search_goes_on_where_it_was_stopped() {
        for seed in 0..300 {
            let (s, bad) = system(seed);
            let mut search = Pdr::new(&s, bad, Vec::new(), &|| false);
            let mut ticks = 10;
            let reached = loop {
                ticks += ticks / 2;
                match search.work(ticks) {
                    Outcome::Open => assert!(ticks < 1 << 40, "seed {seed}"),
                    Outcome::Proved(_) => break false,
                    Outcome::Reached(_) => break true,
                }
            };
            assert_eq!(reached, shortest(&s, bad).is_some(), "seed {seed}");
        }
    }

    #[test]
    fn what_is_certified_helps_the_next_search() {
        // 30 steps in a row, one active: a token that goes round when it may.
        let mut s = System::default();
        let go = s.input();
        let ring: Vec<Signal> = (0..30).map(|i| s.latch((i == 0).into())).collect();
        for (i, step) in ring.iter().enumerate() {
            let before = ring[(i + ring.len() - 1) % ring.len()];
            let next = s.graph.mux(go, before, *step);
            s.set_next(*step, next);
        }
        let pairs: Vec<Signal> = (0..ring.len())
            .flat_map(|i| (0..i).map(move |k| (i, k)))
            .map(|(i, k)| s.graph.and(ring[i], ring[k]))
            .collect();
        let bad = s.graph.any(pairs);
        let Outcome::Proved(cubes) = Pdr::new(&s, bad, Vec::new(), &|| false).work(1 << 40) else {
            panic!("one step is active at most")
        };
        let mut again = Pdr::new(&s, bad, cubes, &|| false);
        assert!(matches!(again.work(1 << 40), Outcome::Proved(more) if more.is_empty()));
    }
}
