//! The evolution of a chart: one call to [`scan`] takes a state, the inputs and the
//! time, and leaves the next state with its outputs.
//!
//! # Where this sits
//!
//! ```text
//! syntax -> model -> compile -> Program -> engine::scan -> host | page | verify
//! ```
//!
//! Whoever runs a chart runs it here. `begin`, `pass` and `finish` are the parts of a
//! scan; there is no other way to evolve a state.
//!
//! # Invariants
//!
//! - A [`Program`] is checked once, in [`Program::new`]. After that a scan ends
//!   within its bound, or returns a [`Fault`].
//! - A scan allocates nothing, reads no clock and never panics.
//! - Equal program, state, inputs and time give an equal result on every machine.
//! - The work of a scan follows the enabled transitions, the running timers, the
//!   active steps' actions and what changed, not the size of the program.
//! - No code here looks at a profile: each is a row of [`Rules`], and differs from the
//!   others in these switches and in how `compile` fills the [`Tables`].
//! - Words and public times are `i64` nanoseconds, unless a comment says scans. In
//!   tables [`NONE`] stands for absence; public functions return an `Option`.
//!
//! # Reading order
//!
//! [`scan`] (`scan.rs`), then one pass (`pass.rs`), then the consequences of a change
//! of steps (`change.rs`), edges and timers (`watch.rs`), control blocks (`blocks.rs`).
//! Code runs in `run.rs`, its instructions joined in `joined.rs`, what is Boolean in `decision.rs`.
//! `tables.rs` has the data and `check.rs` checks it;
//! `canonical.rs`, `times.rs` and `reads.rs` are for those who search.
//!
//! Not here: names, places, drawings (`model`), real inputs and clocks (`host`).
#![no_std]
#![forbid(unsafe_code)]
#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

extern crate alloc;

mod bits;
mod block_rows;
mod block_words;
mod blocks;
mod canonical;
mod carry;
mod change;
mod check;
mod clocks;
mod counts;
mod decision;
mod enabled;
mod fault;
mod fb;
mod fingerprint;
mod gates;
mod given;
mod joined;
mod layout;
mod memory;
mod moves;
pub mod number;
mod ops;
mod pass;
mod program;
mod reached;
mod reads;
mod rows;
mod rules;
mod run;
mod scan;
mod scratch;
mod sleepers;
mod stack;
mod state;
mod tables;
pub mod text;
mod times;
mod watch;

pub use canonical::ImageError;
pub use carry::{Common, carry};
pub use check::LoadError;
pub use enabled::{enabled, judged};
pub use fault::{Fault, FaultKind};
pub use ops::{
    Addr, Arith, Block, Builtin, Cmp, Code, GroupId, Num, Op, STACK, Service, StepId, TEXT, WORK, WatchId,
};
pub use program::Program;
pub use reads::{Reads, Subject};
pub use rules::Rules;
pub use scan::{Report, begin, eval, finish, pass, scan, set_step};
pub use state::State;
pub use tables::{
    Action, Chart, Contribution, ControlBlock, Event, Extra, Group, INPUTS, Limits, NONE, Order, Receptivity,
    Rows, Situation, Step, Tables, Transition, Watch,
};
pub use text::Duration;
pub use times::{Elapsed, Time};
