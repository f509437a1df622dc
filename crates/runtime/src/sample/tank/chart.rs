//! ```text
//! input start, full;  output valve
//! initial step Idle;  step Fill { N valve }
//! Idle -> Fill when start;  Fill -> Idle when full
//! ```

pub use crate::chart::*;

use super::evolution::{State, mark_on};

pub(crate) use crate::chart::{Row, Tick};

pub const IDLE: usize = 0;
pub const FILL: usize = 1;

pub const STABLE: bool = true;
pub const ONE_TO_ONE: bool = true;
pub const BARE: bool = true;
pub const ONE_WORD: bool = true;
pub const HAS_OUTS: bool = true;
pub const HAS_FOLLOWERS: bool = true;
pub const STEPS: usize = 2;
pub const TIMED: usize = 2;
pub const TRANSITIONS: usize = 2;
pub const FIRED: usize = 2;
pub const MARKED_ON: usize = 2;
pub const MARKED_OFF: usize = 2;
pub const ENTERED: usize = 5;
pub const BOUND: u32 = 1000;

pub static FROM: [u8; 2] = [IDLE as u8, FILL as u8];
pub static FROM_AT: [u8; 3] = [0, 1, 2];
pub static TO: [u8; 2] = [FILL as u8, IDLE as u8];
pub static TO_AT: [u8; 3] = [0, 1, 2];
pub static OUT: [u8; 2] = [0, 1];
pub static OUT_AT: [u8; 3] = [0, 1, 2];

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inputs {
    pub start: bool,
    pub full: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outputs {
    pub valve: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Variables {}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Locals {}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Next {}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrote {}

pub fn start(s: &mut State) {
    mark_on(s, IDLE);
}

pub fn receptivity(s: &mut State, transition: usize) -> bool {
    match transition {
        0 => s.inputs.start,
        1 => s.inputs.full,
        _ => false,
    }
}

pub fn follow(s: &mut State, _word: usize) {
    s.outputs.valve = s.m.x[FILL];
}

pub fn to_safety(s: &mut State) {
    s.outputs = Outputs::default();
}
