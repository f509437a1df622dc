//! The controller of a machine: charts with real inputs and outputs (decision 28).
//!
//! # Where this sits
//!
//! ```text
//!   devices -> Exchange -> scan thread: engine::scan -> Exchange -> devices
//!                             |     ^
//!                       records     commands         Slots (retained values) <- a thread of its own
//!                             |
//!                           Sight: all of its words, for the page
//!                           Notes: each change of chosen signals, for the history
//! ```
//!
//! # Invariants
//!
//! The scan thread neither allocates nor locks nor waits for anything but its next instant.
//! It gives and takes words of fixed number, nothing else.
#![forbid(unsafe_code)]

mod change;
mod changer;
mod chosen;
mod clients;
mod controller;
mod device;
mod disk;
mod driver;
mod exchange;
mod forces;
mod forms;
#[cfg(all(feature = "gpio", target_os = "linux"))]
mod gpio;
mod handles;
mod keep;
mod link;
mod machine;
mod mail;
mod messages;
mod mirror;
mod modbus;
mod mqtt;
mod names;
mod nodes;
mod notes;
mod pace;
mod panel;
mod part;
mod parts;
mod points;
mod probe;
mod realtime;
mod renamed;
mod runtime;
#[cfg(feature = "s7")]
mod s7;
mod saver;
pub mod setup;
mod sight;
mod slots;
mod subject;
mod tls;
mod value;
mod wire;
mod wired;
mod wiring;
mod word;

pub use change::{Chart, Prepared, prepare};
pub use changer::{Change, Changer};
pub use chosen::{Chosen, Recorded};
pub use clients::{Brought, Clients, Node, has, lacking};
pub use controller::{Command, Controller, Event, Mode, Port, Reason, Refused, Shared, What};
pub use device::{Absent, Device, Failed, Remark};
pub use disk::RealDisk;
pub use driver::{Driver, Happened, Out, Quality, Worked};
pub use exchange::{Reader, Writer, exchange};
pub use forces::{FORCES, Forced, LONGEST, USUAL};
pub use keep::{Keep, KeepError, KeptFile, Started, open};
pub use link::{Link, Order};
pub use machine::{Machine, assemble, runner};
pub use mail::{Letter, Mail};
pub use mirror::mirror;
pub use notes::{Note, Notes, Table};
pub use pace::{Pace, Paces, Spread};
pub use panel::{Moved, Panels};
pub use part::Part;
pub use parts::{Handles, Picture, Successor};
pub use probe::{Asked, Probed, ask, hear, probe};
pub use renamed::renamed;
pub use runtime::{Answer, AtDevice, Options, Running, start};
pub use saver::Saver;
pub use sight::Sight;
pub use slots::{Disk, Loaded, Slots, SlotsError};
pub use value::{Holds, Raw, Scaling};
pub use wire::{About, Cell, Folder, Form, Line, Shown, Topic, Wire, Worth};
pub use wired::{In, OutAt, WhileBad, Wired, Wiring};
pub use wiring::wire;
pub use word::{Source, Target};
