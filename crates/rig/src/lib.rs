//! Charts on the test bench: a source, its compiled charts, its plant, names for everything, and
//! tests that run on them.
//!
//! # Where this sits
//!
//! ```text
//! bytes -> Source -> build -> Bench -> host::Runner -> g7 (terminal), page (browser, server)
//!                                |
//!                    model::Scenario -> testing -> Outcome, Coverage
//! ```
//!
//! This crate accesses no files, no screen and no clock: the caller hands a clock in if one is
//! needed.
#![forbid(unsafe_code)]

mod asked;
mod bench;
mod carry;
mod error;
mod faults;
mod links;
mod source;
pub mod testing;
pub mod values;

pub use asked::question;
pub use bench::build::build;
pub use bench::{Activity, Answer, Ask, Bench, Conflicts, Item, Options, PlantSide, Role, StepItem, Table};
pub use carry::{Carried, carry};
pub use error::Error;
pub use faults::fault;
pub use g7_library::{PARTS as LIBRARY, Part};
pub use links::{Reader, named, resolved};
pub use source::{Other, Source};
