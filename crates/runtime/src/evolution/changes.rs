//! Marked changes of steps, made at once, with the stored actions that follow from them.

use super::*;

pub(crate) fn mark_on(s: &mut State, step: usize) {
    if !bit(&s.on_mark, step) {
        bit_set(&mut s.on_mark, step);
        if UNMARKS {
            s.again = true;
            if !bit(&s.on_listed, step) {
                bit_set(&mut s.on_listed, step);
                s.on[s.on_count] = step as Row;
                s.on_count += 1;
            }
        } else {
            s.on[s.on_count] = step as Row;
            s.on_count += 1;
        }
    }
}

pub(crate) fn mark_off(s: &mut State, step: usize) {
    if !bit(&s.off_mark, step) {
        bit_set(&mut s.off_mark, step);
        if UNMARKS {
            s.again = true;
            if !bit(&s.off_listed, step) {
                bit_set(&mut s.off_listed, step);
                s.off[s.off_count] = step as Row;
                s.off_count += 1;
            }
        } else {
            s.off[s.off_count] = step as Row;
            s.off_count += 1;
        }
    }
}

pub(crate) fn activate(s: &mut State, step: usize) {
    s.m.x[step] = true;
    if ONE_WORD {
        s.m.active[0] |= 1u32 << step;
        if HAS_FOLLOWERS {
            s.behind[0] = 1;
        }
    } else {
        let k: usize = step >> 5;
        s.m.active[k] |= 1u32 << (step & 31);
        s.m.top[k >> 5] |= 1u32 << (k & 31);
        if HAS_FOLLOWERS {
            s.behind[k >> 5] |= 1u32 << (k & 31);
        }
    }
    if STABLE {
        s.changed = true;
    }
    if NOTES_STEPS {
        s.stepped = true;
    }
    if HAS_COUNTS {
        s.moved += 1;
    }
    if HAS_TIMES {
        begin_time(s, step);
    }
    if HAS_ON {
        step_on(s, step);
    }
}

pub(crate) fn deactivate(s: &mut State, step: usize) {
    s.m.x[step] = false;
    if ONE_WORD {
        s.m.active[0] &= inv(1u32 << step);
        if HAS_FOLLOWERS {
            s.behind[0] = 1;
        }
    } else {
        let k: usize = step >> 5;
        s.m.active[k] &= inv(1u32 << (step & 31));
        if s.m.active[k] == 0 {
            s.m.top[k >> 5] &= inv(1u32 << (k & 31));
        }
        if HAS_FOLLOWERS {
            s.behind[k >> 5] |= 1u32 << (k & 31);
        }
    }
    if STABLE {
        s.changed = true;
    }
    if NOTES_STEPS {
        s.stepped = true;
    }
    if HAS_COUNTS {
        s.moved += 1;
    }
    if HAS_TIMES {
        end_time(s, step);
    }
    if HAS_ON {
        step_off(s, step);
    }
}

/// Makes the marked changes, with all that follows from them.
pub(crate) fn commit(s: &mut State) {
    if HAS_HIERARCHY {
        cascade(s);
    }
    make_changes(s);
}

/// Makes the marked changes and no others, with their stored actions.
pub(crate) fn make_changes(s: &mut State) {
    if HAS_LISTS {
        gather(s);
    }
    if DEFERS {
        run_deferred(s);
        if s.fault != 0 {
            return;
        }
    }
    apply(s);
    if DEFERS {
        write_deferred(s);
    } else if HAS_STORED {
        run_stored(s);
    }
}

/// Collects the stored actions of the marked changes.
pub(crate) fn gather(s: &mut State) {
    let mut k: usize = 0;
    while k < s.off_count {
        let step: usize = s.off[k] as usize;
        k += 1;
        if bit(&s.off_mark, step) && !bit(&s.on_mark, step) && s.m.x[step] {
            gather_off(s, step);
        }
    }
    k = 0;
    while k < s.on_count {
        let step: usize = s.on[k] as usize;
        k += 1;
        if bit(&s.on_mark, step) && !s.m.x[step] {
            gather_on(s, step);
        }
    }
}

/// Switches the marked steps; what is activated is not deactivated (rule 5).
pub(crate) fn apply(s: &mut State) {
    if HAS_GROUPS {
        s.emptied_count = 0;
    }
    let mut k: usize = 0;
    while k < s.off_count {
        let step: usize = s.off[k] as usize;
        k += 1;
        let goes: bool = bit(&s.off_mark, step) && !bit(&s.on_mark, step) && s.m.x[step];
        bit_clear(&mut s.off_mark, step);
        if UNMARKS {
            bit_clear(&mut s.off_listed, step);
        }
        if goes {
            deactivate(s, step);
        }
    }
    s.off_count = 0;
    k = 0;
    while k < s.on_count {
        let step: usize = s.on[k] as usize;
        k += 1;
        let comes: bool = bit(&s.on_mark, step) && !s.m.x[step];
        bit_clear(&mut s.on_mark, step);
        if UNMARKS {
            bit_clear(&mut s.on_listed, step);
        }
        if comes {
            activate(s, step);
        }
    }
    s.on_count = 0;
}

pub(crate) fn run_at_end(s: &mut State, action: usize) {
    bit_set(&mut s.late, action);
    s.late_any = true;
}

/// An action of a step that comes on or goes off.
pub(crate) fn store_action(s: &mut State, action: usize) {
    if LATE {
        run_at_end(s, action);
    } else {
        run_in_pass(s, action);
    }
}

pub(crate) fn run_in_pass(s: &mut State, action: usize) {
    s.runs[s.runs_count] = action as Row;
    s.runs_count += 1;
}

/// Runs the stored actions of this pass one after the other.
pub(crate) fn run_stored(s: &mut State) {
    if s.runs_count == 0 {
        return;
    }
    sort(&mut s.runs, s.runs_count);
    let mut k: usize = 0;
    while k < s.runs_count {
        run_action(s, s.runs[k] as usize);
        if s.fault != 0 {
            return;
        }
        k += 1;
    }
    s.runs_count = 0;
}

/// Runs the stored actions of this pass on the values from before it.
pub(crate) fn run_deferred(s: &mut State) {
    if s.runs_count == 0 {
        return;
    }
    sort(&mut s.runs, s.runs_count);
    let mut k: usize = 0;
    while k < s.runs_count {
        defer_action(s, s.runs[k] as usize);
        if s.fault != 0 {
            return;
        }
        k += 1;
    }
}

/// Makes what they wrote true; the later writer wins.
pub(crate) fn write_deferred(s: &mut State) {
    let mut k: usize = 0;
    while k < s.runs_count {
        write_action(s, s.runs[k] as usize);
        k += 1;
    }
    s.runs_count = 0;
}

pub(crate) fn sort(rows: &mut [Row], count: usize) {
    let mut k: usize = 1;
    while k < count {
        let row_here: Row = rows[k];
        let mut j: usize = k;
        while j > 0 && rows[j - 1] > row_here {
            rows[j] = rows[j - 1];
            j -= 1;
        }
        rows[j] = row_here;
        k += 1;
    }
}

/// Runs what was put aside for the end of the scan, in order.
pub(crate) fn run_late(s: &mut State) {
    if !s.late_any {
        return;
    }
    s.late_any = false;
    let mut action: usize = bit_next(&s.late, ACTIONS, 0);
    while action < ACTIONS {
        bit_clear(&mut s.late, action);
        run_action(s, action);
        if s.fault != 0 {
            return;
        }
        action = bit_next(&s.late, ACTIONS, action + 1);
    }
}
