//! The numbers of active steps and of enabled transitions, which PL7 and Unity limit and show in the
//! words `%SW20` and `%SW21`.

use crate::bits::set_bit;
use crate::fault::Fault;
use crate::memory::write;
use crate::ops::Addr;
use crate::pass::rest_active;
use crate::program::Program;
use crate::state::State;
use crate::tables::NONE;

/// Number of active steps, without those that stand for macro-steps.
pub(crate) fn active_now(p: &Program, s: &State) -> u32 {
    let stands_in = |step: &u32| p.extra(*step).is_some_and(|e| e.uncounted);
    s.active().filter(|step| !stands_in(&step.0)).count() as u32
}

/// True if a transition is enabled and counts.
fn is_enabled(p: &Program, s: &State, i: usize) -> bool {
    p.tables
        .transitions
        .get(i)
        .filter(|t| !t.uncounted)
        .is_some_and(|t| (t.from.0 == NONE || s.steps.contains(&s.image, t.from.0)) && rest_active(p, s, t))
}

pub(crate) fn enabled_now(p: &Program, s: &State) -> u32 {
    (0..p.tables.transitions.len()).filter(|i| is_enabled(p, s, *i)).count() as u32
}

/// Notes which transitions are enabled, before or after the evolution.
pub(crate) fn enabled(p: &Program, s: &mut State, after: bool) -> Result<(), Fault> {
    for i in 0..p.tables.transitions.len() {
        let on = is_enabled(p, s, i);
        let scratch = &mut s.scratch;
        set_bit(if after { &mut scratch.enabled_after } else { &mut scratch.enabled }, 0, i as u32, on);
    }
    if !after {
        s.scratch.active_before = active_now(p, s);
    }
    Ok(())
}

/// Writes `%SW20` and `%SW21`: steps that were active or changed in this scan, and
/// transitions that were enabled or changed.
pub(crate) fn count(
    p: &Program,
    s: &mut State,
    moved: u32,
    steps: Addr,
    transitions: Addr,
) -> Result<(), Fault> {
    enabled(p, s, true)?;
    let (mut was, mut changed) = (0, 0);
    for (b, a) in s.scratch.enabled.iter().zip(s.scratch.enabled_after.iter()) {
        was += b.count_ones();
        changed += (b ^ a).count_ones();
    }
    let total = |n: u32| u64::from(n.min(32767));
    let active = s.scratch.active_before;
    write(p, s, steps, total(active.saturating_add(moved)));
    write(p, s, transitions, total(was + changed));
    Ok(())
}
