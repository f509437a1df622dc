//! Claims about scans one after the other, with what is to be remembered between them.

use g7_engine::Fault;

use crate::model::Model;
use crate::question::{Claim, Query};
use crate::world::World;

/// Nothing is remembered.
pub(crate) const IDLE: u64 = 0;

/// The judgement of a scan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Seen {
    /// The word to be remembered.
    pub(crate) memory: u64,
    /// The scan breaks the claim; for [`Claim::Reachable`], it shows it.
    pub(crate) hit: bool,
}

/// True if the claim is about the ends of scans.
pub(crate) fn is_of_scans(claim: &Claim) -> bool {
    has_memory(claim)
        || matches!(claim, Claim::Always(_) | Claim::Never(_) | Claim::Reachable(_) | Claim::AtMost(..))
}

/// True if the claim asks for what was before.
pub(crate) fn has_memory(claim: &Claim) -> bool {
    matches!(
        claim,
        Claim::Within { .. } | Claim::Until { .. } | Claim::Between { .. } | Claim::LeadsTo { .. }
    )
}

/// Judges the end of a scan. `memory` is that of the scan before, `wait` the time since.
///
/// # Errors
///
/// A fault of a condition.
pub(crate) fn judge(
    model: &Model<'_>,
    claim: &Claim,
    world: &mut World<'_>,
    memory: u64,
    wait: i64,
) -> Result<Seen, Fault> {
    step(claim, memory, wait, |q| world.holds(model, q))
}

/// Judges the end of a scan for each of these claims that is about ends of scans. Shows for each, with its number,
/// if the scan breaks it, or the fault of a condition; gives what the one with a memory remembers.
pub(crate) fn judge_each<'c>(
    model: &Model<'_>,
    claims: impl Iterator<Item = (usize, &'c Claim)>,
    world: &mut World<'_>,
    memory: u64,
    wait: i64,
    mut show: impl FnMut(usize, Result<bool, Fault>),
) -> u64 {
    let mut kept = IDLE;
    for (number, claim) in claims.filter(|(_, c)| is_of_scans(c)) {
        match judge(model, claim, world, memory, wait) {
            Ok(seen) => {
                kept = if has_memory(claim) { seen.memory } else { kept };
                show(number, Ok(seen.hit));
            }
            Err(fault) => show(number, Err(fault)),
        }
    }
    kept
}

/// One claim where `holds` tells the conditions: the one definition of what each claim means.
///
/// # Errors
///
/// `holds` gave an error for a condition that the claim needs.
pub(crate) fn step<E>(
    claim: &Claim,
    memory: u64,
    wait: i64,
    mut holds: impl FnMut(Query) -> Result<bool, E>,
) -> Result<Seen, E> {
    let mut is = |q: &Query| holds(*q);
    let seen = |memory, hit| Ok(Seen { memory, hit });
    match claim {
        Claim::Always(q) => seen(IDLE, !is(q)?),
        Claim::Never(q) | Claim::Reachable(q) => seen(IDLE, is(q)?),
        Claim::AtMost(most, list) => {
            let mut count = 0u32;
            for q in list {
                count += u32::from(is(q)?);
            }
            seen(IDLE, count > *most)
        }
        // 1 more than the time since the first cause that waits.
        Claim::Within { cause, within, effect } => {
            let waited = if memory == IDLE { IDLE } else { memory.saturating_add(wait.max(0) as u64) };
            if waited > 1 && waited - 1 > *within as u64 {
                return seen(IDLE, true);
            }
            let (cause, effect) = (is(cause)?, is(effect)?);
            let memory = match waited {
                _ if effect => IDLE,
                IDLE if cause => 1,
                waited => waited,
            };
            seen(memory, false)
        }
        Claim::Until { from, to, holds } => {
            let on = !is(to)? && (memory != IDLE || is(from)?);
            seen(u64::from(on), on && !is(holds)?)
        }
        // 1 behind the first condition, 2 behind the one that must not come.
        Claim::Between { from, to, never } => {
            if is(to)? {
                return seen(IDLE, memory == 2);
            }
            let on = memory != IDLE || is(from)?;
            let memory = if !on {
                IDLE
            } else if memory == 2 || is(never)? {
                2
            } else {
                1
            };
            seen(memory, false)
        }
        // 1 while the effect is to come. Whether it can is asked of the whole graph.
        Claim::LeadsTo { cause, effect } => {
            let waits = !is(effect)? && (memory != IDLE || is(cause)?);
            seen(u64::from(waits), false)
        }
        _ => seen(IDLE, false),
    }
}
