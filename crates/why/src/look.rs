//! One scan, made pass by pass by the parts of the engine: the state behind each part, and what cleared and ran in it.

use g7_engine::{Program, State, begin, finish, judged, pass};
use g7_host::{Player, Tape};

use crate::signal::Signal;

/// Passes of a scan that are kept; a longer search goes on without.
const PASSES: usize = 200;

/// A part of a scan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// The writes from outside before the scan.
    Outside,
    /// Inputs, time, edges, PRE and services; in the first scan the initial situation.
    Begin,
    /// A pass of the evolution, from 1.
    Pass(usize),
    /// Control blocks, bodies, POST.
    Finish,
}

/// A part of a scan that was made.
pub(crate) struct Stage {
    pub(crate) part: Part,
    /// The state behind it.
    pub(crate) after: State,
    /// The state in which a pass judges the transitions.
    pub(crate) judged: Option<State>,
    /// The transitions (ranks) that cleared.
    pub(crate) cleared: Vec<u32>,
    /// The actions (ranks) that ran.
    pub(crate) ran: Vec<u32>,
}

/// A scan.
pub(crate) struct Look {
    /// The state behind the scan before.
    before: State,
    pub(crate) stages: Vec<Stage>,
    /// It began with the first activation of the initial steps.
    pub(crate) first: bool,
    /// A fault ended it.
    pub(crate) fault: bool,
}

impl Look {
    /// The scan that follows behind a place on a tape.
    pub(crate) fn new(p: &Program, tape: &Tape, mut player: Player) -> Look {
        let before = player.state().clone();
        let now = player.prepare(tape, p);
        let mut state = player.state().clone();
        let first = !state.is_started();
        let mut look = Look { before, stages: Vec::new(), first, fault: false };
        look.add(Part::Outside, &state, None, false);
        let done = now.is_some_and(|now| begin(p, &mut state, player.inputs(), now.count()).is_ok());
        look.add(Part::Begin, &state, None, done);
        let whole = done && look.passes(p, &mut state);
        if whole {
            state.forget_reports();
            finish(p, &mut state).ok();
        }
        player.scan(tape, p).ok();
        look.fault = player.state().is_stopped();
        // The scan as the run made it is the one that counts.
        look.add(Part::Finish, &state, None, whole);
        if let Some(last) = look.stages.last_mut() {
            last.after = player.state().clone();
        }
        look
    }

    /// Makes the passes; false where a fault or too many of them end it.
    fn passes(&mut self, p: &Program, state: &mut State) -> bool {
        for number in 1..=PASSES {
            state.forget_reports();
            let seen = judged(p, state).ok();
            let more = pass(p, state);
            self.add(Part::Pass(number), state, seen, true);
            match more {
                Ok(true) if p.tables().rules.stable => {}
                Ok(_) => return true,
                Err(_) => return false,
            }
        }
        false
    }

    fn add(&mut self, part: Part, state: &State, judged: Option<State>, reports: bool) {
        let (cleared, ran) = if reports {
            (
                if matches!(part, Part::Pass(_)) { state.cleared().to_vec() } else { Vec::new() },
                state.ran().to_vec(),
            )
        } else {
            (Vec::new(), Vec::new())
        };
        self.stages.push(Stage { part, after: state.clone(), judged, cleared, ran });
    }

    /// The state before a stage.
    pub(crate) fn before(&self, stage: usize) -> &State {
        let at = stage.checked_sub(1).and_then(|at| self.stages.get(at));
        at.map_or(&self.before, |s| &s.after)
    }

    /// The state behind a stage.
    pub(crate) fn after(&self, stage: usize) -> &State {
        self.stages.get(stage).map_or(&self.before, |s| &s.after)
    }

    /// True if a stage changes a signal.
    pub(crate) fn changes(&self, p: &Program, signal: Signal, stage: usize) -> bool {
        signal.of(p, self.before(stage)) != signal.of(p, self.after(stage))
    }
}
