//! The frames of PDR in a solver: for each number of steps, clauses that hold in every state
//! that so many steps can reach.
//!
//! A clause is kept as the cube that it excludes, in the last frame for which it is known.
//! Frame k is the conjunction of what stands at k and behind it; frame 0 is the first step.

use crate::sat::cnf::{Start, Steps};
use crate::sat::cone::{Cube, Lift, leaves_start, next, touches_start};
use crate::sat::graph::{Signal, System};
use crate::sat::solver::{Answer, Batsat, Literal, Solver};

/// The work is to stop.
pub(crate) struct Stopped;

/// Variables for one question alone before the solver is built anew.
const MOST_SPENT: usize = 2000;

/// A state that leads to a cube in one step.
pub(crate) struct Before {
    /// All its states do, with the same inputs.
    pub(crate) cube: Cube,
    /// A value for each input of the system.
    pub(crate) inputs: Vec<bool>,
}

/// The answer to the question whether a step leads from a frame into a cube.
pub(crate) enum Consecution {
    /// No: nor into this cube, which is the same or a larger one.
    Blocked(Cube),
    /// Yes.
    Open(Before),
}

pub(crate) struct Frames<'a> {
    pub(crate) system: &'a System,
    stop: &'a (dyn Fn() -> bool + Sync),
    /// Clauses that hold in every state that can be reached, as cubes.
    lemmas: Vec<Cube>,
    /// For each frame, the cubes that it is the last to exclude.
    pub(crate) cubes: Vec<Vec<Cube>>,
    solver: Batsat<'a>,
    steps: Steps,
    /// For each frame, the literal that switches its clauses on.
    switches: Vec<Literal>,
    lift: Lift,
    spent: usize,
    /// Ticks used by solvers that were replaced.
    ticks: u64,
    /// Ticks at which the work stops.
    most: u64,
}

