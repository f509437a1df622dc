// What evolves.
struct Memory {
    // the step memories: whether each step is active
    x: [bool; STEPS],
    // active steps, a bit each: the list of those to look at
    active: [u32; WORDS],
    // words of `active` that are not zero, a bit each
    top: [u32; TOP],
    // when a step was activated; how long it was active once it is not
    stamp: [i64; STEPS],
    // the same in nanoseconds
    age: [i64; STEPS],
    // active steps of a group
    group_count: [row; GROUPS],
    group_stamp: [i64; GROUPS],
    group_age: [i64; GROUPS],
    // edges and timers: the expression as it was
    value: [bool; WATCHES],
    rise: [bool; WATCHES],
    fall: [bool; WATCHES],
    // timers: output, whether running, since when
    timer: [bool; WATCHES],
    running: [bool; WATCHES],
    start: [i64; WATCHES],
    // actions on event, of each scan, with a condition: those of active steps
    events: [u32; EVENT_WORDS],
    periodics: [u32; PERIODIC_WORDS],
    conditions: [u32; CONDITION_WORDS],
    counted: [bool; CONDITIONS],
    // control blocks: inputs that are true, those to look at, Q as written last
    counts: [row; COUNTS],
    blocks: [u32; BLOCK_WORDS],
    written: [bool; BLOCKS],
    // control blocks with memory: inputs before, flip-flops, timers
    inputs_before: [u16; FULL],
    flip: [u16; FULL],
    block_start: [i64; FULL_TIMES],
    block_time: [i64; FULL_TIMES],
    // when a period is due next
    next_due: [i64; PERIODS],
    // requests of services: groups and steps, a bit each
    requests: bool,
    ask_init: [u32; GROUP_WORDS],
    ask_clear: [u32; GROUP_WORDS],
    ask_set: [u32; WORDS],
    ask_reset: [u32; WORDS],
}

// Everything that the chart remembers, and room to work in.
struct State {
    // the inputs of this scan
    inputs: Inputs,
    outputs: Outputs,
    v: Variables,
    m: Memory,
    t: Locals,
    next: Next,
    wrote: Wrote,
    // time of this scan, and since the scan before
    now: i64,
    dt: i64,
    scans: i64,
    started: bool,
    fault: u8,
    changed: bool,
    stepped: bool,
    again: bool,
    conflict: bool,
    // loops made in this scan
    work: u32,
    // outputs that follow a step are behind
    behind: bool,
    // clearing conditions: enabled and the receptivity true; and with nothing in the way
    clearable: [bool; TRANSITIONS],
    cf: [bool; TRANSITIONS],
    // transitions that clear in this pass
    fired: [row; TRANSITIONS],
    fired_count: usize,
    dropped: [bool; TRANSITIONS],
    taken: [u32; WORDS],
    // steps to be activated and deactivated: a bit each, and as a list
    on_mark: [u32; WORDS],
    off_mark: [u32; WORDS],
    on_listed: [u32; WORDS],
    off_listed: [u32; WORDS],
    on: [row; STEPS],
    off: [row; STEPS],
    on_count: usize,
    off_count: usize,
    // the situation as the pass began
    before: [bool; STEPS],
    // actions to run in this pass, and at the end of the scan
    runs: [row; RUNS],
    runs_count: usize,
    late: [u32; ACTION_WORDS],
    late_any: bool,
    before_periodics: [u32; PERIODIC_WORDS],
    blocked: [bool; CHARTS],
    forced_by: [row; CHARTS],
    due: [bool; PERIODS],
    emptied_count: usize,
    emptied: [row; GROUPS],
    emptied_stamp: [i64; GROUPS],
    emptied_age: [i64; GROUPS],
    // steps that follow one another through enclosures
    chain: [row; CHAIN],
    chain_count: usize,
    left: [row; ENTERED],
    left_count: usize,
    came: [row; ENTERED],
    came_count: usize,
    // steps activated and deactivated in this scan
    moved: u32,
    active_before: u32,
    enabled_before: [bool; TRANSITIONS],
    before_v: Variables,
    before_outputs: Outputs,
    // a picture that a circulating chart comes back to
    saved_outputs: Outputs,
    saved_v: Variables,
    saved_m: Memory,
}

fn bit(words: &[u32], i: usize) -> bool {
    return ((words[i >> 5] >> (i & 31)) & 1) != 0;
}

fn bit_set(words: &mut [u32], i: usize) {
    words[i >> 5] |= 1u32 << (i & 31);
}

fn bit_clear(words: &mut [u32], i: usize) {
    words[i >> 5] &= inv(1u32 << (i & 31));
}

// The first bit that is set at `from` or behind; `count` where there is none.
fn bit_next(words: &[u32], count: usize, from: usize) -> usize {
    if from >= count {
        return count;
    }
    let mut k: usize = from >> 5;
    let mut word: u32 = words[k] & (0xffffffffu32 << (from & 31));
    while word == 0 {
        k += 1;
        if (k << 5) >= count {
            return count;
        }
        word = words[k];
    }
    return (k << 5) + low_bit(word);
}

// Whether a step is active.
pub fn is_active(s: &State, step: usize) -> bool {
    return step < STEPS && s.m.x[step];
}

// Time since a step was activated in nanoseconds (scans under the scan clock);
// how long it was active once it is not.
pub fn step_time(s: &State, step: usize) -> i64 {
    if step >= STEPS {
        return 0;
    }
    if s.m.x[step] {
        return since(clock(s), s.m.stamp[step]);
    }
    return s.m.stamp[step];
}

