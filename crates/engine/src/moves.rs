//! Plain steps and transitions (`rows.rs`): the part of a pass that needs no marks, and scans in
//! which nothing but one token can act. They have the same meaning as `pass.rs` and `change.rs`,
//! but leave out what cannot occur. `tests/ways.rs` runs the same charts with and without them.

use crate::bits::{Tree, Walk, bit, set_bit, word};
use crate::layout::head;
use crate::program::Program;
use crate::rows::{Hot, output};
use crate::scratch::Scratch;
use crate::state::State;
use crate::tables::NONE;

/// True if the receptivity behind a hot step is true.
#[inline(always)]
fn holds(p: &Program, image: &[u64], h: &Hot) -> bool {
    if h.decides {
        return p.decisions.decide(image, h.waits_for);
    }
    (word(image, h.waits_for as usize) != 0) != h.flip
}

/// True if something other than plain steps may act in the next pass: an edge, a timer, a control
/// block, an order, an event action or an action of each scan.
#[inline(always)]
pub(crate) fn is_awake(p: &Program, image: &[u64]) -> bool {
    p.awake.iter().any(|top| word(image, *top as usize) != 0)
}

/// Makes a pass while the only active step is a hot one whose transition leads to one other plain
/// step and nothing else is awake, so that nothing need be searched. Tells whether the token moved;
/// otherwise does nothing and returns `None`.
#[inline(always)]
pub(crate) fn one_token(p: &Program, s: &mut State) -> Option<bool> {
    let State { image, scratch, steps, .. } = s;
    let from = scratch.lone;
    let hot = p.hot.get(from as usize)?;
    let Hot { rank, to, from_output, to_output, .. } = *hot;
    if to == NONE {
        return None;
    }
    if !holds(p, image, hot) {
        return Some(false);
    }
    if scratch.cleared.len() < scratch.cleared.capacity() {
        scratch.cleared.push(rank);
    }
    scratch.lone = to;
    steps.pass_on(image, from, to);
    let now = word(image, head::NOW);
    let stamps = p.layout.stamps;
    if let Some(stamp) = image.get_mut((stamps + to) as usize) {
        *stamp = now;
    }
    if let Some(stamp) = image.get_mut((stamps + from) as usize) {
        *stamp = if p.tables.rules.keep_step_time { now.wrapping_sub(*stamp) } else { 0 };
    }
    if let Some(o) = image.get_mut(to_output as usize) {
        *o = 1;
    }
    if let Some(o) = image.get_mut(from_output as usize) {
        *o = 0;
    }
    Some(true)
}

/// Collects the clearable transitions behind the hot steps, and the other active steps in `slow`.
#[inline]
pub(crate) fn collect(p: &Program, s: &mut State) {
    let State { image, scratch, steps, .. } = s;
    scratch.slow.clear();
    let mut seen = 0u32;
    let mut walk = Walk::new(steps, image);
    while let Some(step) = walk.next(steps, image) {
        seen += 1;
        scratch.lone = if seen == 1 { step } else { NONE };
        let Some(h) = p.hot.get(step as usize) else { break };
        if h.waits_for == NONE {
            scratch.slow.push(step);
        } else if holds(p, image, h) {
            scratch.fired.push(h.rank);
        }
    }
}

/// True if all transitions that clear are plain, and nothing else is to be done in the pass.
#[inline]
pub(crate) fn are_plain(p: &Program, scratch: &Scratch) -> bool {
    let plain = |rank: &u32| p.moves.get(*rank as usize).is_some_and(|m| m.plain);
    scratch.on.is_empty()
        && scratch.off.is_empty()
        && scratch.runs.is_empty()
        && (p.all_plain || scratch.fired.iter().all(plain))
}

/// Clears the transitions of a pass in which all are plain. Tells whether a step changed.
pub(crate) fn clear(p: &Program, s: &mut State) -> bool {
    let State { image, scratch, steps, .. } = s;
    let Scratch { fired, on_mark, .. } = scratch;
    let now = word(image, head::NOW);
    let keep = p.tables.rules.keep_step_time;
    let mut area = Area { image, steps: *steps, now, stamps: p.layout.stamps, keep, changed: false };
    // After a lone token has moved by one transition, its place is known.
    scratch.lone = match fired[..] {
        [i] if scratch.lone != NONE => {
            p.moves.get(i as usize).filter(|m| m.from == scratch.lone).map_or(NONE, |m| m.to)
        }
        _ => NONE,
    };
    // Rule 5: a step that is both activated and deactivated stays active. It can
    // only be one that was active before.
    let mut stay = false;
    for i in fired.iter() {
        each_end(p, *i, true, |to, output| {
            if !area.on(to, output) {
                stay = true;
                set_bit(on_mark, 0, to, true);
            }
        });
    }
    for i in fired.iter() {
        each_end(p, *i, false, |from, output| {
            if !stay || !bit(on_mark, 0, from) {
                area.off(from, output);
            }
        });
    }
    if stay {
        for i in fired.iter() {
            each_end(p, *i, true, |to, _| {
                set_bit(on_mark, 0, to, false);
            });
        }
    }
    area.changed
}

/// Calls `f` with each succeeding (or preceding) step of a transition and its output.
#[inline(always)]
fn each_end(p: &Program, rank: u32, succeeding: bool, mut f: impl FnMut(u32, u32)) {
    let Some(m) = p.moves.get(rank as usize) else { return };
    if m.from != NONE {
        let (step, output) = if succeeding { (m.to, m.to_output) } else { (m.from, m.from_output) };
        f(step, output);
        return;
    }
    ends(p, rank, succeeding, &mut f);
}

/// The same for a transition with several steps or none on a side.
fn ends(p: &Program, rank: u32, succeeding: bool, f: &mut dyn FnMut(u32, u32)) {
    let Some(t) = p.tables.transitions.get(rank as usize) else { return };
    let g = |step: u32| f(step, output(&p.tables, &p.layout, step));
    if succeeding { p.tables.each_to(t, g) } else { p.tables.each_from(t, g) }
}

/// The parts of a state that change with steps.
struct Area<'a> {
    image: &'a mut [u64],
    steps: Tree,
    now: u64,
    stamps: u32,
    keep: bool,
    changed: bool,
}

impl Area<'_> {
    /// Activates a step; tells whether it was inactive.
    #[inline(always)]
    fn on(&mut self, step: u32, output: u32) -> bool {
        let new = self.steps.add(self.image, step);
        if new {
            if let Some(stamp) = self.image.get_mut((self.stamps + step) as usize) {
                *stamp = self.now;
            }
            if let Some(o) = self.image.get_mut(output as usize) {
                *o = 1;
            }
            self.changed = true;
        }
        new
    }

    /// Deactivates a step.
    #[inline(always)]
    fn off(&mut self, step: u32, output: u32) {
        if self.steps.take(self.image, step) {
            if let Some(stamp) = self.image.get_mut((self.stamps + step) as usize) {
                *stamp = if self.keep { self.now.wrapping_sub(*stamp) } else { 0 };
            }
            if let Some(o) = self.image.get_mut(output as usize) {
                *o = 0;
            }
            self.changed = true;
        }
    }
}
