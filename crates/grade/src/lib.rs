//! Exercises, and the charts that students hand in.
//!
//! # Where this sits
//!
//! ```text
//! files of a folder -> Exercise (template, model solution, wrong solutions, texts)
//!                          |
//! bytes of a student -> Source -> judge -> Graded -> g7 grade (table, CSV, JSON, HTML)
//!                                            |
//!                          Shape: the chart without its names -> groups that are alike
//! ```
//!
//! # What must hold
//!
//! - A submission brings charts. Plants, tests and properties are those of the exercise, whatever the submission says.
//! - Nothing here opens a file or reads a clock: the caller has both.
//! - A submission is graded by itself: nothing of another one is known.
//!
//! The form of an exercise is decision 78.
#![forbid(unsafe_code)]

mod check;
mod exercise;
mod judge;
mod locked;
mod needs;
mod sealed;
mod shape;
mod texts;

pub use check::check;
pub use exercise::{Exercise, Fault, MODEL, TEMPLATE, WRONG};
pub use judge::{Answered, Ended, Graded, Limits, Mark, Stop, Tested, judge};
pub use locked::Changed;
pub use needs::Lack;
pub use shape::{Shape, groups};
pub use texts::{Files, Texts};
