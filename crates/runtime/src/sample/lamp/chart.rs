//! ```text
//! input press;  output lamp
//! initial step Off;  step On { N lamp }
//! Off -> On when press;  On -> Off when On.t >= 2s and not press
//! ```
//!
//! Passes go on until nothing changes.

pub use crate::chart::*;

use super::flat::State;

pub const OFF: usize = 0;
pub const ON: usize = 1;

pub const STABLE: bool = true;
pub const STEPS: usize = 2;
pub const BOUND: u32 = 1000;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inputs {
    pub press: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outputs {
    pub lamp: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Variables {}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Locals {}

/// The memories that last from scan to scan.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Memory {
    pub x: [bool; STEPS],
    pub clock: i64,
    pub stamp: [i64; STEPS],
}

/// The memories that are worked out in each scan anew.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work {
    pub clears: [bool; 2],
}

pub fn sections_before(s: &mut State) {
    s.m.clock += s.dt;
    if !s.started {
        s.m.x[OFF] = true;
        s.started = true;
    }
}

pub fn sections_of_pass(s: &mut State) {
    s.w.clears[0] = s.m.x[OFF] && s.inputs.press;
    s.w.clears[1] = s.m.x[ON] && s.m.clock - s.m.stamp[ON] >= 2_000_000_000 && !s.inputs.press;
    s.changed = s.w.clears[0] || s.w.clears[1];
    for i in 0..STEPS {
        if s.w.clears[i] {
            s.m.x[i] = false;
            s.m.x[1 - i] = true;
            s.m.stamp[i] = 0;
            s.m.stamp[1 - i] = s.m.clock;
        }
    }
}

pub fn sections_behind(s: &mut State) {
    s.outputs.lamp = s.m.x[ON];
}

pub fn to_safety(s: &mut State) {
    s.outputs = Outputs::default();
}
