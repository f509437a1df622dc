//! Enclosed charts follow their enclosing steps; groups of steps and their times.

use super::*;

/// Enclosed charts follow their enclosing steps, through all levels.
pub(crate) fn cascade(s: &mut State) {
    s.again = true;
    while s.again {
        s.again = false;
        let mut k: usize = 0;
        while k < s.off_count {
            let step: usize = s.off[k] as usize;
            k += 1;
            if bit(&s.off_mark, step) && !bit(&s.on_mark, step) && s.m.x[step] {
                empty_enclosed(s, step);
            }
        }
    }
    s.again = true;
    while s.again {
        s.again = false;
        let mut k: usize = 0;
        while k < s.on_count {
            let step: usize = s.on[k] as usize;
            k += 1;
            if bit(&s.on_mark, step) && !s.m.x[step] {
                let mut i: usize = LINKS_AT[step] as usize;
                while i < LINKS_AT[step + 1] as usize {
                    mark_on(s, LINKS[i] as usize);
                    i += 1;
                }
            }
        }
    }
}

pub(crate) fn empty_enclosed(s: &mut State, step: usize) {
    let mut i: usize = ENCLOSES_AT[step] as usize;
    while i < ENCLOSES_AT[step + 1] as usize {
        let group: usize = ENCLOSES[i] as usize;
        i += 1;
        let first: usize = GROUP_FIRST[group] as usize;
        let end: usize = GROUP_END[group] as usize;
        // An activation in a chart that is being emptied does not take place.
        let mut j: usize = 0;
        while j < s.on_count {
            let other: usize = s.on[j] as usize;
            j += 1;
            if other >= first && other < end && bit(&s.on_mark, other) {
                bit_clear(&mut s.on_mark, other);
                if bit(&s.off_mark, other) {
                    s.again = true;
                }
            }
        }
        mark_range_off(s, first, end);
    }
}

pub(crate) fn mark_range_off(s: &mut State, first: usize, end: usize) {
    let mut k: usize = bit_next(&s.m.active, end, first);
    while k < end {
        mark_off(s, k);
        k = bit_next(&s.m.active, end, k + 1);
    }
}

pub(crate) fn count_group(s: &mut State, group: usize, on: bool) {
    let old: Row = s.m.group_count[group];
    if on {
        s.m.group_count[group] += 1;
        if old == 0 {
            group_on(s, group);
        }
    } else if old != 0 {
        s.m.group_count[group] -= 1;
        if old == 1 {
            group_off(s, group);
        }
    }
}

/// A group that loses its last step and gets another in the same change was
/// active without a break.
pub(crate) fn group_on(s: &mut State, group: usize) {
    let mut stamp: i64 = clock(s);
    let mut age: i64 = s.now;
    let mut k: usize = 0;
    while k < s.emptied_count {
        if s.emptied[k] as usize == group {
            stamp = s.emptied_stamp[k];
            age = s.emptied_age[k];
        }
        k += 1;
    }
    s.m.group_stamp[group] = stamp;
    s.m.group_age[group] = age;
}

pub(crate) fn group_off(s: &mut State, group: usize) {
    if s.emptied_count < GROUPS {
        s.emptied[s.emptied_count] = group as Row;
        s.emptied_stamp[s.emptied_count] = s.m.group_stamp[group];
        s.emptied_age[s.emptied_count] = s.m.group_age[group];
        s.emptied_count += 1;
    }
    if KEEP {
        s.m.group_stamp[group] = since(clock(s), s.m.group_stamp[group]);
        s.m.group_age[group] = since(s.now, s.m.group_age[group]);
    } else {
        s.m.group_stamp[group] = 0;
        s.m.group_age[group] = 0;
    }
}
