//! The short way for *bare* programs: those with only steps, transitions and
//! outputs that each follow one step, without hierarchy, forcing orders, stored
//! actions, watches and control blocks. It has the same meaning as `pass.rs` and
//! `change.rs`, but leaves out what cannot occur, and reads its own rows
//! (`bare_rows.rs`). `tests/ways.rs` runs the same charts on both ways.

use crate::bare_rows::{Hot, output};
use crate::bits::{Tree, Walk, bit, set_bit, word};
use crate::fault::Fault;
use crate::layout::head;
use crate::pass::{collect_slow, each_from, each_to, report, resolve};
use crate::program::Program;
use crate::scratch::Scratch;
use crate::state::State;
use crate::tables::NONE;

/// Makes one pass; tells whether it changed a step.
pub(crate) fn evolve(p: &Program, s: &mut State) -> Result<bool, Fault> {
    s.scratch.passes += 1;
    s.scratch.fired.clear();
    let now = word(&s.image, head::NOW);
    if let Some(moved) = one_token(p, s, now) {
        s.scratch.idle = !moved;
        s.scratch.cleared_count += u32::from(moved);
        return Ok(moved);
    }
    collect(p, s);
    if !s.scratch.slow.is_empty() || !p.tables.sources.is_empty() {
        collect_slow(p, s)?;
    }
    s.scratch.idle = s.scratch.fired.is_empty();
    if s.scratch.idle {
        return Ok(false);
    }
    if p.has_contests {
        resolve(p, s);
    }
    report(s);
    let stamps = p.layout.stamps;
    let keep = p.tables.rules.keep_step_time;
    let State { image, scratch, steps, .. } = s;
    let Scratch { fired, on_mark, .. } = scratch;
    let mut area = Area { image, steps: *steps, now, stamps, keep, changed: false };
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
    Ok(area.changed)
}

/// Makes a pass while the only active step is a hot one whose transition leads to
/// one other step, so that nothing need be searched. Tells whether the token moved;
/// otherwise does nothing and returns `None`.
#[inline(always)]
pub(crate) fn one_token(p: &Program, s: &mut State, now: u64) -> Option<bool> {
    let State { image, scratch, steps, .. } = s;
    let from = scratch.lone;
    let Hot { waits_for, rank, to, from_output, to_output, flip } = *p.hot.get(from as usize)?;
    if to == NONE {
        return None;
    }
    if (word(image, waits_for as usize) != 0) == flip {
        return Some(false);
    }
    if scratch.cleared.len() < scratch.cleared.capacity() {
        scratch.cleared.push(rank);
    }
    scratch.lone = to;
    steps.pass_on(image, from, to);
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
    if succeeding { each_to(p, t, g) } else { each_from(p, t, g) }
}

/// Collects the clearable transitions behind the hot steps, and the other active
/// steps in `slow`.
#[inline]
fn collect(p: &Program, s: &mut State) {
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
        } else if (word(image, h.waits_for as usize) != 0) != h.flip {
            scratch.fired.push(h.rank);
        }
    }
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
