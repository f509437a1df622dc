//! Transitions that clear one after the other, with their actions at once.

use super::*;

/// Transitions clear one after the other, with their actions at once.
pub(crate) fn in_turn(s: &mut State) {
    s.left_count = 0;
    s.came_count = 0;
    let mut k: usize = 0;
    while k < s.fired_count {
        let t: usize = s.fired[k] as usize;
        k += 1;
        if HAS_GROUPS {
            s.emptied_count = 0;
        }
        if HAS_CLEARING && (ON_CLEARING[t] as usize) < ACTIONS {
            run_action(s, ON_CLEARING[t] as usize);
            if s.fault != 0 {
                return;
            }
        }
        let mut i: usize = FROM_AT[t] as usize;
        while i < FROM_AT[t + 1] as usize {
            leave(s, FROM[i] as usize);
            if s.fault != 0 {
                return;
            }
            i += 1;
        }
        if HAS_DROPS {
            i = DROPS_AT[t] as usize;
            while i < DROPS_AT[t + 1] as usize {
                leave(s, DROPS[i] as usize);
                if s.fault != 0 {
                    return;
                }
                i += 1;
            }
        }
        i = TO_AT[t] as usize;
        while i < TO_AT[t + 1] as usize {
            enter(s, TO[i] as usize);
            if s.fault != 0 {
                return;
            }
            i += 1;
        }
    }
    if HAS_HIERARCHY {
        enclosures(s);
    }
    commit(s);
}

pub(crate) fn push(s: &mut State, step: usize) {
    if s.chain_count < CHAIN {
        s.chain[s.chain_count] = step as Row;
        s.chain_count += 1;
    }
}

/// Deactivates a step; its exit actions come first, its enclosed charts with it.
pub(crate) fn leave(s: &mut State, first: usize) {
    s.chain_count = 0;
    push(s, first);
    while s.chain_count > 0 {
        s.chain_count -= 1;
        let step: usize = s.chain[s.chain_count] as usize;
        if s.m.x[step] {
            if HAS_LISTS {
                run_off(s, step);
                if s.fault != 0 {
                    return;
                }
            }
            deactivate(s, step);
            if HAS_HIERARCHY {
                if ENCLOSES_AT[step] < ENCLOSES_AT[step + 1] && s.left_count < ENTERED {
                    s.left[s.left_count] = step as Row;
                    s.left_count += 1;
                }
                let mut i: usize = ENCLOSES_AT[step + 1] as usize;
                while i > ENCLOSES_AT[step] as usize {
                    i -= 1;
                    let group: usize = ENCLOSES[i] as usize;
                    let mut k: usize = GROUP_END[group] as usize;
                    while k > GROUP_FIRST[group] as usize {
                        k -= 1;
                        if s.m.x[k] {
                            push(s, k);
                        }
                    }
                }
            }
        }
    }
}

/// Activates a step; its entry actions run at once, its linked steps come with it.
pub(crate) fn enter(s: &mut State, first: usize) {
    s.chain_count = 0;
    push(s, first);
    while s.chain_count > 0 {
        s.chain_count -= 1;
        let step: usize = s.chain[s.chain_count] as usize;
        if !s.m.x[step] {
            activate(s, step);
            if HAS_LISTS {
                run_on(s, step);
                if s.fault != 0 {
                    return;
                }
            }
            if HAS_HIERARCHY {
                if LINKS_AT[step] < LINKS_AT[step + 1] && s.came_count < ENTERED {
                    s.came[s.came_count] = step as Row;
                    s.came_count += 1;
                }
                let mut i: usize = LINKS_AT[step + 1] as usize;
                while i > LINKS_AT[step] as usize {
                    i -= 1;
                    push(s, LINKS[i] as usize);
                }
            }
        }
    }
}

/// Enclosing steps decide over the turns that came behind.
pub(crate) fn enclosures(s: &mut State) {
    let mut k: usize = 0;
    while k < s.left_count {
        let step: usize = s.left[k] as usize;
        k += 1;
        if !s.m.x[step] {
            let mut i: usize = ENCLOSES_AT[step] as usize;
            while i < ENCLOSES_AT[step + 1] as usize {
                let group: usize = ENCLOSES[i] as usize;
                i += 1;
                let first: usize = GROUP_FIRST[group] as usize;
                let end: usize = GROUP_END[group] as usize;
                for j in first..end {
                    bit_clear(&mut s.on_mark, j);
                }
                mark_range_off(s, first, end);
            }
        }
    }
    k = 0;
    while k < s.came_count {
        let step: usize = s.came[k] as usize;
        k += 1;
        if s.m.x[step] && !has_left(s, step) {
            let mut i: usize = LINKS_AT[step] as usize;
            while i < LINKS_AT[step + 1] as usize {
                mark_on(s, LINKS[i] as usize);
                i += 1;
            }
        }
    }
}

pub(crate) fn has_left(s: &State, step: usize) -> bool {
    for i in 0..s.left_count {
        if s.left[i] as usize == step {
            return true;
        }
    }
    false
}
