//! Which transitions clear in a pass, and what that marks.

use super::*;

/// Every transition that can clear, as far as it can be told without the others.
pub(crate) fn collect(s: &mut State) {
    s.fired_count = 0;
    if HAS_SOURCES {
        sources(s);
        if s.fault != 0 {
            return;
        }
    }
    if HAS_OUTS {
        watch_all(s);
    }
}

pub(crate) fn watch_all(s: &mut State) {
    if ONE_WORD {
        watch_word(s, 0);
        return;
    }
    let mut j: usize = 0;
    while j < TOP {
        let mut words: u32 = s.m.top[j];
        while words != 0 {
            watch_word(s, (j << 5) + low_bit(words));
            words &= words - 1;
            if GUARDS_FAIL && s.fault != 0 {
                return;
            }
        }
        j += 1;
    }
}

/// The transitions behind the active steps of one word.
pub(crate) fn watch_word(s: &mut State, k: usize) {
    let mut steps: u32 = s.m.active[k];
    while steps != 0 {
        watch_step(s, (k << 5) + low_bit(steps));
        steps &= steps - 1;
        if GUARDS_FAIL && s.fault != 0 {
            return;
        }
    }
}

/// The transitions behind an active step, best priority first.
pub(crate) fn watch_step(s: &mut State, step: usize) {
    if (HAS_ORDERS || HAS_PERIODS) && s.blocked[STEP_CHART[step] as usize] {
        return;
    }
    let mut i: usize = OUT_AT[step] as usize;
    while i < OUT_AT[step + 1] as usize {
        let t: usize = OUT[i] as usize;
        i += 1;
        if is_clearable(s, t) {
            fire(s, t);
            // Behind the first that clears none is looked at.
            if HAS_SETTLED && SETTLES[t] {
                return;
            }
        }
        if GUARDS_FAIL && s.fault != 0 {
            return;
        }
    }
}

/// True if a transition that is looked at from its first preceding step is enabled
/// and its receptivity true.
pub(crate) fn is_clearable(s: &mut State, t: usize) -> bool {
    if HAS_JOINS {
        let mut i: usize = FROM_AT[t] as usize + 1;
        while i < FROM_AT[t + 1] as usize {
            if !s.m.x[FROM[i] as usize] {
                return false;
            }
            i += 1;
        }
    }
    is_true(s, t)
}

pub(crate) fn is_true(s: &mut State, t: usize) -> bool {
    if SAME_RECEPTIVITIES {
        return receptivity(s, WHEN[t] as usize);
    }
    receptivity(s, t)
}

pub(crate) fn judge_source(s: &mut State, t: usize) {
    if is_true(s, t) {
        fire(s, t);
    }
}

/// Transitions without a preceding step.
pub(crate) fn sources(s: &mut State) {
    for i in 0..SOURCES {
        if HAS_ORDERS || HAS_PERIODS {
            if !s.blocked[SOURCE_CHART[i] as usize] {
                judge_source(s, SOURCE[i] as usize);
            }
        } else {
            judge_source(s, SOURCE[i] as usize);
        }
        if s.fault != 0 {
            return;
        }
    }
}

/// A transition clears: the steps before it go off, those behind it come on.
pub(crate) fn clear(s: &mut State, t: usize) {
    if ONE_TO_ONE {
        mark_off(s, FROM[t] as usize);
        mark_on(s, TO[t] as usize);
    } else {
        let mut i: usize = FROM_AT[t] as usize;
        while i < FROM_AT[t + 1] as usize {
            mark_off(s, FROM[i] as usize);
            i += 1;
        }
        if HAS_DROPS {
            i = DROPS_AT[t] as usize;
            while i < DROPS_AT[t + 1] as usize {
                mark_off(s, DROPS[i] as usize);
                i += 1;
            }
        }
        i = TO_AT[t] as usize;
        while i < TO_AT[t + 1] as usize {
            mark_on(s, TO[i] as usize);
            i += 1;
        }
    }
    if HAS_CLEARING && (ON_CLEARING[t] as usize) < ACTIONS {
        run_in_pass(s, ON_CLEARING[t] as usize);
    }
}