impl<'a> Frames<'a> {
    /// Frame 0 of a system.
    pub(crate) fn new(
        system: &'a System,
        lemmas: Vec<Cube>,
        stop: &'a (dyn Fn() -> bool + Sync),
    ) -> Frames<'a> {
        let mut solver = Batsat::new(stop);
        let steps = Steps::new(system, &mut solver, Start::Any, false);
        let lift = Lift::new(system);
        let cubes = vec![Vec::new()];
        let switches = Vec::new();
        let (ticks, most, spent) = (0, u64::MAX, 0);
        let mut frames =
            Frames { system, stop, lemmas, cubes, solver, steps, switches, lift, spent, ticks, most };
        frames.build();
        frames
    }

    /// The number of the last frame.
    pub(crate) fn last(&self) -> usize {
        self.cubes.len() - 1
    }

    /// Adds a frame that excludes nothing.
    pub(crate) fn grow(&mut self) {
        self.cubes.push(Vec::new());
        let switch = self.solver.variable(true);
        self.switches.push(switch);
    }

    fn ticks(&self) -> u64 {
        self.ticks + self.solver.ticks()
    }

    /// Bytes in use, about.
    pub(crate) fn bytes(&self) -> usize {
        self.solver.bytes() + self.steps.bytes()
    }

    /// Lets the work go on for so many ticks.
    pub(crate) fn allow(&mut self, ticks: u64) {
        self.most = self.ticks() + ticks;
        self.solver.stop_at(self.most - self.ticks);
    }

    /// Fills a solver without clauses.
    fn build(&mut self) {
        self.ticks += self.solver.ticks();
        self.solver = Batsat::new(self.stop);
        self.solver.stop_at(self.most.saturating_sub(self.ticks));
        self.spent = 0;
        self.steps = Steps::new(self.system, &mut self.solver, Start::Any, false);
        self.switches = self.cubes.iter().map(|_| self.solver.variable(true)).collect();
        for cube in self.lemmas.clone() {
            let clause = self.clause(&cube);
            self.solver.add(&clause);
        }
        for k in 0..self.cubes.len() {
            for cube in self.cubes.get(k).cloned().unwrap_or_default() {
                self.exclude(&cube, k);
            }
        }
    }

    fn literal(&mut self, s: Signal) -> Literal {
        self.steps.literal(self.system, &mut self.solver, 0, s)
    }

    fn clause(&mut self, cube: &[Signal]) -> Vec<Literal> {
        cube.iter().map(|s| !self.literal(*s)).collect()
    }

    fn exclude(&mut self, cube: &[Signal], frame: usize) {
        let mut clause = self.clause(cube);
        clause.extend(self.switches.get(frame).map(|s| !*s));
        self.solver.add(&clause);
    }

    /// Excludes a cube from a frame and those before it.
    pub(crate) fn add(&mut self, cube: Cube, frame: usize) {
        let wider = mask(&cube);
        for list in self.cubes.iter_mut().take(frame + 1) {
            list.retain(|old| wider & !mask(old) != 0 || !is_subset(&cube, old));
        }
        self.exclude(&cube, frame);
        if let Some(list) = self.cubes.get_mut(frame) {
            list.push(cube);
        }
    }

    /// True if a frame excludes a cube by one of its clauses.
    pub(crate) fn excludes(&self, cube: &[Signal], frame: usize) -> bool {
        let mine = mask(cube);
        let wider = |old: &Cube| mask(old) & !mine == 0 && is_subset(old, cube);
        self.cubes.iter().skip(frame).flatten().any(wider)
    }

    /// The literals that make the solver see a frame.
    fn seen_from(&mut self, frame: usize) -> Vec<Literal> {
        let mut list: Vec<Literal> = self.switches.iter().skip(frame).copied().collect();
        if frame == 0 {
            let system = self.system;
            for latch in &system.latches {
                // A latch that no clause knows of cannot matter.
                if let (Some(value), Some(l)) = (latch.init.value(), self.steps.get(0, latch.signal)) {
                    list.push(l.negated_if(!value));
                }
            }
        }
        list
    }

    /// A state of the last frame in which a signal is 1.
    pub(crate) fn shows(&mut self, bad: Signal) -> Result<Option<Before>, Stopped> {
        let target = self.literal(bad);
        let mut assumed = self.seen_from(self.last());
        assumed.push(target);
        match self.solver.solve(&assumed) {
            Answer::Stopped => Err(Stopped),
            Answer::No => Ok(None),
            Answer::Yes => Ok(Some(self.before(&[bad]))),
        }
    }

    /// Does a step lead from a frame into a cube? With `outside` only from states that are not
    /// in the cube themselves.
    pub(crate) fn consecution(
        &mut self,
        cube: &[Signal],
        frame: usize,
        outside: bool,
    ) -> Result<Consecution, Stopped> {
        if self.spent > MOST_SPENT {
            self.build();
        }
        let system = self.system;
        let nexts: Vec<Literal> = cube.iter().map(|s| self.literal(next(system, *s))).collect();
        let mut assumed = Vec::new();
        if outside {
            let mut clause = self.clause(cube);
            let once = self.solver.variable(true);
            clause.push(!once);
            self.solver.add(&clause);
            assumed.push(once);
            self.spent += 1;
        }
        assumed.extend(self.seen_from(frame));
        assumed.extend(&nexts);
        let answer = self.solver.solve(&assumed);
        let answer = match answer {
            Answer::Stopped => Err(Stopped),
            Answer::Yes => {
                let targets: Vec<Signal> = cube.iter().map(|s| next(system, *s)).collect();
                Ok(Consecution::Open(self.before(&targets)))
            }
            Answer::No => Ok(Consecution::Blocked(self.needed(cube, &nexts))),
        };
        if outside && let Some(once) = assumed.first() {
            self.solver.add(&[!*once]);
        }
        answer
    }

    /// The literals of a cube that the solver needed. If these allow an initial state, one literal that
    /// excludes it is added.
    fn needed(&self, cube: &[Signal], nexts: &[Literal]) -> Cube {
        let mut smaller: Cube =
            cube.iter().zip(nexts).filter(|(_, l)| self.solver.is_needed(**l)).map(|(s, _)| *s).collect();
        if touches_start(self.system, &smaller) {
            smaller.extend(cube.iter().find(|s| leaves_start(self.system, **s)));
            smaller.sort_unstable();
            smaller.dedup();
        }
        smaller
    }

    /// The values of latches and inputs in the solver's model, for those that the targets and constraints depend on.
    fn before(&mut self, targets: &[Signal]) -> Before {
        let system = self.system;
        let (solver, steps) = (&self.solver, &self.steps);
        let value = |s: Signal| steps.get(0, s).is_some_and(|l| solver.value(l));
        let all = targets.iter().chain(&system.constraints).copied();
        let cube = self.lift.cube(system, all, value);
        Before { cube, inputs: system.inputs.iter().map(|s| value(*s)).collect() }
    }
}

/// A word in which a bit is set for each signal of a cube; a part of the cube has no other bits.
fn mask(cube: &[Signal]) -> u64 {
    cube.iter().fold(0, |word, s| word | 1 << (s.code() % 64))
}

/// True if all signals of one sorted list are in another.
pub(crate) fn is_subset(part: &[Signal], whole: &[Signal]) -> bool {
    let mut rest = whole.iter();
    part.iter().all(|s| rest.by_ref().find(|w| *w >= s) == Some(s))
}
