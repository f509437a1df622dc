//! Control blocks: the actions with qualifiers of IEC 61131-3.

use super::*;

pub(crate) fn add_input(s: &mut State, at: usize, block: usize) {
    s.m.counts[at] += 1;
    bit_set(&mut s.m.blocks, block);
}

pub(crate) fn remove_input(s: &mut State, at: usize, block: usize) {
    if s.m.counts[at] != 0 {
        s.m.counts[at] -= 1;
    }
    bit_set(&mut s.m.blocks, block);
}

/// An input with a condition goes with its step.
pub(crate) fn drop_condition(s: &mut State, i: usize, at: usize, block: usize) {
    bit_clear(&mut s.m.conditions, i);
    if s.m.counted[i] {
        s.m.counted[i] = false;
        remove_input(s, at, block);
    }
}

pub(crate) fn count_condition(s: &mut State, i: usize, now: bool, at: usize, block: usize) {
    s.m.counted[i] = now;
    if now {
        add_input(s, at, block);
    } else {
        remove_input(s, at, block);
    }
}

/// Looks at the conditions of the active steps' actions; or at those of pulses only.
pub(crate) fn look_at_conditions(s: &mut State, pulses: bool) {
    let mut i: usize = bit_next(&s.m.conditions, CONDITIONS, 0);
    while i < CONDITIONS && s.fault == 0 {
        condition(s, i, pulses);
        i = bit_next(&s.m.conditions, CONDITIONS, i + 1);
    }
}

/// Evaluates the blocks whose inputs changed or whose timers run, in order.
pub(crate) fn evaluate_blocks(s: &mut State) {
    let mut i: usize = bit_next(&s.m.blocks, BLOCKS, 0);
    while i < BLOCKS && s.fault == 0 {
        evaluate_block(s, i);
        i = bit_next(&s.m.blocks, BLOCKS, i + 1);
    }
}

/// Shows P1 and P0 the situation before the evolution, where the initialisation or
/// a service made it.
pub(crate) fn look_early(s: &mut State) {
    if HAS_CONDITIONS {
        look_at_conditions(s, true);
        if s.fault != 0 {
            return;
        }
    }
    if HAS_FULL {
        for k in 0..FULL {
            if bit(&s.m.blocks, FULL_BLOCK[k] as usize) && (!HAS_PERIODS || s.due[FULL_PERIOD[k] as usize]) {
                let at: usize = FULL_AT[k] as usize;
                let p1: bool = s.m.counts[at + 6] != 0;
                let p1_before: bool = (s.m.inputs_before[k] & 0x40) != 0;
                if p1 != p1_before {
                    s.m.inputs_before[k] ^= 0x40;
                    if p1 {
                        s.m.flip[k] |= 32;
                    }
                }
                let p0: bool = s.m.counts[at + 7] != 0;
                let p0_before: bool = (s.m.inputs_before[k] & 0x80) != 0;
                if p0 != p0_before {
                    s.m.inputs_before[k] ^= 0x80;
                    if !p0 {
                        s.m.flip[k] |= 64;
                    }
                }
            }
        }
    }
}

/// True if a delay of a block has run off; it starts as its input comes.
pub(crate) fn delay_done(s: &mut State, i: usize, now: bool, before: bool) -> bool {
    if now && !before {
        s.m.block_start[i] = s.tick;
    }
    if !now {
        s.m.block_start[i] = 0;
        return false;
    }
    in_nanoseconds(ticks_between(s.tick, s.m.block_start[i])) >= s.m.block_time[i]
}

/// ACTION_CONTROL (IEC 61131-3:2003, 2.6.4.5). Tells Q (1), whether a body runs (2),
/// whether to look again at the next scan (4).
pub(crate) fn control_block(s: &mut State, k: usize, at: usize, gate: bool) -> u32 {
    let before: u16 = s.m.inputs_before[k];
    let flip: u16 = s.m.flip[k];
    let mut now: u16 = 0;
    for i in 0..11 {
        if s.m.counts[at + i] != 0 {
            now |= (1u32 << i) as u16;
        }
    }
    let n: bool = (now & 1) != 0;
    let r: bool = (now & 4) != 0;
    let l: bool = (now & 8) != 0;
    let d: bool = (now & 16) != 0;
    let ds: bool = (now & 0x200) != 0;
    let s_flip: bool = !r && ((now & 2) != 0 || (flip & 1) != 0);
    let sd_flip: bool = !r && ((now & 0x100) != 0 || (flip & 2) != 0);
    let sl_flip: bool = !r && ((now & 0x400) != 0 || (flip & 8) != 0);
    let timers: usize = k * 5;
    let l_done: bool = delay_done(s, timers, l, (before & 8) != 0);
    let d_done: bool = delay_done(s, timers + 1, d, (before & 16) != 0);
    let sd_done: bool = delay_done(s, timers + 2, sd_flip, (flip & 2) != 0);
    let ds_done: bool = delay_done(s, timers + 3, ds, (before & 0x200) != 0);
    let sl_done: bool = delay_done(s, timers + 4, sl_flip, (flip & 8) != 0);
    let ds_flip: bool = !r && (ds_done || (flip & 4) != 0);
    let pulse: bool = (now & 0x20) != 0 && (before & 0x20) == 0;
    let p1: bool = (((now & 0x40) != 0 && (before & 0x40) == 0) || (flip & 32) != 0) && !r && gate;
    let p0: bool = (((now & 0x80) == 0 && (before & 0x80) != 0) || (flip & 64) != 0) && !r && gate;
    let level: bool = !r
        && gate
        && (n || s_flip || (l && !l_done) || d_done || pulse || sd_done || ds_flip || (sl_flip && !sl_done));
    let mut keep: u16 = 0;
    if s_flip {
        keep |= 1;
    }
    if sd_flip {
        keep |= 2;
    }
    if ds_flip {
        keep |= 4;
    }
    if sl_flip {
        keep |= 8;
    }
    if level {
        keep |= 16;
    }
    s.m.inputs_before[k] = now;
    s.m.flip[k] = keep;
    let mut result: u32 = 0;
    let q: bool = level || p1 || p0;
    if q {
        result |= 1;
    }
    if q || (FINAL_SCAN && (flip & 16) != 0 && !level) {
        result |= 2;
    }
    let live: bool = (l && !l_done)
        || (d && !d_done)
        || (sd_flip && !sd_done)
        || (ds && !ds_done)
        || (sl_flip && !sl_done);
    if live || pulse || p1 || p0 {
        result |= 4;
    }
    result
}
