//! A run of a chart on the bench, in virtual time, shown by the page.
//!
//! ```text
//! wish -> start -> Run (rig::Bench, host::Runner, Recording) -> frame: what changed
//!         repeat: the scans of a proof
//!                   \-> past: back in time    lanes: chronogram    swap: on-line change
//!                         \-> tape -> why: why something happened in it
//! ```
//!
//! Time advances only by messages; a frame contains only what differs from the previous frame;
//! every scan is recorded.

mod frame;
mod lanes;
mod past;
mod places;
mod repeat;
mod running;
mod scans;
mod sent;
mod start;
mod swap;
mod times;
mod why;
mod wish;

pub(crate) use frame::Frame;
pub use frame::show;
pub(crate) use lanes::{Form, Lanes};
pub use places::Places;
pub(crate) use running::Run;
pub(crate) use scans::Scan;
pub use sent::Show;
pub(crate) use start::{Started, start};
pub(crate) use swap::Swapped;
pub(crate) use why::{Asked, Because, WhyLine, lines, why};
pub(crate) use wish::{Start, profile};
