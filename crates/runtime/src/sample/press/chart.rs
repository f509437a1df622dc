//! A press: forcing, an enclosing step with a chart in a period of its own, stored
//! actions, an event, control blocks, a timer. Printed by `codegen`, with the facts put in.
//!
//! ```text
//! profile iec60848
//!
//! input on, stop, part, far : BOOL
//! output lamp, drive, clamp, horn : BOOL
//! var pieces : INT := 0
//! var late : TON
//!
//! chart Safety {
//!   initial step 1
//!   step 2 {
//!     N lamp
//!     force Work := {20}
//!   }
//!
//!   1 -> 2 when stop
//!   2 -> 1 when not stop
//! }
//!
//! chart Work {
//!   initial step 10
//!   enclosing step 11 {
//!     S clamp
//!     enclose Stroke
//!   }
//!   step 12 { R clamp }
//!   step 20
//!
//!   10 -> 11 when on and rise(part)
//!   11 -> 12 when X32
//!   12 -> 10 when 2s/X12
//!   20 -> 10 when on
//! }
//!
//! chart Stroke every 10ms {
//!   step 30* {
//!     N drive
//!     D 500ms horn
//!     on rise(far): pieces := pieces + 1
//!   }
//!   step 31 { P horn }
//!   step 32 { each scan: late(IN := far, PT := 1s) }
//!
//!   30 -> 31 when far
//!   31 -> 32 when not far
//! }
//! ```

pub use crate::chart::*;

use super::evolution::*;
use crate::arithmetic::add;
use crate::function_blocks::{Ton, call_ton};

pub(crate) use crate::chart::{Row, Tick};

/// Safety.1
pub const STEP_1: usize = 0;
/// Safety.2
pub const STEP_2: usize = 1;
/// Work.10
pub const STEP_10: usize = 2;
/// Work.11
pub const STEP_11: usize = 3;
/// Work.12
pub const STEP_12: usize = 4;
/// Work.20
pub const STEP_20: usize = 5;
/// Stroke.30
pub const STEP_30: usize = 6;
/// Stroke.31
pub const STEP_31: usize = 7;
/// Stroke.32
pub const STEP_32: usize = 8;
pub const T_1_TO_2: usize = 0;
pub const T_2_TO_1: usize = 1;
pub const T_10_TO_11: usize = 2;
pub const T_11_TO_12: usize = 3;
pub const T_12_TO_10: usize = 4;
pub const T_20_TO_10: usize = 5;
pub const T_30_TO_31: usize = 6;
pub const T_31_TO_32: usize = 7;
pub const STABLE: bool = true;
pub const HAS_ORDERS: bool = true;
pub const HAS_PERIODS: bool = true;
pub const HAS_HIERARCHY: bool = true;
pub const UNMARKS: bool = true;
pub const HAS_LISTS: bool = true;
pub const HAS_STORED: bool = true;
pub const DEFERS: bool = true;
pub const ONE_TO_ONE: bool = true;
pub const HAS_FOLLOWERS: bool = true;
pub const HAS_EVENTS: bool = true;
pub const HAS_PERIODICS: bool = true;
pub const HAS_BLOCKS: bool = true;
pub const HAS_FULL: bool = true;
pub const HAS_CONDITIONS: bool = true;
pub const HAS_WATCHES: bool = true;
pub const HAS_LATE: bool = true;
pub const HAS_ON: bool = true;
pub const HAS_OUTS: bool = true;

pub const STEPS: usize = 9;
pub const TIMED: usize = 9;
pub const TRANSITIONS: usize = 8;
pub const FIRED: usize = 8;
pub const MARKED_ON: usize = 9;
pub const MARKED_OFF: usize = 9;
pub const GROUPS: usize = 3;
pub const CHARTS: usize = 3;
pub const WATCHES: usize = 2;
pub const EVENTS: usize = 1;
pub const PERIODICS: usize = 1;
pub const CONDITIONS: usize = 3;
pub const BLOCKS: usize = 2;
pub const COUNTS: usize = 12;
pub const FULL: usize = 1;
pub const FULL_TIMES: usize = 5;
pub const PERIODS: usize = 2;
pub const ACTIONS: usize = 4;
pub const RUNS: usize = 3;
pub const ORDERS: usize = 1;
pub const NO_ORDER: usize = 1;
pub const CHAIN: usize = 4;
pub const ENTERED: usize = 19;
pub const BOUND: u32 = 1000;

