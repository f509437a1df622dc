//! The evolution of one chart. Each sample compiles it over its own `chart` module;
//! `codegen` prints it in C and Rust behind the facts and tables of a chart.
//!
//! # Forms that may stand here
//!
//! Only forms that C99 and Rust have in common, or the build of `codegen` fails: functions over
//! [`State`], `let` with a type, `if`, `while`, `for` over a range, no `match`, no
//! iterators, no references but to structures and arrays that are passed on. A
//! comment on a line of its own is printed. What callers of the printed code may use
//! is `pub`, all else `pub(crate)`.
#![allow(clippy::needless_range_loop, reason = "it is printed as C, which has no iterators")]
#![allow(clippy::unnecessary_cast, reason = "a `Tick` of printed code may have 32 bits")]
#![allow(clippy::implicit_saturating_sub, reason = "it is printed as C, which has no saturating_sub")]

mod changes;
mod clearing;
mod closing;
mod control_blocks;
#[path = "../cycle.rs"]
mod cycle;
mod enclosing;
mod forcing;
mod memory;
mod scan;
mod services;
mod turns;
mod watches;

pub(crate) use changes::*;
pub(crate) use clearing::*;
pub(crate) use closing::*;
pub(crate) use control_blocks::*;
pub use cycle::*;
pub(crate) use enclosing::*;
pub(crate) use forcing::*;
pub use memory::*;
pub(crate) use scan::*;
pub(crate) use services::*;
pub(crate) use turns::*;
pub(crate) use watches::*;

use super::chart::*;
use crate::faults::*;
use crate::numbers::{has_turned, inv, is_due_after, low_bit, since, ticks_gone, ticks_held, ticks_since};
