//! The deeds of persons at a running controller, and their view of it.
//!
//! # Where this sits
//!
//! ```text
//! lines of the standard input -> Wish -\
//!                                       Attendant <-> online::Running
//! page -> serve::live -> Order -> Stage-/    |
//!      <- Outbox <- frames <- Stage <- Board <- Sight, events
//!
//! press, set: Attendant -> online::Panels -> the device of the panel
//! change, back: Attendant -> Changes -> online::Changer, on a thread of its own -> Names, Sight anew
//! ```
//!
//! # Invariants
//!
//! All of it runs on the thread of the attendant; the scan thread knows nothing of it. A client that does
//! not read holds up nobody: frames go to bounded outboxes.

mod board;
mod changes;
mod names;
mod order;
mod panel;
mod part;
mod picture;
mod stage;
#[cfg(test)]
mod tests;
mod told;

pub(crate) use changes::{Adopted, Changes};
pub(crate) use names::Names;
pub(crate) use order::{HELP, NAME, Order, Wish};
pub(crate) use panel::operate;
pub(crate) use stage::{Asker, Stage};
pub(crate) use told::{Told, mode_text};