/// The steps before each transition.
pub static FROM: [u8; 8] = [
    STEP_1 as u8,  // 1 -> 2 when stop
    STEP_2 as u8,  // 2 -> 1 when not stop
    STEP_10 as u8, // 10 -> 11 when on and rise(part)
    STEP_11 as u8, // 11 -> 12 when X32
    STEP_12 as u8, // 12 -> 10 when 2s/X12
    STEP_20 as u8, // 20 -> 10 when on
    STEP_30 as u8, // 30 -> 31 when far
    STEP_31 as u8, // 31 -> 32 when not far
];

/// The steps behind each transition.
pub static TO: [u8; 8] = [
    STEP_2 as u8,  // 1 -> 2 when stop
    STEP_1 as u8,  // 2 -> 1 when not stop
    STEP_11 as u8, // 10 -> 11 when on and rise(part)
    STEP_12 as u8, // 11 -> 12 when X32
    STEP_10 as u8, // 12 -> 10 when 2s/X12
    STEP_10 as u8, // 20 -> 10 when on
    STEP_31 as u8, // 30 -> 31 when far
    STEP_32 as u8, // 31 -> 32 when not far
];

/// Where each row begins.
pub static OUT_AT: [u8; 10] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 8];

/// The transitions behind each step.
pub static OUT: [u8; 8] = [
    T_1_TO_2 as u8,   // Safety.1
    T_2_TO_1 as u8,   // Safety.2
    T_10_TO_11 as u8, // Work.10
    T_11_TO_12 as u8, // Work.11
    T_12_TO_10 as u8, // Work.12
    T_20_TO_10 as u8, // Work.20
    T_30_TO_31 as u8, // Stroke.30
    T_31_TO_32 as u8, // Stroke.31
];

/// The chart of each step.
pub static STEP_CHART: [u8; 9] = [0, 0, 1, 1, 1, 1, 2, 2, 2];

/// Where each row begins.
pub static ENCLOSES_AT: [u8; 10] = [0, 0, 0, 0, 1, 1, 1, 1, 1, 1];

/// Groups that each step encloses.
pub static ENCLOSES: [u8; 1] = [2];

/// Where each row begins.
pub static LINKS_AT: [u8; 10] = [0, 0, 0, 0, 1, 1, 1, 1, 1, 1];

/// Steps that come on with each step.
pub static LINKS: [u8; 1] = [6];

/// Groups of steps: the first.
pub static GROUP_FIRST: [u8; 3] = [0, 2, 6];

/// Groups of steps: one behind the last.
pub static GROUP_END: [u8; 3] = [2, 6, 9];

/// The group of each chart.
pub static CHART_GROUP: [u8; 3] = [0, 1, 2];

/// The period of each chart.
pub static CHART_PERIOD: [u8; 3] = [0, 0, 1];

/// Periods in nanoseconds.
pub static PERIOD: [i64; 2] = [0, 10_000_000];

/// Actions of each scan.
pub static PERIODIC_ACTION: [u8; 1] = [3];

/// The situation that each forcing order imposes.
pub static ORDER_SITUATION: [u8; 1] = [1];

/// Where each row begins.
pub static ORDER_STEPS_AT: [u8; 2] = [0, 1];

/// The steps that each forcing order imposes.
pub static ORDER_STEPS: [u8; 1] = [5];

/// The step that gives each forcing order.
pub static ORDER_STEP: [u8; 1] = [1];

/// The chart that each forces.
pub static ORDER_CHART: [u8; 1] = [1];

