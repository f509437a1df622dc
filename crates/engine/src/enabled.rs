//! The enabled transitions, and those of them that would clear, for tools that show
//! a run. A pass finds them in a faster way of its own; both evaluate the same
//! receptivities.

use crate::bits::Walk;
use crate::fault::Fault;
use crate::pass::{block, rest_active};
use crate::program::Program;
use crate::run::holds;
use crate::state::State;
use crate::tables::NONE;
use crate::watch;

/// Calls `tell` with the rank of every transition that is enabled in a state, and
/// whether it would clear in the next pass if no input changed before: whether its
/// receptivity is true and its chart is not blocked. Priorities are left out.
///
/// # Errors
///
/// A [`Fault`] of a receptivity or a watched expression. The transitions behind it are
/// left out.
pub fn enabled(p: &Program, s: &State, mut tell: impl FnMut(u32, bool)) -> Result<(), Fault> {
    let mut s = judged(p, s)?;
    let mut judge = |s: &mut State, rank: u32| -> Result<(), Fault> {
        let Some(t) = p.tables.transitions.get(rank as usize) else { return Ok(()) };
        if (t.from.0 != NONE && !s.is_active(t.from)) || !rest_active(p, s, t) {
            return Ok(());
        }
        let holds = !s.is_blocked(t.chart) && holds(p, s, t.receptivity)?;
        tell(rank, holds);
        Ok(())
    };
    for rank in &p.tables.sources {
        judge(&mut s, *rank)?;
    }
    let tree = s.steps;
    let mut walk = Walk::new(&tree, &s.image);
    while let Some(step) = walk.next(&tree, &s.image) {
        let rows = p.tables.steps.get(step as usize).map(|row| row.out.start as usize..row.out.end as usize);
        for rank in rows.and_then(|rows| p.tables.outs.get(rows)).unwrap_or(&[]) {
            judge(&mut s, *rank)?;
        }
    }
    Ok(())
}

/// A copy of a state between two passes in which edges, timers and blocked charts are as the next pass has them
/// when it judges the transitions. The run itself is not changed: transition sections may write variables.
///
/// # Errors
///
/// A [`Fault`] of a watched expression.
pub fn judged(p: &Program, s: &State) -> Result<State, Fault> {
    let mut s = s.clone();
    s.scratch.work = 0;
    s.scratch.stack.clear();
    if !s.scratch.first_pass {
        watch::update(p, &mut s, false, false)?;
    }
    if p.has_periods || p.has_orders {
        block(p, &mut s);
    }
    Ok(s)
}

impl State {
    /// True if a chart ([`crate::Transition::chart`]) clears no transition in this pass: its period is not over, or an
    /// order holds it. Call this only on a state that [`judged`] returned.
    pub fn is_blocked(&self, chart: u32) -> bool {
        self.scratch.any_blocked && self.scratch.blocked.get(chart as usize).copied().unwrap_or(false)
    }
}
