// Enclosed charts follow their enclosing steps, through all levels.
fn cascade(s: &mut State) {
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

fn empty_enclosed(s: &mut State, step: usize) {
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

fn mark_range_off(s: &mut State, first: usize, end: usize) {
    if FLAT {
        for k in first..end {
            if s.m.x[k] {
                mark_off(s, k);
            }
        }
    } else {
        let mut k: usize = bit_next(&s.m.active, end, first);
        while k < end {
            mark_off(s, k);
            k = bit_next(&s.m.active, end, k + 1);
        }
    }
}

fn count_group(s: &mut State, group: usize, on: bool) {
    let old: row = s.m.group_count[group];
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

// A group that loses its last step and gets another in the same change was
// active without a break.
fn group_on(s: &mut State, group: usize) {
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

fn group_off(s: &mut State, group: usize) {
    if s.emptied_count < GROUPS {
        s.emptied[s.emptied_count] = group as row;
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

// Which charts stand still in this pass: those not due, and those forced.
fn block_charts(s: &mut State) {
    for i in 0..CHARTS {
        s.blocked[i] = false;
        if HAS_PERIODS {
            s.blocked[i] = !s.due[CHART_PERIOD[i] as usize];
        }
    }
    if HAS_ORDERS {
        for i in 0..CHARTS {
            s.forced_by[i] = NO_ORDER as row;
        }
        s.conflict = false;
        for i in 0..ORDERS {
            let step: usize = ORDER_STEP[i] as usize;
            if bit(&s.on_mark, step) || (s.m.x[step] && !bit(&s.off_mark, step)) {
                impose(s, i);
                if HAS_HIERARCHY {
                    cascade(s);
                }
            }
        }
        if s.conflict {
            s.fault = FAULT_FORCING;
        }
    }
}

// Marks what a forcing order imposes.
fn impose(s: &mut State, order: usize) {
    let chart: usize = ORDER_CHART[order] as usize;
    let first: usize = s.forced_by[chart] as usize;
    if first != NO_ORDER {
        if ORDER_SITUATION[first] != ORDER_SITUATION[order] {
            s.conflict = true;
        }
        return;
    }
    s.forced_by[chart] = order as row;
    s.blocked[chart] = true;
    // The present situation is number 0.
    if ORDER_SITUATION[order] == 0 {
        return;
    }
    let mut i: usize = ORDER_STEPS_AT[order] as usize;
    while i < ORDER_STEPS_AT[order + 1] as usize {
        mark_on(s, ORDER_STEPS[i] as usize);
        i += 1;
    }
    let group: usize = CHART_GROUP[chart] as usize;
    mark_range_off(s, GROUP_FIRST[group] as usize, GROUP_END[group] as usize);
    // An imposed step that is active already is neither activated nor deactivated.
    i = ORDER_STEPS_AT[order] as usize;
    while i < ORDER_STEPS_AT[order + 1] as usize {
        let step: usize = ORDER_STEPS[i] as usize;
        i += 1;
        if s.m.x[step] {
            bit_clear(&mut s.on_mark, step);
            bit_clear(&mut s.off_mark, step);
        }
    }
}

// Actions on event of the steps that are active as the pass begins.
fn events(s: &mut State) {
    let mut i: usize = bit_next(&s.m.events, EVENTS, 0);
    while i < EVENTS && s.fault == 0 {
        event(s, i);
        i = bit_next(&s.m.events, EVENTS, i + 1);
    }
}

// Transitions clear one after the other, with their actions at once.
fn in_turn(s: &mut State) {
    s.left_count = 0;
    s.came_count = 0;
    let mut k: usize = 0;
    while k < s.fired_count {
        let t: usize = s.fired[k] as usize;
        k += 1;
        if HAS_GROUPS {
            s.emptied_count = 0;
        }
        if HAS_CLEARING {
            if (ON_CLEARING[t] as usize) < ACTIONS {
                run_action(s, ON_CLEARING[t] as usize);
                if s.fault != 0 {
                    return;
                }
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

fn push(s: &mut State, step: usize) {
    if s.chain_count < CHAIN {
        s.chain[s.chain_count] = step as row;
        s.chain_count += 1;
    }
}

// Deactivates a step; its exit actions come first, its enclosed charts with it.
fn leave(s: &mut State, first: usize) {
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
                    s.left[s.left_count] = step as row;
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

// Activates a step; its entry actions run at once, its linked steps come with it.
fn enter(s: &mut State, first: usize) {
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
                    s.came[s.came_count] = step as row;
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

// What enclosing steps take and bring holds against the turns that came behind.
fn enclosures(s: &mut State) {
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

fn has_left(s: &State, step: usize) -> bool {
    for i in 0..s.left_count {
        if s.left[i] as usize == step {
            return true;
        }
    }
    return false;
}

// Edges live one pass.
fn edge(s: &mut State, i: usize, now: bool, fresh: bool) {
    let before: bool = s.m.value[i];
    s.m.value[i] = now;
    s.m.rise[i] = now && !before && !fresh;
    s.m.fall[i] = before && !now && !fresh;
}

// Whether a timer runs now that its condition is known; then it asks for its time.
fn timer_runs(s: &mut State, i: usize, now: bool) -> bool {
    if s.m.value[i] != now {
        s.m.value[i] = now;
        s.m.running[i] = s.m.timer[i] != now;
        s.m.start[i] = 0;
        if s.m.running[i] {
            s.m.start[i] = s.now;
        }
    }
    return s.m.running[i];
}

fn timer_goes(s: &mut State, i: usize, time: i64) {
    let mut least: i64 = time;
    if least < 0 {
        least = 0;
    }
    if is_due_after(s.now, s.m.start[i], least) {
        s.m.running[i] = false;
        s.m.start[i] = 0;
        s.m.timer[i] = s.m.value[i];
    }
}

// Which periods are due; instants missed are skipped, not queued.
fn find_due(s: &mut State, fresh: bool) {
    for i in 0..PERIODS {
        let period: i64 = PERIOD[i];
        let mut next: i64 = s.m.next_due[i];
        s.due[i] = period <= 0 || fresh || s.now >= next;
        if s.due[i] && period > 0 {
            if fresh {
                next = s.now;
            }
            s.m.next_due[i] = next + (period * (((s.now - next) / period) + 1));
        }
    }
}

// Carries out the requests of services.
fn carry_out(s: &mut State) {
    s.m.requests = false;
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

// RESET_XIT: all step times are 0.
fn reset_times(s: &mut State) {
    for i in 0..STEPS {
        let active: bool = s.m.x[i];
        s.m.stamp[i] = 0;
        if active {
            s.m.stamp[i] = clock(s);
        }
        if SCAN_CLOCK {
            s.m.age[i] = 0;
            if active {
                s.m.age[i] = s.now;
            }
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

// Actions of each scan of the active steps.
fn periodics(s: &mut State) {
    let mut i: usize = bit_next(&s.m.periodics, PERIODICS, 0);
    while i < PERIODICS {
        if !PERIODIC_FIRST || bit(&s.before_periodics, i) {
            run_at_end(s, PERIODIC_ACTION[i] as usize);
        }
        i = bit_next(&s.m.periodics, PERIODICS, i + 1);
    }
}

fn is_enabled(s: &State, t: usize) -> bool {
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
    return true;
}

fn count_active(s: &State) -> u32 {
    let mut count: u32 = 0;
    for i in 0..STEPS {
        if STEP_COUNTED[i] && s.m.x[i] {
            count += 1;
        }
    }
    return count;
}

fn count_before(s: &mut State) {
    for t in 0..TRANSITIONS {
        s.enabled_before[t] = is_enabled(s, t);
    }
    s.active_before = count_active(s);
    s.moved = 0;
}

fn at_most(count: u32) -> i64 {
    if count > 32767 {
        return 32767;
    }
    return count as i64;
}

// %SW20 and %SW21: what was, and what changed in this scan.
fn count_after(s: &mut State) {
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

fn judge_limits(s: &mut State) {
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
