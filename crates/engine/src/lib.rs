//! The evolution of a chart.
#![no_std]
#![forbid(unsafe_code)]

extern crate alloc;

mod ops;
mod program;

pub use ops::{Addr, Arith, Block, Builtin, Cmp, Code, GroupId, Num, Op, Service, StepId, WatchId};
pub use program::{
    Action, Chart, Contribution, ControlBlock, Event, Extra, Group, Guard, INPUTS, Limits, LoadError, NONE,
    Order, Program, Rows, Rules, Situation, Step, Tables, Transition, Watch,
};
/// Words of stack that code may use.
pub const STACK: usize = 64;
mod state {
    #[derive(Clone, Debug)]
    pub(crate) struct Layout;
}
