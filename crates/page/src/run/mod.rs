//! A run of a chart on the bench, in virtual time, shown by the page.
//!
//! ```text
//! wish -> start -> Run (rig::Bench, host::Runner, Recording) -> frame: what changed
//!                   \-> past: back in time    lanes: chronogram    swap: on-line change
//! ```
//!
//! Time advances only by messages; a frame contains only what differs from the previous frame;
//! every scan is recorded.

mod frame;
mod lanes;
mod past;
mod places;
mod running;
mod sent;
mod start;
mod swap;
mod times;
mod wish;

pub use frame::show;
pub(crate) use lanes::Form;
pub use places::Places;
pub(crate) use running::Run;
pub use sent::Show;
pub(crate) use start::start;
pub(crate) use wish::Start;
