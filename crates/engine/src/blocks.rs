//! Control blocks (IEC 61131-3:2003, 2.6.4.5): the actions of all steps that name
//! one variable or body give its block inputs, and the block gives its Q.

use crate::bits::{Walk, bit, set_bit, word};
use crate::block_words::{
    D, DS, DS_FF, EARLY_P0, EARLY_P1, L, MEMORY, N, P, P0, P1, Q_BEFORE, R, S, S_FF, SD, SD_FF, SL, SL_FF,
    STARTS, TIMED, TIMES, WRITTEN,
};
use crate::fault::Fault;
use crate::layout::head;
use crate::memory::write;
use crate::ops::Addr;
use crate::program::Program;
use crate::run::{condition, value};
use crate::state::State;
use crate::tables::NONE;

fn base(p: &Program, block: u32) -> u32 {
    p.layout.block_at.get(block as usize).copied().unwrap_or(0)
}

/// Adds an input to a block or takes it away.
#[inline]
pub(crate) fn count(p: &Program, image: &mut [u64], block: u32, input: u8, on: bool) {
    let plain = p.tables.blocks.get(block as usize).is_some_and(|b| b.plain);
    let at = base(p, block) as usize + if plain { 0 } else { usize::from(input) };
    // The count of a plain block shares its word with the Q written last. Only what
    // was added is taken away, so the subtraction never borrows from that bit.
    if let Some(count) = image.get_mut(at) {
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
        let Some(b) = p.tables.blocks.get(i as usize) else { break };
        if b.plain || !s.is_due(p, b.period) {
            continue;
        }
        let at = base(p, i);
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
        if now
            && !c.time.is_empty()
            && let Some(k) = TIMED.iter().position(|i| *i == u32::from(c.input))
        {
            let time = value(p, s, c.time)?;
            s.set((base(p, c.block) + TIMES) as usize + k, time);
        }
        set_bit(&mut s.image, l.counted, row, now);
        count(p, &mut s.image, c.block, c.input, now);
    }
    Ok(())
}

/// Evaluates the blocks whose inputs changed or whose timers run, in order.
pub(crate) fn evaluate(p: &Program, s: &mut State) -> Result<(), Fault> {
    let l = &p.layout;
    // Of the set, only the members that were met already change meanwhile.
    let mut walk = Walk::new(&l.blocks, &s.image);
    while let Some(i) = walk.next(&l.blocks, &s.image) {
        let Some(b) = p.tables.blocks.get(i as usize) else { break };
        if !s.is_due(p, b.period) {
            continue;
        }
        l.blocks.remove(&mut s.image, i);
        let gate = condition(p, s, b.gate)?;
        let at = base(p, i);
        let (q, run, live) = match p.uses.get(i as usize) {
            _ if b.plain => plain(s, at, gate),
            Some(uses) if uses & !LATCH == 0 => latch(p, s, at, gate),
            _ => full(p, s, i, gate),
        };
        if b.output.0 != NONE {
            put(p, s, (at + if b.plain { 0 } else { MEMORY }) as usize, b.output, q);
        }
        if run && b.action != NONE {
            set_bit(&mut s.scratch.late, 0, b.action, true);
            s.scratch.late_any = true;
        }
        if live || !b.gate.is_empty() || (b.action != NONE && q) {
            l.blocks.insert(&mut s.image, i);
        }
    }
    Ok(())
}

/// Notes that the value written last by a block was TRUE.
pub(crate) fn take_as_written(p: &Program, s: &mut State, block: u32) {
    let plain = p.tables.blocks.get(block as usize).is_some_and(|b| b.plain);
    let at = (base(p, block) + if plain { 0 } else { MEMORY }) as usize;
    s.set(at, word(&s.image, at) | WRITTEN);
}

/// Writes Q where it has changed. Between two changes others may write the variable.
fn put(p: &Program, s: &mut State, at: usize, output: Addr, q: bool) {
    let memory = word(&s.image, at);
    if (memory & WRITTEN != 0) != q {
        s.set(at, memory ^ WRITTEN);
        write(p, s, output, u64::from(q));
    }
}

/// Evaluates a plain block: Q, whether its body runs (it has none), and whether to
/// evaluate it in the next scan again.
fn plain(s: &State, at: u32, gate: bool) -> (bool, bool, bool) {
    (word(&s.image, at as usize) & !WRITTEN != 0 && gate, false, false)
}

/// The inputs of a latch: N, S and R.
const LATCH: u16 = 1 << N | 1 << S | 1 << R;

/// Evaluates a block that has no other inputs, as [`full`] does.
fn latch(p: &Program, s: &mut State, at: u32, gate: bool) -> (bool, bool, bool) {
    let on = |i: u32| word(&s.image, (at + i) as usize) != 0;
    let memory = word(&s.image, (at + MEMORY) as usize);
    let (n, set, r) = (on(N), on(S), on(R));
    let s_ff = !r && (set || memory & S_FF != 0);
    let q = !r && gate && (n || s_ff);
    let inputs = flag(1 << N, n) | flag(1 << S, set) | flag(1 << R, r);
    let keep = (memory & WRITTEN) | inputs | flag(S_FF, s_ff) | flag(Q_BEFORE, q);
    s.set((at + MEMORY) as usize, keep);
    let fell = memory & Q_BEFORE != 0 && !q;
    (q, q || (p.tables.rules.final_scan && fell), false)
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
    /// A timer still runs.
    live: bool,
}

/// Brings the timers of a block up to date. `inputs` and `memory` have its inputs now and at the
/// latest evaluation, a bit each; `r` is its input R.
#[inline(never)]
fn timed(s: &mut State, at: u32, uses: u16, inputs: u64, memory: u64, r: bool) -> Timed {
    let now = word(&s.image, head::NOW) as i64;
    let on = |i: u32| inputs & (1 << i) != 0;
    let before = |i: u32| memory & (1 << i) != 0;
    let mut live = false;
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
        let done = e && now.wrapping_sub(word(&s.image, start) as i64) >= time;
        live |= e && !done;
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
        live,
    }
}

/// A bit of the memory word, where it is set.
fn flag(bit: u64, on: bool) -> u64 {
    if on { bit } else { 0 }
}

/// Evaluates any other block, likewise.
fn full(p: &Program, s: &mut State, block: u32, gate: bool) -> (bool, bool, bool) {
    let at = base(p, block);
    let uses = p.uses.get(block as usize).copied().unwrap_or(0);
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
    (q, run, timed.live || p_trig || p1 || p0)
}
