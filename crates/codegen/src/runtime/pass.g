// Every transition that can clear, as far as it can be told without the others.
fn collect(s: &mut State) {
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

fn watch_all(s: &mut State) {
    let mut j: usize = 0;
    while j < TOP {
        let mut words: u32 = s.m.top[j];
        while words != 0 {
            let k: usize = (j << 5) + low_bit(words);
            words &= words - 1;
            let mut steps: u32 = s.m.active[k];
            while steps != 0 {
                let step: usize = (k << 5) + low_bit(steps);
                steps &= steps - 1;
                watch_step(s, step);
                if GUARDS_FAIL {
                    if s.fault != 0 {
                        return;
                    }
                }
            }
        }
        j += 1;
    }
}

// The transitions behind an active step, best priority first.
fn watch_step(s: &mut State, step: usize) {
    if HAS_ORDERS || HAS_PERIODS {
        if s.blocked[STEP_CHART[step] as usize] {
            return;
        }
    }
    let mut i: usize = OUT_AT[step] as usize;
    while i < OUT_AT[step + 1] as usize {
        let t: usize = OUT[i] as usize;
        i += 1;
        if is_clearable(s, t) {
            fire(s, t);
            // Behind the first that clears none is looked at.
            if HAS_SETTLED {
                if SETTLES[t] {
                    return;
                }
            }
        }
        if GUARDS_FAIL {
            if s.fault != 0 {
                return;
            }
        }
    }
}

// Whether a transition that is looked at from its first preceding step is enabled
// and its receptivity true.
fn is_clearable(s: &mut State, t: usize) -> bool {
    if HAS_JOINS {
        let mut i: usize = FROM_AT[t] as usize + 1;
        while i < FROM_AT[t + 1] as usize {
            if !s.m.x[FROM[i] as usize] {
                return false;
            }
            i += 1;
        }
    }
    return is_true(s, t);
}

fn is_true(s: &mut State, t: usize) -> bool {
    if SAME_RECEPTIVITIES {
        return receptivity(s, WHEN[t] as usize);
    }
    return receptivity(s, t);
}

fn judge_source(s: &mut State, t: usize) {
    if is_true(s, t) {
        fire(s, t);
    }
}

// Transitions without a preceding step.
fn sources(s: &mut State) {
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

// A transition clears: the steps before it go off, those behind it come on.
fn clear(s: &mut State, t: usize) {
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
    if HAS_CLEARING {
        if (ON_CLEARING[t] as usize) < ACTIONS {
            run_in_pass(s, ON_CLEARING[t] as usize);
        }
    }
}

// A step's memory: `set` makes it true, `reset` false where it is not set (rule 5).
fn set_reset(s: &mut State, step: usize, set: bool, reset: bool) {
    if ALONE {
        if set {
            if !s.m.x[step] {
                activate(s, step);
            }
        } else if reset && s.m.x[step] {
            deactivate(s, step);
        }
    } else {
        if set {
            mark_on(s, step);
        }
        if reset {
            mark_off(s, step);
        }
    }
}

fn fire(s: &mut State, transition: usize) {
    s.fired[s.fired_count] = transition as row;
    s.fired_count += 1;
}

// Drops what priority drops.
fn resolve(s: &mut State) {
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

// In order of rank, a transition that shares a step with one that was kept falls out.
fn exclude(s: &mut State) {
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
            s.fired[kept] = t as row;
            kept += 1;
        }
    }
    s.fired_count = kept;
    for i in 0..WORDS {
        s.taken[i] = 0;
    }
}

// Drops each transition that shares a step with one of a better number.
fn by_number(s: &mut State) {
    let mut k: usize = 1;
    while k < s.fired_count {
        let t: row = s.fired[k];
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

fn is_worse(a: usize, b: usize) -> bool {
    return PRIORITY[a] > PRIORITY[b] || (PRIORITY[a] == PRIORITY[b] && a > b);
}

fn is_free(s: &State, t: usize) -> bool {
    let mut i: usize = FROM_AT[t] as usize;
    while i < FROM_AT[t + 1] as usize {
        if bit(&s.taken, FROM[i] as usize) {
            return false;
        }
        i += 1;
    }
    return true;
}

fn take(s: &mut State, t: usize) {
    let mut i: usize = FROM_AT[t] as usize;
    while i < FROM_AT[t + 1] as usize {
        bit_set(&mut s.taken, FROM[i] as usize);
        i += 1;
    }
}

// One pass: judge all, then change all. `changed` tells whether another is needed.
fn pass(s: &mut State) {
    if HAS_PERIODS || HAS_ORDERS {
        block_charts(s);
        if s.fault != 0 {
            return;
        }
    }
    if LOOKS_BACK {
        s.before = s.m.x;
    }
    if FLAT {
        clearing_conditions(s);
    } else {
        collect(s);
    }
    if HAS_EVENTS {
        if s.fault == 0 {
            events(s);
        }
    }
    if STABLE {
        s.changed = false;
    }
    if s.fault != 0 {
        return;
    }
    if COMES_AND_GOES {
        s.stepped = false;
        s.before_v = s.v;
        s.before_outputs = s.outputs;
    }
    if FLAT && SEQUENTIAL {
        s.fired_count = 0;
        for t in 0..TRANSITIONS {
            if s.cf[t] {
                fire(s, t);
            }
        }
    } else if !FLAT {
        resolve(s);
    }
    if SEQUENTIAL {
        in_turn(s);
    } else if FLAT {
        step_memories(s);
        commit(s);
    } else {
        let mut k: usize = 0;
        while k < s.fired_count {
            clear(s, s.fired[k] as usize);
            k += 1;
        }
        commit(s);
    }
    if COMES_AND_GOES {
        s.changed = s.stepped || !same_variables(&s.before_v, &s.v) || !same_outputs(&s.before_outputs, &s.outputs);
    }
}

// Passes until nothing changes, or just one.
fn evolve(s: &mut State) {
    pass(s);
    if STABLE {
        let mut made: u32 = 0;
        let mut power: u32 = 1;
        let mut distance: u32 = 0;
        while s.changed && s.fault == 0 {
            made += 1;
            if made >= BOUND {
                s.fault = FAULT_BOUND;
                return;
            }
            // Brent's search: a picture, renewed at doubling distances. Time and
            // inputs stand still, so what comes back comes back for ever.
            if made > 48 {
                distance += 1;
                if came_back(s) {
                    s.fault = FAULT_UNSTABLE;
                    return;
                }
            }
            if made == 48 || (made > 48 && distance == power) {
                s.saved_outputs = s.outputs;
                s.saved_v = s.v;
                s.saved_m = s.m;
                if made > 48 {
                    power += power;
                }
                distance = 0;
            }
            if HAS_WATCHES {
                watch(s, false);
                if s.fault != 0 {
                    return;
                }
            }
            pass(s);
        }
    }
}

fn came_back(s: &State) -> bool {
    return same_memory(&s.m, &s.saved_m) && same_variables(&s.v, &s.saved_v) && same_outputs(&s.outputs, &s.saved_outputs);
}

// Inputs, time, edges, PRE, services.
fn begin(s: &mut State, now: i64) {
    let fresh: bool = !s.started;
    s.dt = 0;
    if !fresh {
        s.dt = since(now, s.now);
    }
    s.now = now;
    s.scans += 1;
    s.work = 0;
    if HAS_PERIODS {
        find_due(s, fresh);
    }
    if fresh {
        s.started = true;
        start(s);
        commit(s);
        if s.fault != 0 {
            return;
        }
    }
    if HAS_WATCHES {
        watch(s, fresh);
        if s.fault != 0 {
            return;
        }
    }
    if HAS_PRE {
        pre(s);
        if s.fault != 0 {
            return;
        }
    }
    if HAS_SERVICES {
        services(s);
        if s.fault != 0 {
            return;
        }
    }
    if NOTES_STEPS {
        s.stepped = fresh;
    }
    if HAS_REQUESTS {
        if s.m.requests {
            carry_out(s);
            if s.fault != 0 {
                return;
            }
        }
    }
    if LOOKS_EARLY {
        if s.stepped {
            look_early(s);
            if s.fault != 0 {
                return;
            }
        }
    }
    if HAS_COUNTS {
        count_before(s);
    }
    if PERIODIC_FIRST && HAS_PERIODICS {
        s.before_periodics = s.m.periodics;
    }
}

// Control blocks, bodies, POST.
fn finish(s: &mut State) {
    if HAS_COUNTS {
        count_after(s);
    }
    if PERIODIC_FIRST && HAS_PERIODICS {
        periodics(s);
        run_late(s);
        if s.fault != 0 {
            return;
        }
    }
    if HAS_CONDITIONS {
        look_at_conditions(s, false);
        if s.fault != 0 {
            return;
        }
    }
    if HAS_BLOCKS {
        if FLAT {
            control_blocks(s);
        } else {
            evaluate_blocks(s);
        }
        if s.fault != 0 {
            return;
        }
    }
    if !PERIODIC_FIRST && HAS_PERIODICS {
        periodics(s);
    }
    if HAS_LATE {
        run_late(s);
        if s.fault != 0 {
            return;
        }
    }
    if HAS_POST {
        post(s);
        if s.fault != 0 {
            return;
        }
    }
    if HAS_TAIL {
        tail(s);
        if s.fault != 0 {
            return;
        }
    }
    if HAS_LIMITS {
        judge_limits(s);
    }
}

// One scan. `now` never goes back; it is in nanoseconds. Tells a fault by its
// number, FAULT_NONE where there is none; after a fault the outputs have their
// safe values, and no further scan is made before `init` or `restart`.
pub fn scan(input: &Inputs, out: &mut Outputs, s: &mut State, now: i64) -> u8 {
    if s.fault != 0 {
        *out = s.outputs;
        return FAULT_STOPPED;
    }
    if s.started && now < s.now {
        s.fault = FAULT_INPUTS;
    } else {
        s.inputs = *input;
        begin(s, now);
        if s.fault == 0 {
            evolve(s);
        }
        if HAS_FOLLOWERS {
            if FLAT {
                follow(s);
            } else if s.behind {
                s.behind = false;
                follow(s);
            }
        }
        if s.fault == 0 {
            finish(s);
        }
    }
    if s.fault != 0 {
        to_safety(s);
    }
    *out = s.outputs;
    return s.fault;
}
