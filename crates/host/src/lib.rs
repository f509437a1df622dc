//! The loop round `engine::scan`: it decides when a scan is made and with which inputs, passes the
//! outputs on, and records the run.
//!
//! # Where this sits
//!
//! ```text
//!           Clock -> Runner -> engine::scan -> outputs -> devices | plant
//!                      |  ^-------- inputs <-------------- devices | plant
//!                      +-> Recording -> CSV, VCD, chronogram
//!                      +-> Tape -> replay          Retained <-> file
//! ```
//!
//! Simulation and on-line operation use the same loop with different parts: a virtual clock and a
//! plant (a second program), or the wall clock and devices (the crate `online`).
//!
//! # Invariants
//!
//! The engine gets the time as a number; only [`WallClock`] reads a clock.
//! With a virtual clock, the same program, plant, seed and inputs give the same states, byte for
//! byte (`replay` compares them).
//! After a fault the outputs have their safe values, and no scan follows until a restart.
//! - A file is written whole or not at all ([`write_whole`]).
//!
//! This crate knows no names of variables or charts and no places in the text: the caller names the
//! signals.
#![forbid(unsafe_code)]

mod chunks;
mod clock;
mod date;
mod hash;
mod record;
mod retain;
mod runner;
mod tape;
mod text;
mod whole;

pub use clock::{Clock, VirtualClock, WallClock, utc_millis};
pub use date::{utc_day, utc_of, utc_text};
pub use hash::Fnv;
pub use record::chronogram::{Chronogram, Lane, Style};
pub use record::csv::{csv_cell, csv_quote, write_csv};
pub use record::vcd::write_vcd;
pub use record::{Kind, Recording, Sample, Signal, Value};
pub use retain::{Layout, RetainError, Retained};
pub use runner::{Coupling, Force, Halt, Runner, Start};
pub use tape::{Divergence, Player, Tape, TapeError};
pub use text::{read_text, write_text};
pub use whole::{write_private, write_whole};
