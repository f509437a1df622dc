//! The history of a controller: recorded while it runs, listed and exported.
//!
//! # Where this sits
//!
//! ```text
//! online::Notes -> Historian, a thread of its own -> store::history::Writer -> file
//!                                                                               |
//!                         g7 history, serve::history <- rows <- store::history::Reader
//! ```
//!
//! # Invariants
//!
//! Neither the scan nor the attendant waits for the file.

mod command;
mod historian;
#[cfg(feature = "parquet")]
mod parquet;
mod rows;
pub(crate) mod time;

#[cfg(feature = "parquet")]
pub(crate) use self::parquet::Parquet;
pub(crate) use command::{History, history};
pub(crate) use historian::{Historian, Kept, open};
pub(crate) use rows::{Broken, Csv, Sink, rows};
