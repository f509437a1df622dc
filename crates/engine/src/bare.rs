//! The short way for programs (or profiles of them) that are *bare*: steps,
//! transitions and outputs that each follow one step; no hierarchy, forcing,
//! stored actions, watches or control blocks. What it does is what `pass.rs`
//! and `change.rs` do; it only knows beforehand what need not be looked at, and
//! keeps what it does need in rows of its own.
//!
//! The same charts run on both ways in the tests (`tests/ways.rs`).

use alloc::boxed::Box;

use crate::bits::{Tree, Walk, word};
use crate::fault::Fault;
use crate::pass::{each_from, each_to, one_to_one, report, resolve};
use crate::program::{Guard, Tables};
use crate::state::{Layout, Scratch, State, head};
use crate::{NONE, Program};

/// A step with one transition behind it, which waits for one BOOL word.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hot {
    /// Word of the image; `NONE` for a step of another kind.
    guard: u32,
    /// The receptivity is the complement of the word.
    flip: bool,
    /// The transition.
    rank: u32,
}

/// A transition from one step to one step, with words of the image.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Move {
    /// `NONE` for a transition of another kind.
    from: u32,
    to: u32,
    /// Output that follows the step before, or `NONE`.
    from_output: u32,
    /// Output that follows the step behind, or `NONE`.
    to_output: u32,
}

pub(crate) fn hot(t: &Tables, l: &Layout) -> Box<[Hot]> {
    let none = Hot { guard: NONE, flip: false, rank: NONE };
    let row = |out: crate::Rows| {
        let [rank] = t.outs.get(out.start as usize..out.end as usize)? else { return None };
        let tr = t.transitions.get(*rank as usize)?;
        if !tr.more_from.is_empty() {
            return None;
        }
        let (guard, flip) = match tr.guard {
            // Not zero while the program runs.
            Guard::True => (head::FLAGS as u32, false),
            Guard::Word(a) => (l.vars + a.0, false),
            Guard::NotWord(a) => (l.vars + a.0, true),
            Guard::Code(_) => return None,
        };
        Some(Hot { guard, flip, rank: *rank })
    };
    t.steps.iter().map(|s| row(s.out).unwrap_or(none)).collect()
}

pub(crate) fn moves(t: &Tables, l: &Layout) -> Box<[Move]> {
    let output = |step: u32| match t.steps.get(step as usize) {
        Some(s) if s.direct.0 != NONE => l.vars + s.direct.0,
        _ => NONE,
    };
    t.transitions
        .iter()
        .map(|tr| {
            let (from, to) = (tr.from.0, tr.to.0);
            Move {
                from: if one_to_one(tr) { from } else { NONE },
                to,
                from_output: output(from),
                to_output: output(to),
            }
        })
        .collect()
}

/// One pass; whether it changed a step.
pub(crate) fn evolve(p: &Program, s: &mut State) -> Result<bool, Fault> {
    s.x.passes += 1;
    s.x.fired.clear();
    if s.x.lone != NONE
        && let Some(changed) = one_token(p, s)
    {
        return Ok(changed);
    }
    collect(p, s);
    if !s.x.slow.is_empty() || !p.t.sources.is_empty() {
        crate::pass::collect_slow(p, s)?;
    }
    s.x.idle = s.x.fired.is_empty();
    if s.x.idle {
        return Ok(false);
    }
    if p.has_contests {
        resolve(p, s);
    }
    report(s);
    let stamps = p.layout.stamps;
    let keep = p.t.rules.keep_step_time;
    let State { w, x, steps, .. } = s;
    let Scratch { fired, on_mark, .. } = x;
    let mut area = Area { w, steps: *steps, now: 0, stamps, keep, changed: false };
    area.now = word(area.w, head::NOW);
    // Where one token has moved by one transition, the next pass knows where it is.
    x.lone = match fired[..] {
        [i] if x.lone != NONE => p.moves.get(i as usize).filter(|m| m.from == x.lone).map_or(NONE, |m| m.to),
        _ => NONE,
    };
    for i in fired.iter() {
        each_end(p, *i, true, |to, output| {
            if let Some(m) = on_mark.get_mut((to / 64) as usize) {
                *m |= 1 << (to % 64);
            }
            area.on(to, output);
        });
    }
    for i in fired.iter() {
        each_end(p, *i, false, |from, output| {
            // Rule 5: what is activated is not deactivated.
            if word(on_mark, (from / 64) as usize) & (1 << (from % 64)) == 0 {
                area.off(from, output);
            }
        });
    }
    for i in fired.iter() {
        each_end(p, *i, true, |to, _| {
            if let Some(m) = on_mark.get_mut((to / 64) as usize) {
                *m &= !(1 << (to % 64));
            }
        });
    }
    Ok(area.changed)
}

