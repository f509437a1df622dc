//! The parts of a scan: `begin`, a pass, `finish`.

use super::*;

/// One pass: judge all, then change all. `changed` tells whether another is needed.
pub(crate) fn pass(s: &mut State) {
    if HAS_PERIODS || HAS_ORDERS {
        block_charts(s);
        if s.fault != 0 {
            return;
        }
    }
    if LOOKS_BACK {
        s.before = s.m.x;
    }
    collect(s);
    if HAS_EVENTS && s.fault == 0 {
        events(s);
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
    resolve(s);
    if SEQUENTIAL {
        in_turn(s);
    } else if BARE {
        pass_on(s);
    } else {
        let mut k: usize = 0;
        while k < s.fired_count {
            clear(s, s.fired[k] as usize);
            k += 1;
        }
        commit(s);
    }
    if COMES_AND_GOES {
        s.changed =
            s.stepped || !same_variables(&s.before_v, &s.v) || !same_outputs(&s.before_outputs, &s.outputs);
    }
}

/// Another pass in the same scan.
pub(crate) fn next_pass(s: &mut State) {
    if HAS_WATCHES {
        watch(s, false);
        if s.fault != 0 {
            return;
        }
    }
    pass(s);
}

/// The clock in ticks of 32 bits, which begins again at 0: time goes on by their difference.
pub(crate) fn set_ticks(s: &mut State, now: Tick, fresh: bool) {
    if !fresh {
        s.dt = in_nanoseconds(ticks_gone(now as u32, s.tick as u32) as Tick);
        s.now += in_nanoseconds(ticks_gone(now as u32, s.tick as u32) as Tick);
    }
    let before: u32 = s.tick as u32;
    s.tick = now;
    s.scans += 1;
    // Twice in the range that a time can have.
    if has_turned(now as u32, before) || (SCAN_CLOCK && has_turned(s.scans as u32, (s.scans - 1) as u32)) {
        hold_ticks(s);
    }
}

/// Inputs, time, edges, PRE, services.
pub(crate) fn begin(s: &mut State, now: Tick) {
    let fresh: bool = !s.started;
    s.dt = 0;
    if NARROW {
        set_ticks(s, now, fresh);
    } else {
        if !fresh {
            s.dt = since(now as i64, s.now);
        }
        s.now = now as i64;
        s.tick = now;
        s.scans += 1;
    }
    s.work = 0;
    if HAS_PERIODS {
        find_due(s, fresh);
    }
    if fresh {
        s.started = true;
        start(s);
        // The initial situation is the initial steps alone: no links.
        make_changes(s);
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
    if HAS_REQUESTS && s.m.requests {
        carry_out(s);
        if s.fault != 0 {
            return;
        }
    }
    if LOOKS_EARLY && s.stepped {
        look_early(s);
        if s.fault != 0 {
            return;
        }
    }
    if HAS_COUNTS {
        count_before(s);
    }
    if PERIODIC_FIRST && HAS_PERIODICS {
        s.before_periodics = s.m.periodics;
    }
}

/// Outputs, control blocks, bodies, POST.
pub(crate) fn finish(s: &mut State) {
    if HAS_FOLLOWERS {
        catch_up(s);
    }
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
        evaluate_blocks(s);
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
