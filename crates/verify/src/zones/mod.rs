//! The search for charts with times: sets of states instead of states, so that waiting costs nothing.
//!
//! ```text
//! Model -> clocks (which words are times, and their bounds) -> search: Graph of sets of states
//!          sights (one scan of one state of a set)           -> search/traps (deadlock, leads to) -> Verdict
//! ```
//!
//! It sees the same runs as `search.rs`. A node is a shape of an image with a zone (`matrix.rs`): the
//! values that the clocks of the shape may have, in scans of the period. Every vector of the zone is a
//! state that some run reaches; a state that a run reaches belongs to some node.
//!
//! A move of a node: all its clocks go on by one scan; the zone is divided where a bound of a clock lies, so
//! that within a part no comparison tells one state from another; one state of the part makes its scan
//! with `engine::scan`; the image behind it tells which clocks have begun anew, stopped or gone on.
//! Where the shape stays and all clocks go on, the same scan can be made again until a clock meets its next
//! bound: all those states become one node.
//!
//! # Invariants
//!
//! - A clock that runs stands in the zone as long as a bound is before it, so zones are bounded, and there are
//!   finitely many.
//! - Least and greatest values of a part must give the same scan. Where they do not, nothing is
//!   proved.
//! - A run is given only after `engine::scan` has repeated it from the start.

mod clocks;
mod graph;
mod matrix;
mod search;
mod sights;
#[cfg(test)]
pub(crate) mod tests;
mod turns;

use crate::layer::{Budget, Layer, undecided};
use crate::model::Model;
use crate::monitor::has_memory;
use crate::question::Question;
use crate::verdict::Verdict;
use search::Search;

/// The search by zones as a layer. It leaves charts without times, and those with a plant, to others.
#[derive(Clone, Copy, Debug, Default)]
pub struct Zones;

impl Layer for Zones {
    fn name(&self) -> &'static str {
        "zones"
    }

    fn answer(
        &self,
        model: &Model<'_>,
        questions: &[Question],
        answers: &mut [Option<Verdict>],
        budget: &Budget<'_>,
    ) {
        if model.plant.is_some() {
            return;
        }
        let rows = undecided(questions, answers).into_iter();
        let (alone, together): (Vec<_>, Vec<_>) = rows.partition(|(_, q)| has_memory(&q.claim));
        let groups = std::iter::once(together).chain(alone.into_iter().map(|q| vec![q]));
        let searches = groups.filter(|g| !g.is_empty()).filter_map(|g| Search::new(model, budget, g));
        let found: Vec<(usize, Verdict)> = searches.flat_map(Search::run).collect();
        for (i, verdict) in found {
            // Another layer may know more of an open question than a number of zones.
            if let Some(answer) = answers.get_mut(i)
                && (answer.is_none() || !matches!(verdict, Verdict::Open(_)))
            {
                *answer = Some(verdict);
            }
        }
    }
}
