//! Control blocks (IEC 61131-3:2003, 2.6.4.5): the actions of all steps that name
//! one variable or body give its block inputs, and the block gives its Q.

use crate::bits::{Walk, bit, set_bit, word};
use crate::block_rows::{Kind, Row};
use crate::block_words::{
    D, DS, DS_FF, EARLY_P0, EARLY_P1, L, MEMORY, N, P, P0, P1, Q_BEFORE, R, S, S_FF, SD, SD_FF, SL, SL_FF,
    STARTS, TIMED, TIMES, WRITTEN,
};
use crate::fault::Fault;
use crate::layout::head;
use crate::memory::write;
use crate::ops::{Addr, StepId};
use crate::program::Program;
use crate::run::{condition, value};
use crate::state::State;
use crate::tables::{Contribution, NONE};

fn base(p: &Program, block: u32) -> u32 {
    p.layout.block_at.get(block as usize).copied().unwrap_or(0)
}

/// Counts a contribution of a step that is activated or deactivated, if it is a given one; else does
/// nothing and returns false.
#[inline]
pub(crate) fn give(p: &Program, image: &mut [u64], row: u32, on: bool) -> bool {
    let Some(c) = p.given.of(row) else { return false };
    add(p, image, c.block, c.count, on);
    if on && let Some(timer) = image.get_mut(c.timer as usize) {
        *timer = c.time;
    }
    true
}

/// Sets the time of the timer behind an input.
fn set_time(p: &Program, image: &mut [u64], c: &Contribution, time: u64) {
    if let Some(k) = TIMED.iter().position(|input| *input == u32::from(c.input))
        && let Some(word) = image.get_mut((base(p, c.block) + TIMES) as usize + k)
    {
        *word = time;
    }
}

/// Sets the times of the timers behind the given contributions of a step.
pub(crate) fn set_times(p: &Program, image: &mut [u64], step: StepId) {
    let Some(e) = p.extra(step.0) else { return };
    for c in (e.contributions.start..e.contributions.end).filter_map(|row| p.given.of(row)) {
        if let Some(timer) = image.get_mut(c.timer as usize) {
            *timer = c.time;
        }
    }
}

/// Adds an input to a block or takes it away.
#[inline]
pub(crate) fn count(p: &Program, image: &mut [u64], block: u32, input: u8, on: bool) {
    let Some(row) = p.blocks.get(block as usize) else { return };
    add(p, image, block, row.at + if row.kind == Kind::Plain { 0 } else { u32::from(input) }, on);
}

/// Adds to the word that counts the contributions to an input of a block, or takes away.
#[inline(always)]
fn add(p: &Program, image: &mut [u64], block: u32, at: u32, on: bool) {
    // The count of a plain block shares its word with the Q written last. Only what
    // was added is taken away, so the subtraction never borrows from that bit.
    if let Some(count) = image.get_mut(at as usize) {
        *count = if on { count.wrapping_add(1) } else { count.wrapping_sub(1) };
    }
    p.layout.blocks.insert(image, block);
}

/// Shows the inputs P1 and P0 the situation before the evolution, after the
/// initialisation or a service has made it. So a step that is left in the same scan
/// still gives its pulses.
pub(crate) fn look(p: &Program, s: &mut State) -> Result<(), Fault> {
    conditions(p, s, |input| input == P1 || input == P0)?;
    let l = &p.layout;
    let mut from = 0;
    while let Some(i) = l.blocks.next(&s.image, from) {
        from = i + 1;
        let (Some(b), Some(row)) = (p.tables.blocks.get(i as usize), p.blocks.get(i as usize)) else { break };
        if b.plain || !s.is_due(p, b.period) {
            continue;
        }
        let at = row.at;
        let mut memory = word(&s.image, (at + MEMORY) as usize);
        for (input, pulse, rises) in [(P1, EARLY_P1, true), (P0, EARLY_P0, false)] {
            let on = word(&s.image, (at + input) as usize) != 0;
            if on != (memory & (1 << input) != 0) {
                memory ^= 1 << input;
                memory |= if on == rises { pulse } else { 0 };
            }
        }
        s.set((at + MEMORY) as usize, memory);
    }
    Ok(())
}

/// Evaluates the conditions of the active steps' actions, for the inputs that `of`
/// selects, and counts them.
pub(crate) fn conditions(p: &Program, s: &mut State, of: impl Fn(u32) -> bool) -> Result<(), Fault> {
    let l = &p.layout;
    if l.conditions.is_empty(&s.image) {
        return Ok(());
    }
    // The set does not change meanwhile: a condition activates no step.
    let mut walk = Walk::new(&l.conditions, &s.image);
    while let Some(row) = walk.next(&l.conditions, &s.image) {
        let Some(c) = p.tables.contributions.get(row as usize) else { break };
        if !of(u32::from(c.input)) || !s.is_due(p, c.period) {
            continue;
        }
        let now = condition(p, s, c.condition)?;
        if now == bit(&s.image, l.counted, row) {
            continue;
        }
        if now && !c.time.is_empty() && TIMED.contains(&u32::from(c.input)) {
            let time = value(p, s, c.time)?;
            set_time(p, &mut s.image, c, time);
        }
        set_bit(&mut s.image, l.counted, row, now);
        count(p, &mut s.image, c.block, c.input, now);
    }
    Ok(())
}

