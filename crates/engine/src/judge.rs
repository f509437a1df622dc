//! Which transitions are enabled, and which of them would clear: for those who
//! look on. A pass judges in its own way, for speed; both ask the same guards.

use crate::bits::Walk;
use crate::fault::Fault;
use crate::pass::{block, rest_active};
use crate::run::guard;
use crate::state::State;
use crate::{NONE, Program, watch};

/// Tells of every transition that is enabled in a state, by rank, and whether it
/// would clear in the next pass if nothing came in before: its receptivity holds
/// and its chart is not blocked. Priorities are left out.
///
/// # Errors
///
/// A [`Fault`] of a receptivity or a watched expression; those behind it are not told.
pub fn enabled(p: &Program, s: &State, mut tell: impl FnMut(u32, bool)) -> Result<(), Fault> {
    // Sections leave their values in variables: not in those of the run.
    let mut s = s.clone();
    s.x.work = 0;
    s.x.stack.clear();
    if !s.x.first_pass {
        watch::update(p, &mut s, false, false)?;
    }
    if p.has_periods || p.has_orders {
        block(p, &mut s);
    }
    let mut judge = |s: &mut State, rank: u32| -> Result<(), Fault> {
        let Some(t) = p.t.transitions.get(rank as usize) else { return Ok(()) };
        if (t.from.0 != NONE && !s.is_active(t.from)) || !rest_active(p, s, t) {
            return Ok(());
        }
        let blocked = s.x.any_blocked && s.x.blocked.get(t.chart as usize).copied().unwrap_or(false);
        let holds = !blocked && guard(p, s, t.guard)?;
        tell(rank, holds);
        Ok(())
    };
    for rank in &p.t.sources {
        judge(&mut s, *rank)?;
    }
    let tree = s.steps;
    let mut walk = Walk::new(&tree, &s.w);
    while let Some(step) = walk.next(&tree, &s.w) {
        let rows = p.t.steps.get(step as usize).map(|row| row.out.start as usize..row.out.end as usize);
        for rank in rows.and_then(|rows| p.t.outs.get(rows)).unwrap_or(&[]) {
            judge(&mut s, *rank)?;
        }
    }
    Ok(())
}
