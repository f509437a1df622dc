//! The search: breadth first over the states that a program reaches.

use std::collections::VecDeque;

use g7_engine::{Fault, Program, State, begin, finish, pass, scan};

use crate::store::Store;
use crate::world::put;

/// One scan of a run.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Move {
    /// The inputs, a word for each word of [`g7_engine::Tables::inputs`].
    pub inputs: Vec<u64>,
    /// The time since the scan before, ns. The first scan is at this time.
    pub wait: i64,
}

/// The moves that a search tries.
pub trait Moves {
    /// Appends the moves to be tried in a state. `last` are the inputs of the scan that
    /// led there, since a state keeps only those that something remembers.
    ///
    /// Tells whether the moves are all that matter: whether every other one leads to a
    /// state to which one of these leads.
    fn moves(&self, p: &Program, state: &State, last: &[u64], into: &mut Vec<Move>) -> bool;
}

/// How much a search may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Most states kept.
    pub states: usize,
    /// Most scans made.
    pub scans: usize,
}

/// A moment of a scan at which a search shows the state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moment {
    /// Behind the inputs, before the evolution. In the first scan this shows the
    /// initial situation.
    Begin,
    /// Behind a pass of the evolution. The situation may be a transient one.
    Pass,
    /// At the end of the scan.
    End,
    /// A fault stopped the scan.
    Fault(Fault),
}

/// The caller's choice of how a search goes on after a moment that it was shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// This is the moment that was searched.
    Stop,
    /// Goes on with the state at the end of this scan before all others. After that
    /// runs need not be the shortest, but a state far away may be found sooner.
    Hurry,
    /// Goes on in order.
    Go,
}

impl From<bool> for Next {
    /// True if the moment is the one that was searched.
    fn from(found: bool) -> Next {
        if found { Next::Stop } else { Next::Go }
    }
}

/// The answer of a search.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Answer {
    /// This run leads there. None with fewer scans does, unless the caller asked for
    /// hurry ([`Next::Hurry`]).
    Found(Vec<Move>),
    /// No run leads there: all states were visited by all moves that matter.
    Never,
    /// Not decided.
    Open(Bound),
}

/// The reason why a search did not decide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// There are more states than [`Limits::states`].
    States,
    /// There are more scans to make than [`Limits::scans`].
    Scans,
    /// Not all moves that may matter were tried.
    Moves,
}

/// Passes after which the engine is asked whether the scan ends.
const PASSES: u32 = 64;

/// A search over the states of a program.
pub struct Explorer<'p> {
    program: &'p Program,
    limits: Limits,
    store: Store,
    /// For each state but the first: the state before, and the move between.
    parents: Vec<(u32, Move)>,
    scans: usize,
}

impl<'p> Explorer<'p> {
    /// A search that has visited nothing.
    pub fn new(program: &'p Program, limits: Limits) -> Explorer<'p> {
        Explorer { program, limits, store: Store::new(), parents: Vec::new(), scans: 0 }
    }

    /// The number of states visited, the one before the first scan included.
    pub fn states(&self) -> usize {
        self.store.len()
    }

    /// The number of scans made.
    pub fn scans(&self) -> usize {
        self.scans
    }

    /// Searches from the state before the first scan, breadth first, until `look` stops
    /// it at a moment of a scan. States that are equal but for the time of day count as
    /// one. A scan with a fault leads to no further state.
    pub fn search(&mut self, moves: &impl Moves, mut look: impl FnMut(&State, Moment) -> Next) -> Answer {
        let p = self.program;
        let (mut state, mut image, mut list) = (State::new(p), Vec::new(), Vec::new());
        state.canonical(p, &mut image);
        self.store = Store::new();
        self.parents.clear();
        self.scans = 0;
        self.store.insert(&image);
        let none = vec![0; (p.tables().inputs.end - p.tables().inputs.start) as usize];
        let (mut complete, mut queue) = (true, VecDeque::from([0usize]));
        while let Some(at) = queue.pop_front() {
            let own = self.store.image(at);
            put(p, &mut state, &own);
            let last = at.checked_sub(1).and_then(|i| self.parents.get(i)).map_or(&none, |(_, m)| &m.inputs);
            complete &= moves.moves(p, &state, last, &mut list);
            for m in list.drain(..) {
                if self.scans >= self.limits.scans {
                    return Answer::Open(Bound::Scans);
                }
                self.scans += 1;
                put(p, &mut state, &own);
                let hurry = match self.scan(&mut state, at, &m, &mut look) {
                    End::Found => return Answer::Found(self.run(at, m)),
                    End::Fault => continue,
                    End::Rest { hurry } => hurry,
                };
                state.canonical(p, &mut image);
                if self.store.len() >= self.limits.states && !self.store.contains(&image) {
                    return Answer::Open(Bound::States);
                }
                let number = self.store.len();
                if self.store.insert(&image) {
                    self.parents.push((at as u32, m));
                    if hurry { queue.push_front(number) } else { queue.push_back(number) }
                }
            }
        }
        if complete { Answer::Never } else { Answer::Open(Bound::Moves) }
    }

    /// The run by which a state was found, and one move more.
    fn run(&self, mut at: usize, last: Move) -> Vec<Move> {
        let mut run = vec![last];
        while let Some((before, m)) = at.checked_sub(1).and_then(|i| self.parents.get(i)) {
            run.push(m.clone());
            at = *before as usize;
        }
        run.reverse();
        run
    }

    /// One scan, shown pass by pass.
    fn scan(&self, s: &mut State, at: usize, m: &Move, look: &mut impl FnMut(&State, Moment) -> Next) -> End {
        let mut hurry = false;
        let mut show = |s: &State, moment| {
            let next = look(s, moment);
            hurry |= next == Next::Hurry;
            next == Next::Stop
        };
        match self.passes(s, at, m, &mut show) {
            Ok(true) => End::Found,
            Ok(false) if show(s, Moment::End) => End::Found,
            Ok(false) => End::Rest { hurry },
            Err(fault) if show(s, Moment::Fault(fault)) => End::Found,
            Err(_) => End::Fault,
        }
    }

    /// The parts of a scan; tells whether one of them showed the moment that was
    /// searched. A search for stability that lasts is judged by the engine, which knows
    /// whether it ends.
    fn passes(
        &self,
        s: &mut State,
        at: usize,
        m: &Move,
        show: &mut impl FnMut(&State, Moment) -> bool,
    ) -> Result<bool, Fault> {
        let p = self.program;
        let now = s.now().saturating_add(m.wait);
        begin(p, s, &m.inputs, now)?;
        if show(s, Moment::Begin) {
            return Ok(true);
        }
        let mut made = 0;
        loop {
            let changed = pass(p, s)?;
            made += 1;
            if show(s, Moment::Pass) {
                return Ok(true);
            }
            if !changed || !p.tables().rules.stable {
                break;
            }
            if made == PASSES.min(p.tables().rules.bound) {
                let mut whole = s.clone();
                put(p, &mut whole, &self.store.image(at));
                scan(p, &mut whole, &m.inputs, now)?;
            }
        }
        finish(p, s)?;
        Ok(false)
    }
}

/// The end of one scan of a search.
enum End {
    Found,
    Fault,
    Rest { hurry: bool },
}
