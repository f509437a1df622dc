//! The first run that reaches each of several elements, found by one search over all states.
//!
//! Which elements there are and when a scan reaches one is the caller's matter: it is shown the
//! state behind each scan that no fault stopped. And the run behind which nothing goes on, since
//! no input satisfies the assumptions.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};

use g7_engine::State;

use crate::explore::Move;
use crate::layer::Budget;
use crate::model::Model;
use crate::scene::{Scene, Until};
use crate::search::Search;
use crate::verdict::{Open, Run};

/// The runs that reach elements.
#[derive(Clone, Debug, Default)]
pub struct Reached {
    /// For each element that was reached, by its number: a run with as few scans as any.
    pub runs: BTreeMap<usize, Run>,
    /// Why not all runs were seen, where elements are left over.
    pub open: Option<Open>,
}

/// Where a search for elements begins.
#[derive(Clone, Copy, Debug)]
pub enum From<'m> {
    /// Before the first scan, which takes place with any inputs.
    Start,
    /// The same, but the first scan takes place with the initial values of the inputs, as that of a
    /// test does.
    Rest,
    /// Behind these scans, which no fault stops. The runs that are found go on from there.
    Behind(&'m [Move]),
}

/// Searches until `count` elements are reached. `see` gives the numbers of the elements that a
/// scan reached.
pub fn reach(
    model: &Model<'_>,
    budget: &Budget<'_>,
    from: From<'_>,
    count: usize,
    see: &mut dyn FnMut(&mut State) -> Vec<usize>,
) -> Reached {
    let (found, all) = (RefCell::new(BTreeMap::new()), AtomicBool::new(count == 0));
    let stop = || all.load(Ordering::Relaxed) || (budget.stop)();
    let budget = Budget { stop: &stop, ..*budget };
    let mut look = |scene: Scene<'_>| {
        if scene.fault.is_some() {
            return;
        }
        let mut found = found.borrow_mut();
        for element in see(scene.state) {
            found.entry(element).or_insert_with(|| (scene.from, scene.m.clone()));
        }
        all.store(found.len() >= count, Ordering::Relaxed);
    };
    let mut search = Search::new(model, &budget, Vec::new());
    search.rest = matches!(from, From::Rest);
    search.start = if let From::Behind(moves) = from { moves } else { &[] };
    search.until = Until::Visited;
    search.look = Some(&mut look);
    search.search();
    let run = |(from, m): &(usize, Move)| {
        let mut run = search.path(*from);
        run.moves.push(m.clone());
        run
    };
    let found = found.borrow();
    let runs: BTreeMap<usize, Run> = found.iter().map(|(element, end)| (*element, run(end))).collect();
    let open = search.seen().open.filter(|_| runs.len() < count);
    Reached { runs, open }
}

/// A run behind which no input satisfies the assumptions, with as few scans as any; one of no
/// scans if none does at the start. `None` also where the budget ends the search before.
pub fn stuck(model: &Model<'_>, budget: &Budget<'_>) -> Option<Run> {
    let mut search = Search::new(model, budget, Vec::new());
    search.until = Until::Stuck;
    search.search();
    search.stuck.map(|at| search.path(at))
}