/// Where the rows of each table begin.
pub static FROM_AT: [u8; 9] = [0, 1, 2, 3, 4, 5, 6, 7, 8];
pub static TO_AT: [u8; 9] = [0, 1, 2, 3, 4, 5, 6, 7, 8];

/// Values that stored actions have written, until the pass ends.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Next {
    pub clamp: bool,
    pub pieces: i16,
}

/// Which of it was written.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrote {
    pub clamp: bool,
    pub pieces: bool,
}

/// The inputs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inputs {
    pub on: bool,
    pub stop: bool,
    pub part: bool,
    pub far: bool,
}

/// The outputs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outputs {
    pub lamp: bool,
    pub drive: bool,
    pub clamp: bool,
    pub horn: bool,
}

/// The variables of the chart.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Variables {
    pub pieces: i16,
    pub late: Ton,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Locals {}

/// The initial situation.
pub fn start(s: &mut State) {
    mark_on(s, STEP_1);
    mark_on(s, STEP_10);
}

/// True if the receptivity of a transition is true.
pub fn receptivity(s: &mut State, transition: usize) -> bool {
    match transition {
        // 1 -> 2 when stop
        T_1_TO_2 => s.inputs.stop,
        // 2 -> 1 when not stop
        T_2_TO_1 => !s.inputs.stop,
        // 10 -> 11 when on and rise(part)
        T_10_TO_11 => s.inputs.on && s.m.rise[1],
        // 11 -> 12 when X32
        T_11_TO_12 => s.m.x[STEP_32],
        // 12 -> 10 when 2s/X12
        T_12_TO_10 => s.m.x[STEP_12] && step_time(s, STEP_12) >= 2_000_000_000,
        // 20 -> 10 when on
        T_20_TO_10 => s.inputs.on,
        // 30 -> 31 when far
        T_30_TO_31 => s.inputs.far,
        // 31 -> 32 when not far
        T_31_TO_32 => !s.inputs.far,
        _ => false,
    }
}

/// Outputs that follow a step.
pub fn follow(s: &mut State, _word: usize) {
    s.outputs.lamp = s.m.x[STEP_2];
}

/// The parts that come with a step.
pub fn step_on(s: &mut State, step: usize) {
    match step {
        // Stroke.30
        STEP_30 => {
            // N drive
            add_input(s, 0, 0);
            // D horn
            bit_set(&mut s.m.conditions, 1);
            bit_set(&mut s.m.events, 0);
        }
        // Stroke.31
        STEP_31 => {
            // P horn
            add_input(s, 6, 1);
        }
        // Stroke.32
        STEP_32 => {
            bit_set(&mut s.m.periodics, 0);
        }
        _ => {}
    }
}

/// The parts that go with a step.
pub fn step_off(s: &mut State, step: usize) {
    match step {
        // Stroke.30
        STEP_30 => {
            // N drive
            remove_input(s, 0, 0);
            // D horn
            drop_condition(s, 1, 5, 1);
            bit_clear(&mut s.m.events, 0);
        }
        // Stroke.31
        STEP_31 => {
            // P horn
            remove_input(s, 6, 1);
        }
        // Stroke.32
        STEP_32 => {
            bit_clear(&mut s.m.periodics, 0);
        }
        _ => {}
    }
}

/// The actions of a step that comes on.
pub fn gather_on(s: &mut State, step: usize) {
    match step {
        // Work.11
        STEP_11 => {
            store_action(s, 0);
        }
        // Work.12
        STEP_12 => {
            store_action(s, 1);
        }
        _ => {}
    }
}

/// Edges and delays, as a pass begins.
pub fn watch(s: &mut State, fresh: bool) {
    if s.due[1] {
        let now0: bool = s.inputs.far;
        edge(s, 0, now0, fresh);
    }
    let now1: bool = s.inputs.part;
    edge(s, 1, now1, fresh);
}

/// S clamp
pub fn deferred_0(s: &mut State) {
    let own_clamp: bool = true;
    s.next.clamp = own_clamp;
    s.wrote.clamp = true;
}

