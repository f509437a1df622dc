//! Requests of services: charts initialised or cleared, steps set or reset, times set to zero.

use super::*;

/// All charts take the situation of the start; nothing else that was asked for takes
/// place.
fn start_anew(s: &mut State) {
    s.m.ask_start = false;
    for i in 0..GROUPS {
        bit_clear(&mut s.m.ask_init, i);
        bit_clear(&mut s.m.ask_clear, i);
    }
    for i in 0..STEPS {
        bit_clear(&mut s.m.ask_set, i);
        bit_clear(&mut s.m.ask_reset, i);
    }
    mark_range_off(s, 0, STEPS);
    start(s);
    make_changes(s);
}

/// Carries out the requests of services.
pub(crate) fn carry_out(s: &mut State) {
    s.m.requests = false;
    if s.m.ask_start {
        start_anew(s);
        return;
    }
    for i in 0..GROUPS {
        let first: bool = bit(&s.m.ask_init, i);
        let empty: bool = bit(&s.m.ask_clear, i);
        bit_clear(&mut s.m.ask_init, i);
        bit_clear(&mut s.m.ask_clear, i);
        if first || empty {
            mark_range_off(s, GROUP_FIRST[i] as usize, GROUP_END[i] as usize);
        }
        if first {
            let mut k: usize = INITIAL_AT[i] as usize;
            while k < INITIAL_AT[i + 1] as usize {
                mark_on(s, INITIAL[k] as usize);
                k += 1;
            }
        }
    }
    for i in 0..STEPS {
        if bit(&s.m.ask_set, i) {
            bit_clear(&mut s.m.ask_set, i);
            mark_on(s, i);
        }
        if bit(&s.m.ask_reset, i) {
            bit_clear(&mut s.m.ask_reset, i);
            mark_off(s, i);
        }
    }
    commit(s);
}

pub(crate) fn reset_time(s: &mut State, step: usize) {
    let at: usize = time_of(step);
    if FEW_TIMES && at >= TIMED {
        return;
    }
    let mut stamp: Tick = 0;
    if s.m.x[step] {
        stamp = ticks(s);
    }
    if STABLE && s.stamp[at] != stamp {
        s.renewed = true;
    }
    s.stamp[at] = stamp;
    if SCAN_CLOCK {
        s.age[at] = 0;
        if s.m.x[step] {
            s.age[at] = s.tick;
        }
    }
}

/// RESET_XIT: all step times are 0.
pub(crate) fn reset_times(s: &mut State) {
    if HAS_TIMES {
        for i in 0..STEPS {
            reset_time(s, i);
        }
    }
    if HAS_GROUPS {
        for i in 0..GROUPS {
            s.m.group_stamp[i] = 0;
            s.m.group_age[i] = 0;
            if group_active(s, i) {
                s.m.group_stamp[i] = clock(s);
                s.m.group_age[i] = s.now;
            }
        }
    }
}
