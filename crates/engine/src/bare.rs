//! The short way for programs (or profiles of them) that are *bare*: steps,
//! transitions and outputs that each follow one step; no hierarchy, forcing,
//! stored actions, watches or control blocks. What it does is what `pass.rs`
//! and `change.rs` do; it only knows beforehand what need not be looked at, and
//! keeps what it does need in rows of its own.
//!
//! The same charts run on both ways in the tests (`tests/ways.rs`).

use alloc::boxed::Box;

use crate::bits::{Tree, Walk, bit, set_bit, word};
use crate::fault::Fault;
use crate::pass::{each_from, each_to, one_to_one, report, resolve};
use crate::program::{Guard, Tables};
use crate::state::{Layout, Scratch, State, head};
use crate::{NONE, Program};

/// A step with one transition behind it, which waits for one BOOL word; where a
/// token that is alone goes from here. One row is one piece of a cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(crate) struct Hot {
    /// Word of the image; `NONE` for a step of another kind.
    guard: u32,
    /// The transition.
    rank: u32,
    /// The one step behind it; `NONE` where a pass has more to do than to move
    /// the only token to another step.
    to: u32,
    /// Output that follows this step, or `NONE`.
    from_output: u32,
    /// Output that follows the step behind, or `NONE`.
    to_output: u32,
    /// The receptivity is the complement of the word.
    flip: bool,
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

/// The output that follows a step, as a word of the image.
fn output(t: &Tables, l: &Layout, step: u32) -> u32 {
    match t.steps.get(step as usize) {
        Some(s) if s.direct.0 != NONE => l.vars + s.direct.0,
        _ => NONE,
    }
}

pub(crate) fn hot(t: &Tables, l: &Layout) -> Box<[Hot]> {
    let none = Hot { guard: NONE, rank: NONE, to: NONE, from_output: NONE, to_output: NONE, flip: false };
    let row = |step: u32, out: crate::Rows| {
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
        // A source transition wants to be looked at in every pass.
        let moves = one_to_one(tr) && tr.from.0 == step && tr.to.0 != step && t.sources.is_empty();
        let to = if moves { tr.to.0 } else { NONE };
        let (from_output, to_output) = (output(t, l, step), output(t, l, to));
        Some(Hot { guard, rank: *rank, to, from_output, to_output, flip })
    };
    (0..).zip(&t.steps).map(|(i, s)| row(i, s.out).unwrap_or(none)).collect()
}

pub(crate) fn moves(t: &Tables, l: &Layout) -> Box<[Move]> {
    t.transitions
        .iter()
        .map(|tr| {
            let (from, to) = (tr.from.0, tr.to.0);
            Move {
                from: if one_to_one(tr) { from } else { NONE },
                to,
                from_output: output(t, l, from),
                to_output: output(t, l, to),
            }
        })
        .collect()
}

/// One pass; whether it changed a step.
pub(crate) fn evolve(p: &Program, s: &mut State) -> Result<bool, Fault> {
    s.x.passes += 1;
    s.x.fired.clear();
    let now = word(&s.w, head::NOW);
    if let Some(moved) = one_token(p, s, now) {
        s.x.idle = !moved;
        s.x.cleared_count += u32::from(moved);
        return Ok(moved);
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
    let mut area = Area { w, steps: *steps, now, stamps, keep, changed: false };
    // Where one token has moved by one transition, the next pass knows where it is.
    x.lone = match fired[..] {
        [i] if x.lone != NONE => p.moves.get(i as usize).filter(|m| m.from == x.lone).map_or(NONE, |m| m.to),
        _ => NONE,
    };
    // Rule 5: what is activated is not deactivated. Only what was active before
    // its activation can be meant.
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

/// A pass while a single hot step is active and its transition leads from one
/// step to another one: nothing need be searched. Whether the token moved;
/// `None`, and nothing done, where it is not so.
#[inline(always)]
pub(crate) fn one_token(p: &Program, s: &mut State, now: u64) -> Option<bool> {
    let State { w, x, steps, .. } = s;
    let from = x.lone;
    let Hot { guard, rank, to, from_output, to_output, flip } = *p.hot.get(from as usize)?;
    if to == NONE {
        return None;
    }
    if (word(w, guard as usize) != 0) == flip {
        return Some(false);
    }
    if x.cleared.len() < x.cleared.capacity() {
        x.cleared.push(rank);
    }
    x.lone = to;
    steps.pass_on(w, from, to);
    let stamps = p.layout.stamps;
    if let Some(stamp) = w.get_mut((stamps + to) as usize) {
        *stamp = now;
    }
    if let Some(stamp) = w.get_mut((stamps + from) as usize) {
        *stamp = if p.t.rules.keep_step_time { now.wrapping_sub(*stamp) } else { 0 };
    }
    if let Some(o) = w.get_mut(to_output as usize) {
        *o = 1;
    }
    if let Some(o) = w.get_mut(from_output as usize) {
        *o = 0;
    }
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
    ends(p, rank, succeeding, &mut f);
}

/// The same for transitions with several steps or none on a side.
fn ends(p: &Program, rank: u32, succeeding: bool, f: &mut dyn FnMut(u32, u32)) {
    let Some(t) = p.t.transitions.get(rank as usize) else { return };
    let g = |step: u32| f(step, output(&p.t, &p.layout, step));
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
    /// Activates a step; whether it was inactive.
    #[inline(always)]
    fn on(&mut self, step: u32, output: u32) -> bool {
        let new = self.steps.add(self.w, step);
        if new {
            if let Some(stamp) = self.w.get_mut((self.stamps + step) as usize) {
                *stamp = self.now;
            }
            if let Some(o) = self.w.get_mut(output as usize) {
                *o = 1;
            }
            self.changed = true;
        }
        new
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