/// R clamp
pub fn deferred_1(s: &mut State) {
    let own_clamp: bool = false;
    s.next.clamp = own_clamp;
    s.wrote.clamp = true;
}

/// on rise(far): pieces := pieces + 1
pub fn deferred_2(s: &mut State) {
    if s.due[1] {
        let mut own_pieces: i16 = s.v.pieces;
        let x1: i16 = add(own_pieces, 1, &mut s.fault);
        if s.fault != 0 {
            return;
        }
        own_pieces = x1;
        s.next.pieces = own_pieces;
        s.wrote.pieces = true;
    }
}

/// each scan: late(IN := far, PT := 1s)
pub fn action_3(s: &mut State) {
    if s.due[1] {
        s.v.late.in_ = s.inputs.far;
        s.v.late.pt = 1_000_000_000;
        call_ton(&mut s.v.late, s.now);
    }
}

/// Runs an action.
pub fn run_action(s: &mut State, action: usize) {
    match action {
        // each scan: late(IN := far, PT := 1s)
        3 => {
            action_3(s);
        }
        _ => {}
    }
}

/// Runs an action; what it writes waits.
pub fn defer_action(s: &mut State, action: usize) {
    match action {
        // S clamp
        0 => {
            deferred_0(s);
        }
        // R clamp
        1 => {
            deferred_1(s);
        }
        // on rise(far): pieces := pieces + 1
        2 => {
            deferred_2(s);
        }
        _ => {}
    }
}

/// Writes what waits.
pub fn write_action(s: &mut State, action: usize) {
    match action {
        // S clamp
        0 => {
            write_clamp(s);
        }
        // R clamp
        1 => {
            write_clamp(s);
        }
        // on rise(far): pieces := pieces + 1
        2 => {
            write_pieces(s);
        }
        _ => {}
    }
}

pub fn write_clamp(s: &mut State) {
    if s.wrote.clamp {
        s.wrote.clamp = false;
        if s.outputs.clamp != s.next.clamp {
            s.outputs.clamp = s.next.clamp;
            s.changed = true;
        }
    }
}

pub fn write_pieces(s: &mut State) {
    if s.wrote.pieces {
        s.wrote.pieces = false;
        if s.v.pieces != s.next.pieces {
            s.v.pieces = s.next.pieces;
            s.changed = true;
        }
    }
}

/// An action on event of an active step.
pub fn event(s: &mut State, row: usize) {
    match row {
        // on rise(far): pieces := pieces + 1
        0 => {
            if s.due[1] {
                let now: bool = s.m.rise[0];
                if now {
                    run_in_pass(s, 2);
                }
            }
        }
        _ => {}
    }
}

/// An input of a control block that has a condition or a time.
pub fn condition(s: &mut State, row: usize, pulses: bool) {
    match row {
        // D horn
        1 => {
            if !pulses && s.due[1] {
                if !s.m.counted[1] {
                    s.m.block_time[1] = 500_000_000;
                    count_condition(s, 1, true, 5, 1);
                }
            }
        }
        _ => {}
    }
}

/// A control block.
pub fn evaluate_block(s: &mut State, block: usize) {
    match block {
        // drive
        0 => {
            if s.due[1] {
                bit_clear(&mut s.m.blocks, 0);
                let q: bool = s.m.counts[0] != 0;
                if q != s.m.written[0] {
                    s.m.written[0] = q;
                    s.outputs.drive = q;
                }
            }
        }
        // horn
        1 => {
            if s.due[1] {
                bit_clear(&mut s.m.blocks, 1);
                let result: u32 = control_block(s, 0, 1, true);
                let q: bool = result & 1 != 0;
                if q != s.m.written[1] {
                    s.m.written[1] = q;
                    s.outputs.horn = q;
                }
                if result & 4 != 0 {
                    bit_set(&mut s.m.blocks, 1);
                }
            }
        }
        _ => {}
    }
}

/// Outputs to their safe values.
pub fn to_safety(s: &mut State) {
    s.outputs = Outputs::default();
}
