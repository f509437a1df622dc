//! The memory of a chart, and the times of its steps.

use super::*;

/// The memory that evolves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Memory {
    /// the step memories: whether each step is active
    pub x: [bool; STEPS],
    /// active steps, a bit each: the list of those to look at
    pub active: [u32; WORDS],
    /// words of `active` that are not zero, a bit each
    pub top: [u32; TOP],
    /// active steps of a group
    pub group_count: [Row; GROUPS],
    pub group_stamp: [i64; GROUPS],
    pub group_age: [i64; GROUPS],
    /// edges and timers: the expression as it was
    pub value: [bool; WATCHES],
    pub rise: [bool; WATCHES],
    pub fall: [bool; WATCHES],
    /// timers: output, whether running, since when
    pub timer: [bool; WATCHES],
    pub running: [bool; WATCHES],
    pub start: [Tick; WATCHES],
    /// actions on event, of each scan, with a condition: those of active steps
    pub events: [u32; EVENT_WORDS],
    pub periodics: [u32; PERIODIC_WORDS],
    pub conditions: [u32; CONDITION_WORDS],
    pub counted: [bool; CONDITIONS],
    /// control blocks: inputs that are true, those to look at, Q as written last
    pub counts: [Row; COUNTS],
    pub blocks: [u32; BLOCK_WORDS],
    pub written: [bool; BLOCKS],
    /// control blocks with memory: inputs before, flip-flops, timers
    pub inputs_before: [u16; FULL],
    pub flip: [u16; FULL],
    pub block_start: [Tick; FULL_TIMES],
    pub block_time: [i64; FULL_TIMES],
    /// when a period is due next
    pub next_due: [i64; PERIODS],
    /// requests of services: groups and steps, a bit each
    pub requests: bool,
    /// all charts are to take the situation of the start
    pub ask_start: bool,
    pub ask_init: [u32; GROUP_WORDS],
    pub ask_clear: [u32; GROUP_WORDS],
    pub ask_set: [u32; WORDS],
    pub ask_reset: [u32; WORDS],
}

/// Everything that the chart remembers, and room to work in.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// the inputs of this scan
    pub inputs: Inputs,
    pub outputs: Outputs,
    pub v: Variables,
    pub m: Memory,
    pub t: Locals,
    pub next: Next,
    pub wrote: Wrote,
    /// when a step was activated; how long it was active once it is not
    pub stamp: [Tick; TIMED],
    /// the same by the clock where those count scans
    pub age: [Tick; TIMED],
    /// a time of a step changed since the picture: what is now is new
    pub renewed: bool,
    /// the clock as it was given
    pub tick: Tick,
    /// time of this scan, and since the scan before
    pub now: i64,
    pub dt: i64,
    pub scans: i64,
    pub started: bool,
    pub fault: u8,
    pub changed: bool,
    pub stepped: bool,
    pub again: bool,
    pub conflict: bool,
    /// loops made in this scan
    pub work: i32,
    /// words of steps whose outputs are behind, a bit each
    pub behind: [u32; TOP],
    /// transitions that clear in this pass
    pub fired: [Row; FIRED],
    pub fired_count: usize,
    pub dropped: [bool; FIRED],
    pub taken: [u32; WORDS],
    /// some step is activated that is active already
    pub stays: bool,
    /// steps to be activated and deactivated: a bit each, and as a list
    pub on_mark: [u32; WORDS],
    pub off_mark: [u32; WORDS],
    pub on_listed: [u32; WORDS],
    pub off_listed: [u32; WORDS],
    pub on: [Row; MARKED_ON],
    pub off: [Row; MARKED_OFF],
    pub on_count: usize,
    pub off_count: usize,
    /// the situation as the pass began
    pub before: [bool; STEPS],
    /// actions to run in this pass, and at the end of the scan
    pub runs: [Row; RUNS],
    pub runs_count: usize,
    pub late: [u32; ACTION_WORDS],
    pub late_any: bool,
    pub before_periodics: [u32; PERIODIC_WORDS],
    pub blocked: [bool; CHARTS],
    pub forced_by: [Row; CHARTS],
    pub due: [bool; PERIODS],
    pub emptied_count: usize,
    pub emptied: [Row; GROUPS],
    pub emptied_stamp: [i64; GROUPS],
    pub emptied_age: [i64; GROUPS],
    /// steps that follow one another through enclosures
    pub chain: [Row; CHAIN],
    pub chain_count: usize,
    pub left: [Row; ENTERED],
    pub left_count: usize,
    pub came: [Row; ENTERED],
    pub came_count: usize,
    /// steps activated and deactivated in this scan
    pub moved: u32,
    pub active_before: u32,
    pub enabled_before: [bool; TRANSITIONS],
    pub before_v: Variables,
    pub before_outputs: Outputs,
    /// a picture that a circulating chart comes back to
    pub saved_outputs: Outputs,
    pub saved_v: Variables,
    pub saved_m: Memory,
}

pub(crate) fn bit(words: &[u32], i: usize) -> bool {
    ((words[i >> 5] >> (i & 31)) & 1) != 0
}

pub(crate) fn bit_set(words: &mut [u32], i: usize) {
    words[i >> 5] |= 1u32 << (i & 31);
}

pub(crate) fn bit_clear(words: &mut [u32], i: usize) {
    words[i >> 5] &= inv(1u32 << (i & 31));
}

