//! The evolution of a chart: one call to [`scan`] takes the state, a frozen
//! picture of the inputs and the time, and leaves the next state with its outputs.
//!
//! # Where this sits
//!
//! ```text
//! syntax -> model -> compile -> Program -> engine::scan -> host | wasm | verify
//!                                   \----> codegen: tested against scan
//! ```
//!
//! This is the only place that knows what a chart *does*. A question such as
//! "which transition wins?" is answered here or nowhere.
//!
//! # Invariants
//!
//! - A [`Program`] is checked once, in [`Program::new`]. After that a scan ends
//!   within its bound, or returns a [`Fault`].
//! - A scan allocates nothing, reads no clock and never panics.
//! - Equal program, state, inputs and time give an equal result on every machine.
//! - The work of a scan follows the enabled transitions, the running timers, the
//!   active steps' actions and what changed, not the size of the program.
//! - No profile is named here: they differ in [`Rules`] and in how `compile`
//!   fills the [`Tables`].
//!
//! # Reading order
//!
//! [`scan`] (`scan.rs`), then one pass (`pass.rs`), then what a change of steps
//! carries with it (`change.rs`), edges and timers (`watch.rs`), control blocks
//! (`blocks.rs`). Code runs in `run.rs`; `check.rs` proves the tables.
//!
//! Not here: names, places, drawings (`model`), real inputs and clocks (`host`).
#![no_std]
#![forbid(unsafe_code)]
#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

extern crate alloc;

mod bare;
mod bits;
mod blocks;
mod carry;
mod change;
mod check;
mod fault;
mod fb;
mod judge;
mod number;
mod ops;
mod pass;
mod program;
mod run;
mod scan;
mod state;
mod text;
mod watch;

pub use carry::{Common, carry};
pub use fault::{Fault, FaultKind};
pub use judge::enabled;
pub use ops::{Addr, Arith, Block, Builtin, Cmp, Code, GroupId, Num, Op, Service, StepId, WatchId};
pub use program::{
    Action, Chart, Contribution, ControlBlock, Event, Extra, Group, Guard, INPUTS, Limits, LoadError, NONE,
    Order, Program, Rows, Rules, Situation, Step, Tables, Transition, Watch,
};
pub use scan::{Report, begin, eval, finish, pass, scan, set_step};
pub use state::State;
pub use text::{Duration, TEXT};

pub(crate) use run::clock;

/// Words of stack that code may use.
pub const STACK: usize = 64;

/// Jumps that the code of one scan may make before it counts as endless.
pub const WORK: u32 = 1_000_000;
