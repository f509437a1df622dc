//! All states of a model, counted: for measurements, and to know how large a chart is.

use crate::layer::Budget;
use crate::model::Model;
#[cfg(not(target_family = "wasm"))]
use crate::sat::diagram::{Effort, diagram};
use crate::sat::{Tries, Wanted, wide};
use crate::scene::{Tried, Until};
use crate::search::Search;
use crate::system::{Observed, system};
use crate::verdict::Open;

/// The extent of a search over all states.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Visited {
    /// Number of states, the one before the first scan included.
    pub states: usize,
    /// Scans made.
    pub scans: usize,
    /// Fewest scans that lead to the state that is farthest away.
    pub depth: usize,
    /// Bytes in which the states are kept and found.
    pub bytes: usize,
    /// Bytes for the runs that lead to them: the state before each, and the inputs.
    pub runs: usize,
    /// Why not all states were visited.
    pub open: Option<Open>,
}

/// Visits all states.
pub fn visit(model: &Model<'_>, budget: &Budget<'_>, tried: Tried) -> Visited {
    let mut search = Search::new(model, budget, Vec::new());
    search.until = Until::Visited;
    search.tried = tried;
    search.search();
    let (bytes, runs) = search.kept();
    let seen = search.seen();
    Visited { states: seen.states, scans: seen.scans, depth: search.last(), bytes, runs, open: seen.open }
}

/// Visits all states of the chart's system of bits, by so many threads. Nothing where the system cannot be
/// searched so. The number of scans that lead to the farthest state is counted as [`visit`] does.
pub fn visit_bits(model: &Model<'_>, budget: &Budget<'_>, tries: Tries, threads: usize) -> Option<Visited> {
    let translated = system(model, &[], Observed::Asked);
    let wanted = Wanted { all: true, tries, ..Wanted::of(&[], &translated.passes, threads) };
    let seen = wide(&translated.system, &wanted, budget)?;
    let open = seen.open.map(|reason| Open { scans: seen.depth, states: seen.states, reason });
    let [bytes, runs] = seen.bytes;
    Some(Visited { states: seen.states, scans: seen.scans, depth: seen.depth, bytes, runs, open })
}

/// All states of the chart's system of bits, made as sets.
#[cfg(not(target_family = "wasm"))]
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sets {
    /// Number of states, the one before the first scan included; nothing where it has more than 128 bits.
    pub states: Option<u128>,
    /// Fewest scans that lead to the state that is farthest away, and one more.
    pub depth: usize,
    /// No state is left out.
    pub is_whole: bool,
}

/// Makes the set of all states of the chart's system of bits, with diagrams of at most so many nodes. Nothing where
/// the system cannot be searched so, or needs more nodes.
#[cfg(not(target_family = "wasm"))]
pub fn visit_sets(model: &Model<'_>, budget: &Budget<'_>, tries: Tries, nodes: usize) -> Option<Sets> {
    let t = system(model, &[], Observed::Asked);
    let wanted = Wanted { all: true, tries, ..Wanted::of(&[], &t.passes, 1) };
    let seen = diagram(&t.system, &wanted, &t.candidates, Effort { nodes, ticks: 0 }, budget)?;
    Some(Sets { states: seen.states, depth: seen.depth, is_whole: seen.is_whole })
}
