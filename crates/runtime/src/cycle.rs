//! A scan as callers see it: its parts in order, the search for stability, the end
//! after a fault. Compiled and printed with the parts of either style: a walk over the
//! active steps (`evolution`), or equations (`flat`).

use super::*;

/// True if a step is active.
pub fn is_active(s: &State, step: usize) -> bool {
    step < STEPS && s.m.x[step]
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
                if TIMES_APART {
                    s.renewed = false;
                }
                if made > 48 {
                    power += power;
                }
                distance = 0;
            }
            next_pass(s);
        }
    }
}

pub(crate) fn came_back(s: &State) -> bool {
    if TIMES_APART && s.renewed {
        return false;
    }
    same_memory(&s.m, &s.saved_m)
        && same_variables(&s.v, &s.saved_v)
        && same_outputs(&s.outputs, &s.saved_outputs)
}

/// True if a scan can be made: no fault has stopped the chart, and time does not go back.
pub(crate) fn can_scan(s: &State, now: Tick) -> bool {
    if NARROW {
        return s.fault == 0;
    }
    s.fault == 0 && (!s.started || now as i64 >= s.now)
}

/// One scan. `now` never goes back; it is in the unit of the clock. Tells a fault by its
/// number, FAULT_NONE where there is none; after a fault the outputs have their
/// safe values, and no further scan is made before `init` or `restart`.
pub fn scan(input: &Inputs, out: &mut Outputs, s: &mut State, now: Tick) -> u8 {
    if can_scan(s, now) {
        s.inputs = *input;
    }
    let fault: u8 = scan_in_place(s, now);
    *out = s.outputs;
    fault
}

/// As `scan`, with the inputs and outputs that stand in the state: of many, none is copied.
pub fn scan_in_place(s: &mut State, now: Tick) -> u8 {
    if s.fault != 0 {
        return FAULT_STOPPED;
    }
    if !NARROW && s.started && (now as i64) < s.now {
        s.fault = FAULT_INPUTS;
    } else {
        begin(s, now);
        if s.fault == 0 {
            evolve(s);
        }
        if s.fault == 0 {
            finish(s);
        }
    }
    if s.fault != 0 {
        to_safety(s);
    }
    s.fault
}