/// Makes the changes of all transitions that clear, activations first: a step that is
/// activated stays active (rule 5), and was active before if a transition leaves it.
pub(crate) fn pass_on(s: &mut State) {
    let mut k: usize = 0;
    while k < s.fired_count {
        let t: usize = s.fired[k] as usize;
        k += 1;
        if ONE_TO_ONE {
            come(s, TO[t] as usize);
        } else {
            let mut i: usize = TO_AT[t] as usize;
            while i < TO_AT[t + 1] as usize {
                come(s, TO[i] as usize);
                i += 1;
            }
        }
    }
    k = 0;
    while k < s.fired_count {
        let t: usize = s.fired[k] as usize;
        k += 1;
        if ONE_TO_ONE {
            go(s, FROM[t] as usize);
        } else {
            let mut i: usize = FROM_AT[t] as usize;
            while i < FROM_AT[t + 1] as usize {
                go(s, FROM[i] as usize);
                i += 1;
            }
        }
    }
    if s.stays {
        s.stays = false;
        for i in 0..WORDS {
            s.on_mark[i] = 0;
        }
    }
}

pub(crate) fn come(s: &mut State, step: usize) {
    if s.m.x[step] {
        bit_set(&mut s.on_mark, step);
        s.stays = true;
    } else {
        activate(s, step);
    }
}

pub(crate) fn go(s: &mut State, step: usize) {
    if s.m.x[step] && !(s.stays && bit(&s.on_mark, step)) {
        deactivate(s, step);
    }
}

pub(crate) fn fire(s: &mut State, transition: usize) {
    s.fired[s.fired_count] = transition as Row;
    s.fired_count += 1;
}

/// Drops what priority drops.
pub(crate) fn resolve(s: &mut State) {
    if !MULTI && HAS_CONTESTS {
        sort(&mut s.fired, s.fired_count);
        exclude(s);
    } else if MULTI && EXCLUSIVE && HAS_CONTESTS {
        by_number(s);
        sort(&mut s.fired, s.fired_count);
    } else if SEQUENTIAL {
        sort(&mut s.fired, s.fired_count);
    }
}

/// In order of rank, a transition that shares a step with one that was kept falls out.
pub(crate) fn exclude(s: &mut State) {
    let mut kept: usize = 0;
    let mut k: usize = 0;
    while k < s.fired_count {
        let t: usize = s.fired[k] as usize;
        k += 1;
        let mut free: bool = true;
        if SHARES[t] {
            free = is_free(s, t);
            if free {
                take(s, t);
            }
        }
        if free {
            s.fired[kept] = t as Row;
            kept += 1;
        }
    }
    s.fired_count = kept;
    for i in 0..WORDS {
        s.taken[i] = 0;
    }
}

/// Drops each transition that shares a step with one of a better number.
pub(crate) fn by_number(s: &mut State) {
    let mut k: usize = 1;
    while k < s.fired_count {
        let t: Row = s.fired[k];
        let mut j: usize = k;
        while j > 0 && is_worse(s.fired[j - 1] as usize, t as usize) {
            s.fired[j] = s.fired[j - 1];
            j -= 1;
        }
        s.fired[j] = t;
        k += 1;
    }
    let mut from: usize = 0;
    let mut kept: usize = 0;
    while from < s.fired_count {
        let number: u32 = PRIORITY[s.fired[from] as usize];
        let mut to: usize = from;
        while to < s.fired_count && PRIORITY[s.fired[to] as usize] == number {
            s.dropped[to] = !is_free(s, s.fired[to] as usize);
            to += 1;
        }
        let mut i: usize = from;
        while i < to {
            take(s, s.fired[i] as usize);
            i += 1;
        }
        i = from;
        while i < to {
            if !s.dropped[i] {
                s.fired[kept] = s.fired[i];
                kept += 1;
            }
            i += 1;
        }
        from = to;
    }
    s.fired_count = kept;
    for i in 0..WORDS {
        s.taken[i] = 0;
    }
}

pub(crate) fn is_worse(a: usize, b: usize) -> bool {
    PRIORITY[a] > PRIORITY[b] || (PRIORITY[a] == PRIORITY[b] && a > b)
}

pub(crate) fn is_free(s: &State, t: usize) -> bool {
    let mut i: usize = FROM_AT[t] as usize;
    while i < FROM_AT[t + 1] as usize {
        if bit(&s.taken, FROM[i] as usize) {
            return false;
        }
        i += 1;
    }
    true
}

pub(crate) fn take(s: &mut State, t: usize) {
    let mut i: usize = FROM_AT[t] as usize;
    while i < FROM_AT[t + 1] as usize {
        bit_set(&mut s.taken, FROM[i] as usize);
        i += 1;
    }
}