/// A pass while a single hot step is active and its transition leads from one
/// step to one step: nothing need be searched. `None` where it is not so.
#[inline(always)]
fn one_token(p: &Program, s: &mut State) -> Option<bool> {
    let h = p.hot.get(s.x.lone as usize).filter(|h| h.guard != NONE && p.t.sources.is_empty())?;
    let m = p.moves.get(h.rank as usize).filter(|m| m.from != NONE)?;
    let State { w, x, steps, .. } = s;
    x.idle = (word(w, h.guard as usize) != 0) == h.flip;
    if x.idle {
        return Some(false);
    }
    x.cleared_count += 1;
    if x.cleared.len() < x.cleared.capacity() {
        x.cleared.push(h.rank);
    }
    if m.from == m.to {
        return Some(false);
    }
    x.lone = m.to;
    let now = word(w, head::NOW);
    let mut area = Area {
        w,
        steps: *steps,
        now,
        stamps: p.layout.stamps,
        keep: p.t.rules.keep_step_time,
        changed: false,
    };
    area.on(m.to, m.to_output);
    area.off(m.from, m.from_output);
    Some(true)
}

/// The succeeding (or preceding) steps of a transition with their outputs.
#[inline(always)]
fn each_end(p: &Program, rank: u32, succeeding: bool, mut f: impl FnMut(u32, u32)) {
    let Some(m) = p.moves.get(rank as usize) else { return };
    if m.from != NONE {
        let (step, output) = if succeeding { (m.to, m.to_output) } else { (m.from, m.from_output) };
        f(step, output);
        return;
    }
    let Some(t) = p.t.transitions.get(rank as usize) else { return };
    let g = |step: u32| {
        let direct = p.t.steps.get(step as usize).map_or(NONE, |s| s.direct.0);
        f(step, if direct == NONE { NONE } else { p.layout.vars + direct });
    };
    if succeeding { each_to(p, t, g) } else { each_from(p, t, g) }
}

/// Fires the hot steps' transitions; leaves the other active steps in `slow`.
#[inline]
fn collect(p: &Program, s: &mut State) {
    let State { w, x, steps, .. } = s;
    x.slow.clear();
    let mut seen = 0u32;
    let mut walk = Walk::new(steps, w);
    while let Some(step) = walk.next(steps, w) {
        seen += 1;
        x.lone = if seen == 1 { step } else { NONE };
        let Some(h) = p.hot.get(step as usize) else { break };
        if h.guard == NONE {
            x.slow.push(step);
        } else if (word(w, h.guard as usize) != 0) != h.flip {
            x.fired.push(h.rank);
        }
    }
}

/// The image, while steps change.
struct Area<'a> {
    w: &'a mut [u64],
    steps: Tree,
    now: u64,
    stamps: u32,
    keep: bool,
    changed: bool,
}

impl Area<'_> {
    #[inline(always)]
    fn on(&mut self, step: u32, output: u32) {
        if self.steps.add(self.w, step) {
            if let Some(stamp) = self.w.get_mut((self.stamps + step) as usize) {
                *stamp = self.now;
            }
            if let Some(o) = self.w.get_mut(output as usize) {
                *o = 1;
            }
            self.changed = true;
        }
    }

    #[inline(always)]
    fn off(&mut self, step: u32, output: u32) {
        if self.steps.take(self.w, step) {
            if let Some(stamp) = self.w.get_mut((self.stamps + step) as usize) {
                *stamp = if self.keep { self.now.wrapping_sub(*stamp) } else { 0 };
            }
            if let Some(o) = self.w.get_mut(output as usize) {
                *o = 0;
            }
            self.changed = true;
        }
    }
}
