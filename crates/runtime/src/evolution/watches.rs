//! Edges, timers and periods, as a scan or a pass begins.

use super::*;

/// Edges live one pass.
pub(crate) fn edge(s: &mut State, i: usize, now: bool, fresh: bool) {
    let before: bool = s.m.value[i];
    s.m.value[i] = now;
    s.m.rise[i] = now && !before && !fresh;
    s.m.fall[i] = before && !now && !fresh;
}

/// True if a timer runs now that its condition is known; then it asks for its time.
pub(crate) fn timer_runs(s: &mut State, i: usize, now: bool) -> bool {
    if s.m.value[i] != now {
        s.m.value[i] = now;
        s.m.running[i] = s.m.timer[i] != now;
        s.m.start[i] = 0;
        if s.m.running[i] {
            s.m.start[i] = s.tick;
        }
    }
    s.m.running[i]
}

pub(crate) fn timer_goes(s: &mut State, i: usize, time: i64) {
    let mut least: i64 = time;
    if least < 0 {
        least = 0;
    }
    if is_over(s, i, least) {
        s.m.running[i] = false;
        s.m.start[i] = 0;
        s.m.timer[i] = s.m.value[i];
    }
}

/// True if a timer has run for so long.
pub(crate) fn is_over(s: &State, i: usize, time: i64) -> bool {
    if NARROW {
        return in_nanoseconds(ticks_between(s.tick, s.m.start[i])) >= time;
    }
    is_due_after(s.now, s.m.start[i] as i64, time)
}

/// Which periods are due; instants missed are skipped, not queued.
pub(crate) fn find_due(s: &mut State, fresh: bool) {
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
