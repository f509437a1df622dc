//! The forms of makers: the equations as Structured Text in the words and the files of one programming system.
//!
//! Each is the printer of Structured Text ([`super::st`]) behind a few rules of rewriting and inside the frame
//! that the system reads. Nothing of the chart is translated here.

mod logix;
mod rewrite;
mod scl;
mod twincat;
mod unity;

pub(super) use logix::print as logix;
pub(super) use scl::print as scl;
pub(super) use twincat::print as twincat;
pub(super) use unity::print as unity;
