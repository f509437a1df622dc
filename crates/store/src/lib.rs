//! The files of SQLite that a controller writes beside its io file.
//!
//! # Where this sits
//!
//! ```text
//! attendant, page -> threads of their own -> store -> files
//! ```
//!
//! # Invariants
//!
//! Nothing here is called by the scan thread: a write waits for the disk.
//! A row that a call has returned as written survives a loss of power, unless its module says otherwise.
//! A full disk is an error of the call; the same process goes on as soon as there is room again.
#![forbid(unsafe_code)]

mod file;
pub mod history;
pub mod log;
mod outbox;
pub mod users;

pub use file::{Durable, StoreError, open, read};
pub use outbox::{Limits, Outbox, Waiting};