fn step_age(s: &State, step: usize) -> i64 {
    if !SCAN_CLOCK {
        return step_time(s, step);
    }
    if s.m.x[step] {
        return since(s.now, s.m.age[step]);
    }
    return s.m.age[step];
}

// A step's time in tenths of a second.
fn step_tenths(s: &State, step: usize) -> i64 {
    let tenths: i64 = step_time(s, step) / 100000000;
    if tenths < 0 {
        return 0;
    }
    if tenths > 9999 {
        return 9999;
    }
    return tenths;
}

fn group_active(s: &State, group: usize) -> bool {
    return s.m.group_count[group] != 0;
}

fn group_time(s: &State, group: usize) -> i64 {
    if group_active(s, group) {
        return since(clock(s), s.m.group_stamp[group]);
    }
    return s.m.group_stamp[group];
}

fn group_age(s: &State, group: usize) -> i64 {
    if !SCAN_CLOCK {
        return group_time(s, group);
    }
    if group_active(s, group) {
        return since(s.now, s.m.group_age[group]);
    }
    return s.m.group_age[group];
}

// The time that step times count in.
fn clock(s: &State) -> i64 {
    if SCAN_CLOCK {
        return s.scans;
    }
    return s.now;
}

fn mark_on(s: &mut State, step: usize) {
    if !bit(&s.on_mark, step) {
        bit_set(&mut s.on_mark, step);
        if UNMARKS {
            s.again = true;
            if !bit(&s.on_listed, step) {
                bit_set(&mut s.on_listed, step);
                s.on[s.on_count] = step as row;
                s.on_count += 1;
            }
        } else {
            s.on[s.on_count] = step as row;
            s.on_count += 1;
        }
    }
}

fn mark_off(s: &mut State, step: usize) {
    if !bit(&s.off_mark, step) {
        bit_set(&mut s.off_mark, step);
        if UNMARKS {
            s.again = true;
            if !bit(&s.off_listed, step) {
                bit_set(&mut s.off_listed, step);
                s.off[s.off_count] = step as row;
                s.off_count += 1;
            }
        } else {
            s.off[s.off_count] = step as row;
            s.off_count += 1;
        }
    }
}

fn activate(s: &mut State, step: usize) {
    s.m.x[step] = true;
    if !FLAT {
        let k: usize = step >> 5;
        s.m.active[k] |= 1u32 << (step & 31);
        s.m.top[k >> 5] |= 1u32 << (k & 31);
    }
    if STABLE {
        s.changed = true;
    }
    if NOTES_STEPS {
        s.stepped = true;
    }
    if HAS_FOLLOWERS && !FLAT {
        s.behind = true;
    }
    if HAS_COUNTS {
        s.moved += 1;
    }
    s.m.stamp[step] = clock(s);
    if SCAN_CLOCK {
        s.m.age[step] = s.now;
    }
    if HAS_ON {
        step_on(s, step);
    }
}

fn deactivate(s: &mut State, step: usize) {
    s.m.x[step] = false;
    if !FLAT {
        let k: usize = step >> 5;
        s.m.active[k] &= inv(1u32 << (step & 31));
        if s.m.active[k] == 0 {
            s.m.top[k >> 5] &= inv(1u32 << (k & 31));
        }
    }
    if STABLE {
        s.changed = true;
    }
    if NOTES_STEPS {
        s.stepped = true;
    }
    if HAS_FOLLOWERS && !FLAT {
        s.behind = true;
    }
    if HAS_COUNTS {
        s.moved += 1;
    }
    if KEEP {
        s.m.stamp[step] = since(clock(s), s.m.stamp[step]);
    } else {
        s.m.stamp[step] = 0;
    }
    if SCAN_CLOCK {
        if KEEP {
            s.m.age[step] = since(s.now, s.m.age[step]);
        } else {
            s.m.age[step] = 0;
        }
    }
    if HAS_ON {
        step_off(s, step);
    }
}

// Makes the marked changes, with all that follows from them.
fn commit(s: &mut State) {
    if HAS_HIERARCHY {
        cascade(s);
    }
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

// Collects the stored actions of the marked changes.
fn gather(s: &mut State) {
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

// Switches the marked steps; what is activated is not deactivated (rule 5).
fn apply(s: &mut State) {
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

fn run_at_end(s: &mut State, action: usize) {
    bit_set(&mut s.late, action);
    s.late_any = true;
}

// An action of a step that comes on or goes off.
fn store_action(s: &mut State, action: usize) {
    if LATE {
        run_at_end(s, action);
    } else {
        run_in_pass(s, action);
    }
}

fn run_in_pass(s: &mut State, action: usize) {
    s.runs[s.runs_count] = action as row;
    s.runs_count += 1;
}

// Runs the stored actions of this pass one after the other.
fn run_stored(s: &mut State) {
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

// Runs the stored actions of this pass on the values from before it.
fn run_deferred(s: &mut State) {
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

// Makes what they wrote true; the later writer wins.
fn write_deferred(s: &mut State) {
    let mut k: usize = 0;
    while k < s.runs_count {
        write_action(s, s.runs[k] as usize);
        k += 1;
    }
    s.runs_count = 0;
}

fn sort(rows: &mut [row], count: usize) {
    let mut k: usize = 1;
    while k < count {
        let row_here: row = rows[k];
        let mut j: usize = k;
        while j > 0 && rows[j - 1] > row_here {
            rows[j] = rows[j - 1];
            j -= 1;
        }
        rows[j] = row_here;
        k += 1;
    }
}

// Runs what was put aside for the end of the scan, in order.
fn run_late(s: &mut State) {
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
