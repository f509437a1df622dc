//! The loop round `engine::scan`: when it is called, with which inputs, where
//! the outputs go, and what is kept of it.
//!
//! # Where this sits
//!
//! ```text
//!           Clock -> Runner -> engine::scan -> outputs -> Io | plant
//!                      |  ^-------- inputs <-------------- Io | plant
//!                      +-> Recording -> CSV, VCD, chronogram
//!                      +-> Tape -> replay          Retained <-> file
//! ```
//!
//! Simulation and on-line running are two sets of plugs of one loop: a virtual
//! clock and a plant (a second program), or a wall clock and an [`Io`].
//!
//! # Invariants
//!
//! - Time goes to the engine as a number; only [`WallClock`] reads a clock.
//! - With a virtual clock, the same program, plant, seed and inputs give the
//!   same states, byte for byte (`replay` compares them).
//! - After a fault the outputs have their safe values and no scan follows
//!   until a restart.
//! - A file is written whole or not at all ([`write_whole`]).
//!
//! Names, paths of charts and spans are not known here: signals carry the names
//! that the caller gave them.
#![forbid(unsafe_code)]

mod clock;
mod io;
mod record;
mod retain;
mod runner;
mod tape;
mod text;

pub use clock::{Clock, VirtualClock, WallClock};
pub use io::{Channels, Io, IoError};
pub use record::chronogram::{Chronogram, Lane, Style};
pub use record::csv::write_csv;
pub use record::vcd::write_vcd;
pub use record::{Kind, Recording, Signal, Value, format_seconds, format_time};
pub use retain::{Layout, RetainError, Retained, write_whole};
pub use runner::{Coupling, Force, Halt, Runner, Served, Start, serve};
pub use tape::{Divergence, Tape};
pub use text::{read_text, write_text};
