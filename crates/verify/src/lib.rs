//! Questions about all runs of a chart.
//!
//! # Where this sits
//!
//! ```text
//! model::Document -> ask -> Question, Model -> answer: Layer (search, zones, sat) -> Verdict -> words -> g7 prove
//! rig::Source (with a plant) -> closed -> Question, Model (the same way)
//!                           two charts      -> compare                    -> Equality -> g7 compare
//!                           Run             -> blame: the steps and transitions that take part
//! ```
//!
//! `model.rs` has the meaning of a run, `question.rs` that of a claim, `verdict.rs` the
//! answers, `reason.rs` why there is none. `search.rs` visits all states with `engine::scan`; `asked.rs` tells
//! it which inputs matter in a state, `values.rs` which values of them. `zones` visits sets of states that
//! differ in times alone; `slices.rs` tells both which part of the chart a question depends on, and `faults.rs` asks them
//! about faults place by place. `system` is the chart as a system of bits, about which `sat` asks a solver.
//! `answer.rs` has them work in turns. [`Explorer::search`] is a search by moves that its caller chooses, for
//! tests and tools.
//!
//! # Invariants
//!
//! - A state is compared as a whole, by its canonical image. A hash only finds the
//!   place of an image, so two states are never taken for one.
//! - The order of a search depends on the program, the moves and the bounds alone.
//! - A verdict about all runs is given only where all states were visited and every
//!   move that matters was tried.
//! - A run is given only after `engine::scan` has repeated it from the start.
//! - No clock: the caller's [`Budget::stop`] ends a search.
//!
//! Not here: names and problems (`compile`, `model`), the evolution itself (`engine`).
#![forbid(unsafe_code)]

mod answer;
mod ask;
mod asked;
mod blame;
mod closed;
mod compare;
mod cover;
mod cubes;
mod divide;
mod expand;
mod explicit;
mod explore;
mod export;
mod faults;
mod inputs;
mod layer;
mod look;
mod model;
mod monitor;
mod outcome;
mod parts;
mod question;
mod reason;
mod rows;
pub mod sat;
mod scene;
mod search;
mod sites;
mod situations;
mod slice;
mod slices;
mod store;
mod system;
mod tries;
mod values;
mod verdict;
mod visit;
pub mod words;
mod world;
mod zones;

pub use answer::{answer, attempt, solve};
pub use ask::{Asked, ask};
pub use blame::{Blame, blame};
pub use closed::{Closed, ask_with};
pub use compare::{
    Compare, Difference, Equality, Unlike, compare, compare_by_search, compare_by_solver, compare_once, miter,
};
pub use cover::{From, Reached, reach, stuck};
pub use cubes::Cube;
pub use expand::{Expanded, Expander, Gap, Here, Shown, Step};
pub use explicit::Explicit;
pub use explore::{Answer, Bound, Explorer, Limits, Moment, Move, Moves, Next};
pub use export::{Exported, Row, exported};
pub use inputs::{Inputs, Which};
pub use layer::{Budget, Layer};
pub use look::{replay, seen, unclear};
pub use model::{Model, Part};
pub use outcome::{Outcome, asks_for_traps};
pub use question::{Claim, Query, Question};
pub use reason::{Part as Unfollowed, Reason};
pub use sat::{Satisfiability, Tries};
pub use scene::Tried;
pub use search::watch;
pub use situations::{Edge, Graph, Kind, Node, situations};
pub use store::Store;
pub use values::{Values, values};
pub use verdict::{Certificate, Evidence, Open, Run, Verdict, is_open};
#[cfg(not(target_family = "wasm"))]
pub use visit::{Sets, visit_sets};
pub use visit::{Visited, visit, visit_bits};
pub use zones::Zones;
