//! A choice, a fork and a join, cleared in turn: entry and exit actions run at once.
//!
//! ```text
//! profile iec60848 { one-pass sequential ordered-actions }
//!
//! input go, fork, first : BOOL
//! output a, b : BOOL
//! var entered, left : INT := 0
//!
//! chart Line {
//!   initial step 1
//!   step 2 {
//!     P1 { entered := entered + 1 }
//!     P0 { left := left + 1 }
//!     N a
//!   }
//!   step 3 { N b }
//!   step 4
//!
//!   1 -> 2 when go priority 1
//!   1 -> 3 when go and first priority 2
//!   2 -> (3, 4) when fork
//!   (3, 4) -> 1 when not fork
//!   4 -> 2 when not fork and first
//! }
//! ```

pub use crate::chart::*;

use super::evolution::*;
use crate::arithmetic::add;

pub(crate) use crate::chart::{Row, Tick};

/// Line.1
pub const STEP_1: usize = 0;
/// Line.2
pub const STEP_2: usize = 1;
/// Line.3
pub const STEP_3: usize = 2;
/// Line.4
pub const STEP_4: usize = 3;
pub const T_1_TO_2: usize = 0;
pub const T_1_TO_3: usize = 1;
pub const T_2_TO_3_4: usize = 2;
pub const T_3_4_TO_1: usize = 3;
pub const T_4_TO_2: usize = 4;
pub const SEQUENTIAL: bool = true;
pub const HAS_LISTS: bool = true;
pub const HAS_STORED: bool = true;
pub const HAS_JOINS: bool = true;
pub const HAS_SETTLED: bool = true;
pub const HAS_CONTESTS: bool = true;
pub const HAS_FOLLOWERS: bool = true;
pub const HAS_OUTS: bool = true;

pub const STEPS: usize = 4;
pub const TIMED: usize = 4;
pub const TRANSITIONS: usize = 5;
pub const FIRED: usize = 5;
pub const MARKED_ON: usize = 4;
pub const MARKED_OFF: usize = 4;
pub const ACTIONS: usize = 2;
pub const RUNS: usize = 2;
pub const ENTERED: usize = 9;
pub const BOUND: u32 = 1;

/// Where each row begins.
pub static FROM_AT: [u8; 6] = [0, 1, 2, 3, 5, 6];

/// The steps before each transition.
pub static FROM: [u8; 6] = [
    STEP_1 as u8, // 1 -> 2 when go priority 1
    STEP_1 as u8, // 1 -> 3 when go and first priority 2
    STEP_2 as u8, // 2 -> (3, 4) when fork
    STEP_3 as u8,
    STEP_4 as u8, // (3, 4) -> 1 when not fork
    STEP_4 as u8, // 4 -> 2 when not fork and first
];

/// Where each row begins.
pub static TO_AT: [u8; 6] = [0, 1, 2, 4, 5, 6];

/// The steps behind each transition.
pub static TO: [u8; 6] = [
    STEP_2 as u8, // 1 -> 2 when go priority 1
    STEP_3 as u8, // 1 -> 3 when go and first priority 2
    STEP_3 as u8,
    STEP_4 as u8, // 2 -> (3, 4) when fork
    STEP_1 as u8, // (3, 4) -> 1 when not fork
    STEP_2 as u8, // 4 -> 2 when not fork and first
];

/// Where each row begins.
pub static OUT_AT: [u8; 5] = [0, 2, 3, 4, 5];

/// The transitions behind each step.
pub static OUT: [u8; 5] = [
    T_1_TO_2 as u8,
    T_1_TO_3 as u8,   // Line.1
    T_2_TO_3_4 as u8, // Line.2
    T_3_4_TO_1 as u8, // Line.3
    T_4_TO_2 as u8,   // Line.4
];

/// Transitions that share a step before them.
pub static SHARES: [bool; 5] = [true, true, false, true, true];

/// Transitions that leave nothing to those behind them.
pub static SETTLES: [bool; 5] = [true, true, true, false, true];

/// The inputs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inputs {
    pub go: bool,
    pub fork: bool,
    pub first: bool,
}

/// The outputs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outputs {
    pub a: bool,
    pub b: bool,
}

/// The variables of the chart.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Variables {
    pub entered: i16,
    pub left: i16,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Locals {}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Next {}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrote {}

/// The initial situation.
pub fn start(s: &mut State) {
    mark_on(s, STEP_1);
}

/// True if the receptivity of a transition is true.
pub fn receptivity(s: &mut State, transition: usize) -> bool {
    match transition {
        // 1 -> 2 when go priority 1
        T_1_TO_2 => s.inputs.go,
        // 1 -> 3 when go and first priority 2
        T_1_TO_3 => s.inputs.go && s.inputs.first,
        // 2 -> (3, 4) when fork
        T_2_TO_3_4 => s.inputs.fork,
        // (3, 4) -> 1 when not fork
        T_3_4_TO_1 => !s.inputs.fork,
        // 4 -> 2 when not fork and first
        T_4_TO_2 => !s.inputs.fork && s.inputs.first,
        _ => false,
    }
}

/// Outputs that follow a step.
pub fn follow(s: &mut State, _word: usize) {
    s.outputs.a = s.m.x[STEP_2];
    s.outputs.b = s.m.x[STEP_3];
}

/// The actions of a step that comes on.
pub fn run_on(s: &mut State, step: usize) {
    match step {
        // Line.2
        STEP_2 => {
            run_action(s, 0);
        }
        _ => {}
    }
}

/// The actions of a step that goes off.
pub fn run_off(s: &mut State, step: usize) {
    match step {
        // Line.2
        STEP_2 => {
            run_action(s, 1);
        }
        _ => {}
    }
}

/// P1 { entered := entered + 1 }
pub fn action_0(s: &mut State) {
    let x1: i16 = add(s.v.entered, 1, &mut s.fault);
    if s.fault != 0 {
        return;
    }
    s.v.entered = x1;
}

/// P0 { left := left + 1 }
pub fn action_1(s: &mut State) {
    let x1: i16 = add(s.v.left, 1, &mut s.fault);
    if s.fault != 0 {
        return;
    }
    s.v.left = x1;
}

/// Runs an action.
pub fn run_action(s: &mut State, action: usize) {
    match action {
        // P1 { entered := entered + 1 }
        0 => {
            action_0(s);
        }
        // P0 { left := left + 1 }
        1 => {
            action_1(s);
        }
        _ => {}
    }
}

/// Outputs to their safe values.
pub fn to_safety(s: &mut State) {
    s.outputs = Outputs::default();
}
