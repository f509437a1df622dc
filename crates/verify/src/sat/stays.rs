//! Traps judged by a search: from the end of a run every state that follows is visited.

use std::sync::atomic::{AtomicBool, Ordering};

use g7_engine::{State, StepId, eval, scan};

use crate::explore::Move;
use crate::layer::Budget;
use crate::model::Model;
use crate::question::{Claim, Query};
use crate::scene::{Scene, Until};
use crate::search::Search;

/// Most states that follow a run.
const STATES: usize = 20_000;
/// Most scans of a search.
const SCANS: usize = 100_000;

/// True if behind these scans no run does what the claim asks for, as a search of all states that follow
/// shows.
pub(crate) fn is_trap(model: &Model<'_>, claim: &Claim, moves: &[Move], budget: &Budget<'_>) -> bool {
    let p = &model.compiled.program;
    let mut s = State::new(p);
    for m in moves {
        let now = s.now().saturating_add(m.wait);
        if scan(p, &mut s, &m.inputs, now).is_err() {
            return false;
        }
    }
    let situation: Vec<StepId> = s.active().collect();
    let reached = AtomicBool::new(false);
    let stop = || reached.load(Ordering::Relaxed) || (budget.stop)();
    let small = Budget { states: budget.states.min(STATES), scans: SCANS, bytes: budget.bytes, stop: &stop };
    let mut look = |scene: Scene<'_>| {
        let state = scene.state;
        let is_there = match claim {
            Claim::NoDeadlock => {
                scene.fault.is_some()
                    || !state.cleared().is_empty()
                    || !state.active().eq(situation.iter().copied())
            }
            // A condition without a value decides nothing.
            Claim::LeadsTo { effect, .. } => {
                scene.fault.is_none() && holds(model, state, *effect) != Some(false)
            }
            _ => true,
        };
        if is_there {
            reached.store(true, Ordering::Relaxed);
        }
    };
    let mut search = Search::new(model, &small, Vec::new());
    search.start = moves;
    search.until = Until::Visited;
    search.look = Some(&mut look);
    search.search();
    search.seen().open.is_none() && !reached.load(Ordering::Relaxed)
}

fn holds(model: &Model<'_>, state: &mut State, q: Query) -> Option<bool> {
    let parts = model.conditions.get(q.0 as usize)?;
    let mut all = true;
    for part in parts {
        all &= eval(&model.compiled.program, state, part.code).ok()? != 0;
    }
    Some(all)
}
