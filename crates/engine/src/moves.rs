//! Plain steps and transitions (`rows.rs`): the part of a pass that needs no marks, and scans in
//! which nothing but one token can act. They have the same meaning as `pass.rs` and `change.rs`,
//! but leave out what cannot occur. `tests/all/ways.rs` runs the same charts with and without them.

use alloc::vec::Vec;
use core::mem::take;

use crate::bits::{Tree, bit, set_bit, word};
use crate::blocks;
use crate::gates::{COUNTED, GATE};
use crate::layout::head;
use crate::program::Program;
use crate::rows::{Hot, Parts, Shift};
use crate::scratch::Scratch;
use crate::sleepers::Rest;
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
    let Hot { rank, to, .. } = *hot;
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
    shift::<true>(p, image, &hot.shift, word(image, head::NOW), kept(p));
    Some(true)
}

/// The bits of the time of a step that are left when it is deactivated: all or none.
#[inline(always)]
fn kept(p: &Program) -> u64 {
    if p.tables.rules.keep_step_time { u64::MAX } else { 0 }
}

/// Moves the times and outputs of two plain steps along with a token. `kept` is [`kept`]. Without `TAGS`
/// no step has a gate or contributions.
#[inline(always)]
fn shift<const TAGS: bool>(p: &Program, image: &mut [u64], at: &Shift, now: u64, kept: u64) {
    if let Some(stamp) = image.get_mut(at.to_stamp as usize) {
        *stamp = now;
    }
    if let Some(stamp) = image.get_mut(at.from_stamp as usize) {
        *stamp = now.wrapping_sub(*stamp) & kept;
    }
    match image.get_mut(at.to_output as usize) {
        Some(o) => *o = 1,
        None if TAGS && at.to_output != NONE => follow(p, image, at.to_output, true),
        None => {}
    }
    match image.get_mut(at.from_output as usize) {
        Some(o) => *o = 0,
        None if TAGS && at.from_output != NONE => follow(p, image, at.from_output, false),
        None => {}
    }
}

/// Clears plain transitions of which each leads to a step that is not active.
#[inline(always)]
fn pass_on<const TAGS: bool>(p: &Program, s: &mut State, now: u64, kept: u64) {
    let State { image, scratch, steps, .. } = s;
    let Scratch { fired, rest, .. } = scratch;
    for m in fired.iter().filter_map(|i| p.moves.get(*i as usize)) {
        // Another token of this pass may have gone there: contributions count once.
        let again = TAGS && steps.contains(image, m.to);
        steps.hand_on(image, m.from, m.to);
        rest.stir(m.to);
        let left = Shift { to_output: NONE, ..m.shift };
        shift::<TAGS>(p, image, if again { &left } else { &m.shift }, now, kept);
    }
}

/// Lets the gate or the control blocks behind a step follow it.
#[inline(never)]
fn follow(p: &Program, image: &mut [u64], tagged: u32, on: bool) {
    if tagged & COUNTED != COUNTED {
        p.gates.close(&p.layout, image, tagged & !GATE);
        return;
    }
    let Some(e) = p.extra(tagged & !COUNTED) else { return };
    for row in e.contributions.start..e.contributions.end {
        blocks::give(p, image, row, on);
    }
}

/// Collects the clearable transitions behind the hot steps, and the other active steps in `slow`.
#[inline]
pub(crate) fn collect(p: &Program, s: &mut State) {
    let State { image, scratch, steps, .. } = s;
    // On the stack, these lists need not be written back at each step.
    let mut found = Found { fired: take(&mut scratch.fired), slow: take(&mut scratch.slow) };
    found.slow.clear();
    scratch.lone = if scratch.rest.is_on() {
        look_at_stirred(p, image, steps, &mut found, &mut scratch.rest)
    } else {
        look(p, image, steps, &mut found, &mut scratch.rest)
    };
    (scratch.fired, scratch.slow) = (found.fired, found.slow);
}

/// The transitions that [`collect`] has found to be clearable, and the steps for a closer look.
struct Found {
    fired: Vec<u32>,
    slow: Vec<u32>,
}

impl Found {
    /// Judges some of the 64 steps of word `i`. With `TELL`, returns those whose receptivity is FALSE.
    #[inline(always)]
    fn judge<const TELL: bool>(&mut self, p: &Program, image: &[u64], i: u32, steps: u64) -> u64 {
        let (mut rest, mut closed) = (steps, 0);
        while rest != 0 {
            let step = i * 64 + rest.trailing_zeros();
            match p.hot.get(step as usize) {
                Some(h) if h.waits_for == NONE => self.slow.push(step),
                Some(h) if holds(p, image, h) => self.fired.push(h.rank),
                _ if TELL => closed |= rest & rest.wrapping_neg(),
                _ => {}
            }
            rest &= rest - 1;
        }
        closed
    }
}