/// The first bit that is set at `from` or behind; `count` where there is none.
pub(crate) fn bit_next(words: &[u32], count: usize, from: usize) -> usize {
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
    (k << 5) + low_bit(word)
}

/// Time since a step was activated in nanoseconds (scans under the scan clock);
/// how long it was active once it is not.
pub fn step_time(s: &State, step: usize) -> i64 {
    if !HAS_TIMES {
        return 0;
    }
    if step >= STEPS {
        return 0;
    }
    let at: usize = time_of(step);
    if FEW_TIMES && at >= TIMED {
        return 0;
    }
    if s.m.x[step] {
        return in_clock(ticks_between(ticks(s), s.stamp[at]));
    }
    in_clock(s.stamp[at])
}

pub(crate) fn step_age(s: &State, step: usize) -> i64 {
    if !SCAN_CLOCK {
        return step_time(s, step);
    }
    if !HAS_TIMES {
        return 0;
    }
    let at: usize = time_of(step);
    if FEW_TIMES && at >= TIMED {
        return 0;
    }
    if s.m.x[step] {
        return in_nanoseconds(ticks_between(s.tick, s.age[at]));
    }
    in_nanoseconds(s.age[at])
}

/// Where the time of a step stands; behind all where it has none.
pub(crate) fn time_of(step: usize) -> usize {
    if FEW_TIMES {
        return TIME_OF[step] as usize;
    }
    step
}

/// Ticks from then to now. Those of 32 bits begin again at 0, and end at half of what they can say.
pub(crate) fn ticks_between(now: Tick, then: Tick) -> Tick {
    if NARROW {
        return ticks_since(now as u32, then as u32) as Tick;
    }
    since(now as i64, then as i64) as Tick
}

pub(crate) fn in_nanoseconds(time: Tick) -> i64 {
    if NARROW {
        return (time as i64) * (TICK as i64);
    }
    time as i64
}

/// A time of a step, in scans under the scan clock.
pub(crate) fn in_clock(time: Tick) -> i64 {
    if SCAN_CLOCK {
        return time as i64;
    }
    in_nanoseconds(time)
}

/// The time that step times count in, as it is kept.
pub(crate) fn ticks(s: &State) -> Tick {
    if SCAN_CLOCK {
        return s.scans as Tick;
    }
    s.tick
}

/// Notes when a step is activated.
pub(crate) fn begin_time(s: &mut State, step: usize) {
    let at: usize = time_of(step);
    if FEW_TIMES && at >= TIMED {
        return;
    }
    if STABLE && KEEP && s.stamp[at] != 0 {
        s.renewed = true;
    }
    s.stamp[at] = ticks(s);
    if SCAN_CLOCK {
        s.age[at] = s.tick;
    }
}

/// Notes when a step is deactivated. What came in this pass or the passes before, in the same
/// instant, can come back as it was; what came earlier cannot.
pub(crate) fn end_time(s: &mut State, step: usize) {
    let at: usize = time_of(step);
    if FEW_TIMES && at >= TIMED {
        return;
    }
    if STABLE && s.stamp[at] != ticks(s) {
        s.renewed = true;
    }
    if KEEP {
        s.stamp[at] = ticks_between(ticks(s), s.stamp[at]);
    } else {
        s.stamp[at] = 0;
    }
    if SCAN_CLOCK {
        if KEEP {
            s.age[at] = ticks_between(s.tick, s.age[at]);
        } else {
            s.age[at] = 0;
        }
    }
}

pub(crate) fn hold_time(s: &mut State, at: usize) {
    if !FEW_TIMES || at < TIMED {
        s.stamp[at] = ticks_held(ticks(s) as u32, s.stamp[at] as u32) as Tick;
        if SCAN_CLOCK {
            s.age[at] = ticks_held(s.tick as u32, s.age[at] as u32) as Tick;
        }
    }
}

/// Holds ticks of 32 bits at their longest, so that none seems short again.
pub(crate) fn hold_ticks(s: &mut State) {
    if HAS_TIMES {
        for i in 0..STEPS {
            if s.m.x[i] {
                hold_time(s, time_of(i));
            }
        }
    }
    if HAS_WATCHES {
        for i in 0..WATCHES {
            if s.m.running[i] {
                s.m.start[i] = ticks_held(s.tick as u32, s.m.start[i] as u32) as Tick;
            }
        }
    }
    for i in 0..FULL_TIMES {
        s.m.block_start[i] = ticks_held(s.tick as u32, s.m.block_start[i] as u32) as Tick;
    }
}

pub(crate) fn group_active(s: &State, group: usize) -> bool {
    s.m.group_count[group] != 0
}

pub(crate) fn group_time(s: &State, group: usize) -> i64 {
    if group_active(s, group) {
        return since(clock(s), s.m.group_stamp[group]);
    }
    s.m.group_stamp[group]
}

pub(crate) fn group_age(s: &State, group: usize) -> i64 {
    if !SCAN_CLOCK {
        return group_time(s, group);
    }
    if group_active(s, group) {
        return since(s.now, s.m.group_age[group]);
    }
    s.m.group_age[group]
}

/// The time that step times count in.
pub(crate) fn clock(s: &State) -> i64 {
    if SCAN_CLOCK {
        return s.scans;
    }
    s.now
}
