//! The end of a scan: actions of each scan, counts and limits of steps and transitions.

use super::*;

/// Outputs follow the steps that changed. They wait for the end of the scan: nothing sees
/// them before, and the outputs of neighbours are written together.
pub(crate) fn catch_up(s: &mut State) {
    if ONE_WORD {
        if s.behind[0] != 0 {
            s.behind[0] = 0;
            follow(s, 0);
        }
        return;
    }
    let mut j: usize = 0;
    while j < TOP {
        let mut words: u32 = s.behind[j];
        s.behind[j] = 0;
        while words != 0 {
            follow(s, (j << 5) + low_bit(words));
            words &= words - 1;
        }
        j += 1;
    }
}

/// Actions of each scan of the active steps.
pub(crate) fn periodics(s: &mut State) {
    let mut i: usize = bit_next(&s.m.periodics, PERIODICS, 0);
    while i < PERIODICS {
        if !PERIODIC_FIRST || bit(&s.before_periodics, i) {
            run_at_end(s, PERIODIC_ACTION[i] as usize);
        }
        i = bit_next(&s.m.periodics, PERIODICS, i + 1);
    }
}

pub(crate) fn is_enabled(s: &State, t: usize) -> bool {
    if !COUNTED[t] {
        return false;
    }
    let mut i: usize = FROM_AT[t] as usize;
    while i < FROM_AT[t + 1] as usize {
        if !s.m.x[FROM[i] as usize] {
            return false;
        }
        i += 1;
    }
    true
}

pub(crate) fn count_active(s: &State) -> u32 {
    let mut count: u32 = 0;
    for i in 0..STEPS {
        if STEP_COUNTED[i] && s.m.x[i] {
            count += 1;
        }
    }
    count
}

pub(crate) fn count_before(s: &mut State) {
    for t in 0..TRANSITIONS {
        s.enabled_before[t] = is_enabled(s, t);
    }
    s.active_before = count_active(s);
    s.moved = 0;
}

pub(crate) fn at_most(count: u32) -> i64 {
    if count > 32767 {
        return 32767;
    }
    count as i64
}

/// %SW20 and %SW21: what was, and what changed in this scan.
pub(crate) fn count_after(s: &mut State) {
    let mut total: u32 = 0;
    for t in 0..TRANSITIONS {
        if s.enabled_before[t] {
            total += 1;
        }
        if s.enabled_before[t] != is_enabled(s, t) {
            total += 1;
        }
    }
    let steps: u32 = s.active_before + s.moved;
    write_counts(s, at_most(steps), at_most(total));
}

pub(crate) fn judge_limits(s: &mut State) {
    let mut enabled: u32 = 0;
    for t in 0..TRANSITIONS {
        if is_enabled(s, t) {
            enabled += 1;
        }
    }
    if count_active(s) > MOST_ACTIVE || enabled > MOST_ENABLED {
        write_overflow(s);
        s.fault = FAULT_TABLE;
    }
}