/// The work of [`collect`] where no step sleeps. Returns the only active step, or `NONE`.
#[inline(always)]
fn look(p: &Program, image: &[u64], steps: &Tree, found: &mut Found, rest: &mut Rest) -> u32 {
    let (mut several, mut last, mut words) = (false, NONE, 0);
    steps.each_word(image, |i, active| {
        several |= !active.is_power_of_two();
        last = i * 64 + active.trailing_zeros();
        words += 1;
        found.judge::<false>(p, image, i, active);
    });
    rest.begin(words, found.fired.len() + found.slow.len());
    if several || words > 1 { NONE } else { last }
}

/// As [`look`], while steps sleep. If only one step is active, the sleep of all ends.
#[inline(never)]
fn look_at_stirred(p: &Program, image: &[u64], steps: &Tree, found: &mut Found, rest: &mut Rest) -> u32 {
    let (mut several, mut last) = (false, NONE);
    let active = |i| word(image, (steps.base() + i) as usize);
    rest.look(&p.sleepers, active, |i, awake| {
        several |= last != NONE || !awake.is_power_of_two();
        last = i * 64 + awake.trailing_zeros();
        found.judge::<true>(p, image, i, awake)
    });
    if several || last == NONE || !steps.has_only(image, last) {
        return NONE;
    }
    rest.end();
    last
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
    let Scratch { fired, on_mark, rest, .. } = scratch;
    let now = word(image, head::NOW);
    let kept = kept(p);
    // After a lone token has moved by one transition, its place is known.
    scratch.lone = match fired[..] {
        [i] if scratch.lone != NONE => {
            p.moves.get(i as usize).filter(|m| m.from == scratch.lone).map_or(NONE, |m| m.to)
        }
        _ => NONE,
    };
    let free =
        |i: &u32| p.moves.get(*i as usize).is_some_and(|m| m.from != NONE && !steps.contains(image, m.to));
    if fired.iter().all(free) {
        let any = !fired.is_empty();
        if p.counted || !p.gates.is_empty() {
            pass_on::<true>(p, s, now, kept);
        } else {
            pass_on::<false>(p, s, now, kept);
        }
        return any;
    }
    let mut area = Area { image, steps: *steps, rest, now, kept, changed: false };
    crowded(p, &mut area, fired, on_mark);
    area.changed
}

/// As [`clear`], where a step may be both activated and deactivated: it stays active (rule 5). It
/// can only be one that was active before.
#[inline(never)]
fn crowded(p: &Program, area: &mut Area<'_>, fired: &[u32], on_mark: &mut [u64]) {
    let mut stay = false;
    for i in fired {
        each_end(p, *i, true, |to| {
            if !area.on(p, to) {
                stay = true;
                set_bit(on_mark, 0, to, true);
            }
        });
    }
    for i in fired {
        each_end(p, *i, false, |from| {
            if !stay || !bit(on_mark, 0, from) {
                area.off(p, from);
            }
        });
    }
    if stay {
        for i in fired {
            each_end(p, *i, true, |to| {
                set_bit(on_mark, 0, to, false);
            });
        }
    }
}

/// Calls `f` with each succeeding (or preceding) step of a transition.
fn each_end(p: &Program, rank: u32, succeeding: bool, f: impl FnMut(u32)) {
    match p.tables.transitions.get(rank as usize) {
        Some(t) if succeeding => p.tables.each_to(t, f),
        Some(t) => p.tables.each_from(t, f),
        None => {}
    }
}

fn parts(p: &Program) -> Parts<'_> {
    Parts { t: &p.tables, l: &p.layout, gates: &p.gates, given: &p.given, tags: true }
}

/// The parts of a state that change with steps.
struct Area<'a> {
    image: &'a mut [u64],
    steps: Tree,
    rest: &'a mut Rest,
    now: u64,
    kept: u64,
    changed: bool,
}

impl Area<'_> {
    /// Activates a step; tells whether it was inactive.
    fn on(&mut self, p: &Program, step: u32) -> bool {
        let new = self.steps.add(self.image, step);
        if new {
            self.rest.stir(step);
            let to = parts(p).entering(step);
            shift::<true>(p, self.image, &to, self.now, self.kept);
            self.changed = true;
        }
        new
    }

    /// Deactivates a step.
    fn off(&mut self, p: &Program, step: u32) {
        if self.steps.take(self.image, step) {
            let from = parts(p).leaving(step);
            shift::<true>(p, self.image, &from, self.now, self.kept);
            self.changed = true;
        }
    }
}