/// Evaluates the blocks whose inputs changed or whose timers end, in order.
pub(crate) fn evaluate(p: &Program, s: &mut State) -> Result<(), Fault> {
    let l = &p.layout;
    if s.now() >= s.scratch.timers_due {
        wake(p, s);
    }
    // Of the set, only the members that were met already change meanwhile.
    let mut walk = Walk::new(&l.blocks, &s.image);
    while let Some(i) = walk.next(&l.blocks, &s.image) {
        let Some(row) = p.blocks.get(i as usize) else { break };
        if row.bare && row.kind != Kind::Full {
            l.blocks.remove(&mut s.image, i);
            let q = if row.kind == Kind::Plain { plain(s, row.at) } else { latch(s, row.at, true).0 };
            put(p, s, row, q);
        } else {
            block(p, s, i, row)?;
        }
    }
    Ok(())
}

/// All blocks that wait for a timer are evaluated in this scan, and then wait again where theirs has
/// not ended.
#[inline(never)]
fn wake(p: &Program, s: &mut State) {
    let l = &p.layout;
    let mut from = 0;
    while let Some(i) = l.timing.next(&s.image, from) {
        l.timing.remove(&mut s.image, i);
        l.blocks.insert(&mut s.image, i);
        from = i + 1;
    }
    s.scratch.timers_due = i64::MAX;
}

/// Evaluates a block.
fn block(p: &Program, s: &mut State, i: u32, row: &Row) -> Result<(), Fault> {
    let l = &p.layout;
    let Some(b) = p.tables.blocks.get(i as usize) else { return Ok(()) };
    if !s.is_due(p, b.period) {
        // It stays in the other set, and is evaluated as soon as its period is over.
        l.timing.remove(&mut s.image, i);
        return Ok(());
    }
    l.blocks.remove(&mut s.image, i);
    let gate = condition(p, s, b.gate)?;
    let Evaluated { q, run, again, due } = match row.kind {
        Kind::Plain => Evaluated { q: plain(s, row.at) && gate, ..Evaluated::default() },
        Kind::Latch => {
            let (q, fell) = latch(s, row.at, gate);
            Evaluated { q, run: q || (p.tables.rules.final_scan && fell), ..Evaluated::default() }
        }
        Kind::Full => full(p, s, row, gate),
    };
    put(p, s, row, q);
    if run && b.action != NONE {
        set_bit(&mut s.scratch.late, 0, b.action, true);
        s.scratch.late_any = true;
    }
    if again || !b.gate.is_empty() || (b.action != NONE && q) {
        l.blocks.insert(&mut s.image, i);
    }
    match due {
        Some(due) => {
            s.scratch.timers_due = s.scratch.timers_due.min(due);
            l.timing.insert(&mut s.image, i);
        }
        None if row.kind == Kind::Full => l.timing.remove(&mut s.image, i),
        None => {}
    }
    Ok(())
}

/// The result of a block.
#[derive(Clone, Copy, Debug, Default)]
struct Evaluated {
    q: bool,
    /// Its body runs.
    run: bool,
    /// It is to be evaluated in the next scan again.
    again: bool,
    /// The instant at which a timer of it ends next, in ns.
    due: Option<i64>,
}

/// Notes that the value written last by a block was TRUE.
pub(crate) fn take_as_written(p: &Program, s: &mut State, block: u32) {
    let Some(row) = p.blocks.get(block as usize) else { return };
    let at = row.written();
    s.set(at, word(&s.image, at) | WRITTEN);
}

/// Writes Q where it has changed. Between two changes others may write the variable.
#[inline(always)]
fn put(p: &Program, s: &mut State, row: &Row, q: bool) {
    let at = row.written();
    let memory = word(&s.image, at);
    if row.output != NONE && (memory & WRITTEN != 0) != q {
        s.set(at, memory ^ WRITTEN);
        write(p, s, Addr(row.output), u64::from(q));
    }
}

/// Q of a plain block without its gate.
#[inline(always)]
fn plain(s: &State, at: u32) -> bool {
    word(&s.image, at as usize) & !WRITTEN != 0
}

