//! Claims about what can follow: the states that wait for something, and the scans that reach it.
//!
//! The meaning is that of `search/answers.rs`: a deadlock is a state from which no run changes the
//! situation again, though an active step has a transition behind it; `leads to` fails in a state that
//! waits for the effect and can reach it no more. A fault changes the situation; it is no effect.

use g7_engine::NONE;

use super::claims::{Asked, End};
use crate::look::sides;
use crate::question::Claim;
use crate::sat::{Init, Signal};

/// A claim about what can follow, in the system.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Follows {
    /// A function of the latches: the state waits.
    pub(crate) waits: Signal,
    /// The scan reaches what is waited for.
    pub(crate) goal: Signal,
    /// The scan reaches it, or it is not known whether it does.
    pub(crate) may: Signal,
}

/// The signals of a claim, if it is of this kind. `before` has the activity of each step before the scan.
pub(crate) fn follows(end: &mut End<'_, '_>, claim: &Claim, before: &[Signal]) -> Option<(Asked, Follows)> {
    let open = end.x.uncovered.clone();
    let open = end.x.g().any(open);
    let on = !end.stopped;
    let (waits, goal, fails) = match claim {
        Claim::NoDeadlock => {
            let t = end.x.model.compiled.program.tables();
            let leaving = |step: u32| {
                (0..t.transitions.len() as u32).any(|r| step != NONE && sides(t, r).0.contains(&step))
            };
            let waiting = (0u32..).zip(before).filter(|(i, _)| leaving(*i)).map(|(_, s)| *s);
            let waits = end.x.g().any(waiting.collect::<Vec<_>>());
            let mut changes = end.sights.clears.clone();
            changes.extend(end.x.faults.iter().map(|f| f.2));
            let now = end.x.steps();
            for (before, now) in before.iter().zip(now) {
                changes.push(end.x.g().xor(*before, now));
            }
            (waits, end.x.g().any(changes), Signal::FALSE)
        }
        Claim::LeadsTo { cause, effect } => {
            let ((cause, no_cause), (effect, no_effect)) = (end.query(*cause), end.query(*effect));
            let waits = end.x.system.latch(Init::Zero);
            let sound = end.x.run;
            let g = end.x.g();
            let begins = g.or(waits, cause);
            let next = g.and(begins, !effect);
            // The cause is asked for only where nothing waits and the effect is not there.
            let asked = g.or(waits, effect);
            let no_cause = g.and(no_cause, !asked);
            let fails = g.or(no_effect, no_cause);
            let fails = g.and(fails, sound);
            let goal = g.all([sound, effect, !no_effect]);
            end.x.system.set_next(waits, next);
            (waits, goal, fails)
        }
        _ => return None,
    };
    let g = end.x.g();
    let unsure = g.or(open, fails);
    let reached = g.any([goal, unsure]);
    let follows =
        Follows { waits: g.and(waits, on), goal: g.all([goal, on, !open]), may: g.and(reached, on) };
    Some((Asked { bad: Signal::FALSE, unsure: g.and(unsure, on) }, follows))
}
