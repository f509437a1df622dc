//! Charts on the test bench: a source, what it compiles to, its plant and names
//! for everything; tests that run on it.
//!
//! # Where this sits
//!
//! ```text
//! bytes -> Source -> build -> Bench -> host::Runner -> g7 (terminal), page (browser, server)
//!                                |
//!                    model::Scenario -> testing -> Outcome, Coverage
//! ```
//!
//! What must hold: nothing here knows of files, arguments, screens or the time
//! of day; a clock, where one is wanted, is given.
#![forbid(unsafe_code)]

mod bench;
mod carry;
mod error;
mod source;
pub mod testing;
pub mod values;

pub use bench::{
    Activity, Answer, Ask, Bench, Conflicts, Item, Options, PlantSide, Role, StepItem, Table, build,
};
pub use carry::{Carried, carry};
pub use error::Error;
pub use source::Source;