/// Evaluates a block that has no other inputs, as [`full`] does. Returns Q, and whether it was TRUE at
/// the latest evaluation and is no more.
#[inline(always)]
fn latch(s: &mut State, at: u32, gate: bool) -> (bool, bool) {
    let Some(words) = s.image.get_mut(at as usize..=(at + MEMORY) as usize) else { return (false, false) };
    let [n, set, r, .., memory] = words else { return (false, false) };
    let (n, set, r) = (*n != 0, *set != 0, *r != 0);
    let s_ff = !r && (set || *memory & S_FF != 0);
    let q = !r && gate && (n || s_ff);
    let fell = *memory & Q_BEFORE != 0 && !q;
    let inputs = flag(1 << N, n) | flag(1 << S, set) | flag(1 << R, r);
    *memory = (*memory & WRITTEN) | inputs | flag(S_FF, s_ff) | flag(Q_BEFORE, q);
    (q, fell)
}

/// The true inputs of a block that is not plain, a bit each.
fn inputs(s: &State, at: u32, uses: u16) -> u64 {
    let (mut rest, mut inputs) = (uses, 0);
    while rest != 0 {
        let i = rest.trailing_zeros();
        inputs |= u64::from(word(&s.image, (at + i) as usize) != 0) << i;
        rest &= rest - 1;
    }
    inputs
}

/// The result of the timed inputs of a block.
#[derive(Default)]
struct Timed {
    /// One of them makes Q true.
    level: bool,
    /// The flip-flops behind them, as bits of the memory word.
    latched: u64,
    /// The instant at which one that still runs ends next.
    due: Option<i64>,
}

/// Brings the timers of a block up to date. `inputs` and `memory` have its inputs now and at the
/// latest evaluation, a bit each; `r` is its input R.
#[inline(never)]
fn timed(s: &mut State, at: u32, uses: u16, inputs: u64, memory: u64, r: bool) -> Timed {
    let now = word(&s.image, head::NOW) as i64;
    let on = |i: u32| inputs & (1 << i) != 0;
    let before = |i: u32| memory & (1 << i) != 0;
    let mut due: Option<i64> = None;
    // A TON with its input now and at the latest evaluation; tells whether it is over.
    let mut ton = |k: u32, e: bool, e_before: bool| {
        if TIMED.get(k as usize).is_none_or(|input| uses & (1 << input) == 0) {
            return false;
        }
        let start = (at + STARTS + k) as usize;
        if e && !e_before {
            s.set(start, now as u64);
        } else if !e {
            s.set(start, 0);
        }
        let time = word(&s.image, (at + TIMES + k) as usize) as i64;
        let from = word(&s.image, start) as i64;
        let done = e && now.wrapping_sub(from) >= time;
        if e && !done {
            let end = from.saturating_add(time);
            due = Some(due.map_or(end, |due| due.min(end)));
        }
        done
    };
    let sd_ff = !r && (on(SD) || memory & SD_FF != 0);
    let sl_ff = !r && (on(SL) || memory & SL_FF != 0);
    let l_done = ton(0, on(L), before(L));
    let d_done = ton(1, on(D), before(D));
    let sd_done = ton(2, sd_ff, memory & SD_FF != 0);
    let ds_done = ton(3, on(DS), before(DS));
    let sl_done = ton(4, sl_ff, memory & SL_FF != 0);
    let ds_ff = !r && (ds_done || memory & DS_FF != 0);
    Timed {
        level: (on(L) && !l_done) || d_done || sd_done || ds_ff || (sl_ff && !sl_done),
        latched: flag(SD_FF, sd_ff) | flag(DS_FF, ds_ff) | flag(SL_FF, sl_ff),
        due,
    }
}

/// A bit of the memory word, where it is set.
fn flag(bit: u64, on: bool) -> u64 {
    if on { bit } else { 0 }
}

/// Evaluates a block of any kind but a plain one.
fn full(p: &Program, s: &mut State, row: &Row, gate: bool) -> Evaluated {
    let Row { at, uses, .. } = *row;
    let inputs = inputs(s, at, uses);
    let on = |i: u32| inputs & (1 << i) != 0;
    let memory = word(&s.image, (at + MEMORY) as usize);
    let before = |i: u32| memory & (1 << i) != 0;
    let r = on(R);
    let s_ff = !r && (on(S) || memory & S_FF != 0);
    let any_timed = u64::from(uses) & TIMED.iter().fold(0, |all, i| all | 1 << i) != 0;
    let timed = if any_timed { timed(s, at, uses, inputs, memory, r) } else { Timed::default() };
    let p_trig = on(P) && !before(P);
    let p1 = (on(P1) && !before(P1) || memory & EARLY_P1 != 0) && !r && gate;
    let p0 = (!on(P0) && before(P0) || memory & EARLY_P0 != 0) && !r && gate;
    let level = !r && gate && (on(N) || s_ff || p_trig || timed.level);
    let fell = memory & Q_BEFORE != 0 && !level;
    let keep = (memory & WRITTEN) | inputs | timed.latched | flag(S_FF, s_ff) | flag(Q_BEFORE, level);
    s.set((at + MEMORY) as usize, keep);
    let q = level || p1 || p0;
    let run = q || (p.tables.rules.final_scan && fell);
    Evaluated { q, run, again: p_trig || p1 || p0, due: timed.due }
}
