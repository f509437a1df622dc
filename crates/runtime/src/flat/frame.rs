//! The memory of a chart, and its sections in order.

use super::*;

/// Everything that the chart remembers, and room to work in.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// the inputs of this scan
    pub inputs: Inputs,
    pub outputs: Outputs,
    pub v: Variables,
    pub m: Memory,
    pub w: Work,
    pub t: Locals,
    /// time of this scan, and since the scan before
    pub now: i64,
    pub dt: i64,
    pub started: bool,
    pub renewed: bool,
    pub fault: u8,
    /// the pass changed something
    pub changed: bool,
    /// a picture that a circulating chart comes back to
    pub saved_outputs: Outputs,
    pub saved_v: Variables,
    pub saved_m: Memory,
}

/// Time since a step was activated in nanoseconds (scans under the scan clock);
/// how long it was active once it is not.
pub fn step_time(s: &State, step: usize) -> i64 {
    if step >= STEPS {
        return 0;
    }
    if s.m.x[step] {
        return since(s.m.clock, s.m.stamp[step]);
    }
    s.m.stamp[step]
}

/// Time, periods, the first scan.
pub(crate) fn begin(s: &mut State, now: Tick) {
    s.dt = 0;
    if s.started {
        s.dt = since(now as i64, s.now);
    }
    s.now = now as i64;
    sections_before(s);
}

/// One pass: edges, transitions, steps, stored actions.
pub(crate) fn pass(s: &mut State) {
    sections_of_pass(s);
}

/// Another pass in the same scan.
pub(crate) fn next_pass(s: &mut State) {
    sections_of_pass(s);
}

/// Outputs, control blocks, bodies, POST.
pub(crate) fn finish(s: &mut State) {
    sections_behind(s);
}
