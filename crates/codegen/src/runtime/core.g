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
