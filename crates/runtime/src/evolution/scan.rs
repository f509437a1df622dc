//! A scan: `begin`, passes, `finish`.

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
    if FLAT {
        clearing_conditions(s);
    } else {
        collect(s);
    }
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
        s.changed =
            s.stepped || !same_variables(&s.before_v, &s.v) || !same_outputs(&s.before_outputs, &s.outputs);
    }
}

/// Passes until nothing changes, or just one.
pub(crate) fn evolve(s: &mut State) {
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

pub(crate) fn came_back(s: &State) -> bool {
    same_memory(&s.m, &s.saved_m)
        && same_variables(&s.v, &s.saved_v)
        && same_outputs(&s.outputs, &s.saved_outputs)
}

/// Inputs, time, edges, PRE, services.
pub(crate) fn begin(s: &mut State, now: i64) {
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

/// Control blocks, bodies, POST.
pub(crate) fn finish(s: &mut State) {
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

/// One scan. `now` never goes back; it is in nanoseconds. Tells a fault by its
/// number, FAULT_NONE where there is none; after a fault the outputs have their
/// safe values, and no further scan is made before `init` or `restart`.
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
    s.fault
}
