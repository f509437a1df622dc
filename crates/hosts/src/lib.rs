//! The search over states, shared among processes on one machine or several.
//!
//! # Where this sits
//!
//! ```text
//! verify::{Model, Question} -> run -> search: worker (shelf: own states) <-> exchange -> trace -> verify::Verdict
//!                               |        |                                   |- wire: timely over TCP
//!                             meet     levels: each level on disk            |- near: within a process (tests)
//! ```
//!
//! Each process runs the same code. A state belongs to the process that its own bits name; that process keeps its
//! exact image and expands it. `worker.rs` searches one level, which ends for all together; `levels.rs`
//! keeps it on disk; `traps.rs` and `trace.rs` look at the whole when it has ended.
//!
//! # Invariants
//!
//! - The answers, the runs and the numbers of states and scans are those of one thread, whatever the number
//!   of processes. Each state has the rank that one thread would give it; findings are ordered by it.
//! - A decision about how to go on is made by all processes at the end of a phase, from the same words.
//! - What other processes send is data: wrong words are a lost process, never a panic.
//! - A process that is killed costs the level in hand.
//!
//! Not here: what a scan does and shows (`verify`, `engine`), the command line (`g7`).
#![forbid(unsafe_code)]

mod calm;
mod exchange;
mod hosts;
mod known;
mod levels;
mod meet;
mod near;
mod pack;
mod run;
mod search;
mod shelf;
mod task;
mod trace;
mod traps;
mod wire;
mod words;
mod worker;

pub use exchange::Exchange;
pub use hosts::parse;
pub use meet::Work;
pub use near::Near;
pub use run::{Place, answer, answer_over};

/// Why a process could not take part in a search.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// Something that the user can correct: a line of the file of hosts, a port in use, other work.
    #[error("{0}")]
    Usage(String),
    /// The disk refuses.
    #[error("{0}")]
    Disk(String),
    /// Other processes did not come before the search was to end.
    #[error("{0}")]
    Alone(String),
    /// A process was lost.
    #[error("a process of the search was lost")]
    Lost,
}
