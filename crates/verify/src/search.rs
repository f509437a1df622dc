//! The explicit search: all states of a chart, breadth first, with all that each question
//! looks for.
//!
//! A state is its canonical image with one word more: what a claim remembers (`monitor.rs`).
//! Questions that remember nothing share one search, each other has its own. Numbers of
//! states follow the order in which they were found, so the first run that shows
//! something is a shortest one.

mod answers;

use g7_engine::State;

use crate::expand::{Expanded, Expander, Here, Step};
use crate::explore::Move;
use crate::layer::Budget;
use crate::model::Model;
use crate::monitor::has_memory;
use crate::outcome::asks_for_traps;
use crate::question::{Claim, Question};
use crate::reason::Reason;
use crate::rows::{Key, Rows};
use crate::scene::{Extent, Look, Scene, Tried, Until};
use crate::store::Store;
use crate::verdict::Verdict;

/// States, and scans of a state, between two questions whether to stop.
const PATIENCE: usize = 64;

/// Answers questions like [`crate::Explicit`], with a choice of the inputs that are tried, and shows
/// each scan: the number of scans before it, and the state behind it. For tests.
pub fn watch(
    model: &Model<'_>,
    questions: &[Question],
    budget: &Budget<'_>,
    tried: Tried,
    look: &mut dyn FnMut(usize, &State),
) -> Vec<(usize, Verdict)> {
    let mut look = |scene: Scene<'_>| look(scene.depth, scene.state);
    let mut search = Search::new(model, budget, questions.iter().enumerate().collect());
    search.tried = tried;
    search.look = Some(&mut look);
    search.run().answers
}

/// The end of a search.
pub(crate) struct Ended {
    /// The answers, with the numbers of their questions.
    pub(crate) answers: Vec<(usize, Verdict)>,
    /// Scans made.
    pub(crate) scans: usize,
    /// All states were visited, and each has a scan without a fault that the assumptions allow.
    pub(crate) goes_on: bool,
}

pub(crate) struct Search<'a> {
    pub(crate) tried: Tried,
    pub(crate) look: Option<Look<'a>>,
    /// The first scan takes place with the initial values of the inputs.
    pub(crate) rest: bool,
    /// The search begins behind these scans.
    pub(crate) start: &'a [Move],
    pub(crate) until: Until,
    /// The places of the only inputs that change.
    pub(crate) within: Option<Vec<usize>>,
    model: &'a Model<'a>,
    budget: &'a Budget<'a>,
    expander: Option<Expander<'a>>,
    /// Questions without an answer, with their numbers.
    open: Vec<(usize, &'a Question)>,
    answers: Vec<(usize, Verdict)>,
    /// The claim that remembers something.
    memory: Option<&'a Claim>,
    store: Store,
    /// For each state: the state before.
    parents: Vec<u32>,
    /// For each state: the inputs of the scan that led there.
    inputs: Rows,
    /// Room for a packed row of them.
    key: Key,
    /// For each state: the way in which the plant ticked there; empty unless it draws.
    ways: Vec<u8>,
    /// An image and inputs: room for the work.
    room: (Vec<u64>, Vec<u64>),
    /// Some question asks for the states that nothing leaves.
    traps: bool,
    /// For each state that was expanded: some move leads on at once.
    leads_on: Vec<bool>,
    /// Moves of states that none leads on.
    edges: Vec<(u32, u32)>,
    scans: usize,
    depth: usize,
    /// Why not all runs were seen.
    hole: Option<Reason>,
    /// The first state in which no input satisfies the assumptions.
    pub(crate) stuck: Option<usize>,
    /// Reports of a scan were cut.
    cut: bool,
    /// A scan had more passes than were looked at.
    cut_passes: bool,
    /// All states were visited.
    complete: bool,
    /// Some state has no scan without a fault.
    ends: bool,
}

impl<'a> Search<'a> {
    pub(crate) fn new(
        model: &'a Model<'a>,
        budget: &'a Budget<'a>,
        open: Vec<(usize, &'a Question)>,
    ) -> Search<'a> {
        Search {
            tried: Tried::Classes,
            look: None,
            rest: false,
            start: &[],
            until: Until::Answered,
            within: None,
            model,
            budget,
            expander: None,
            memory: open.iter().map(|(_, q)| &q.claim).find(|c| has_memory(c)),
            open,
            answers: Vec::new(),
            store: Store::new(),
            parents: Vec::new(),
            inputs: Rows::new(),
            key: Key::new(),
            ways: Vec::new(),
            room: Default::default(),
            traps: false,
            leads_on: Vec::new(),
            edges: Vec::new(),
            scans: 0,
            depth: 0,
            hole: None,
            stuck: None,
            cut: false,
            cut_passes: false,
            complete: false,
            ends: false,
        }
    }

    /// Searches, and answers all questions.
    pub(crate) fn run(mut self) -> Ended {
        self.search();
        if self.hole.is_none() {
            self.traps();
        }
        self.close();
        let goes_on = self.complete && !self.ends && self.hole.is_none();
        Ended { answers: self.answers, scans: self.scans, goes_on }
    }

    /// Visits all states, or as many as the budget and the questions allow.
    pub(crate) fn search(&mut self) {
        // Of a chart that is very large, a look at its tables takes longer than there is time.
        if (self.budget.stop)() {
            self.hole = Some(Reason::Stopped);
            return;
        }
        let mut expander = Expander::new(self.model, &self.open);
        expander.tried = match self.tried {
            // Who looks on is shown all combinations.
            Tried::Classes if self.look.is_some() => Tried::Matter,
            tried => tried,
        };
        expander.rest = self.rest;
        if let Some(inputs) = &self.within {
            expander.keep_to(inputs);
        }
        self.traps = self.open.iter().any(|(_, q)| asks_for_traps(&q.claim));
        expander.stop_when(self.budget.stop);
        let (image, inputs) = expander.behind(self.start);
        self.store = Store::new();
        self.store.insert(&image);
        self.parents.push(0);
        self.inputs.push(&inputs, &mut self.key);
        if expander.has_chance() {
            self.ways.push(0);
        }
        let (mut at, mut level) = (0usize, 1usize);
        while at < self.store.len() && self.goes_on() {
            if at == level {
                self.depth += 1;
                level = self.store.len();
            }
            if let Some(reason) = self.bound(at) {
                self.hole = Some(reason);
                break;
            }
            if !self.expand(at, &mut expander) {
                break;
            }
            at += 1;
        }
        self.depth += usize::from(at >= self.store.len());
        // Once all questions are answered, further states are not stored.
        self.complete = at >= self.store.len() && self.goes_on();
        self.expander = Some(expander);
    }

    fn goes_on(&self) -> bool {
        match self.until {
            Until::Answered => !self.open.is_empty(),
            Until::Stuck => self.stuck.is_none(),
            Until::Visited => true,
        }
    }

    /// How much was seen.
    pub(crate) fn seen(&self) -> Extent {
        let open = self.hole.clone().map(|reason| self.outcome().so_far(reason));
        Extent { states: self.store.len(), scans: self.scans, open }
    }

    /// Bytes in use: for the states, and for the runs that lead to them.
    pub(crate) fn kept(&self) -> (usize, usize) {
        (self.store.bytes(), self.parents.len() * 4 + self.ways.len() + self.inputs.bytes())
    }

    /// The fewest scans that lead to the last state.
    pub(crate) fn last(&self) -> usize {
        self.path(self.store.len().saturating_sub(1)).moves.len()
    }

    /// Why the search is to stop here.
    fn bound(&self, at: usize) -> Option<Reason> {
        let (states, runs) = self.kept();
        let bytes = states + runs + self.leads_on.len() + self.edges.len() * 8;
        let full = self.budget.full(self.store.len(), bytes);
        full.or_else(|| at.is_multiple_of(PATIENCE).then(|| self.stopped()).flatten())
    }

    /// Tells that the search is to stop.
    fn stopped(&self) -> Option<Reason> {
        self.budget.over(self.scans)
    }

    /// Tries all moves of a state; false if it was stopped meanwhile.
    fn expand(&mut self, at: usize, expander: &mut Expander<'a>) -> bool {
        let (mut image, mut inputs) = std::mem::take(&mut self.room);
        self.store.get(at, &mut image);
        self.inputs.get(at, &mut inputs);
        let here = Here { image: &image, inputs: &inputs, first: self.is_first(at) };
        let (mut on, mut next, mut ends) = (false, Vec::new(), true);
        let done = expander.expand(here, |step| {
            on |= step.leads_on;
            ends &= step.next.is_none();
            let to = self.take(at, step);
            next.extend(to.filter(|_| self.traps && !on));
            self.scans += 1;
            self.scans < self.budget.scans || !self.scans.is_multiple_of(PATIENCE)
        });
        self.room = (image, inputs);
        self.note(at, &done);
        if done.stopped {
            self.hole = Some(self.stopped().unwrap_or(Reason::Stopped));
            return false;
        }
        self.ends |= ends;
        if self.traps {
            self.leads_on.push(on);
        }
        if self.traps && !on {
            next.sort_unstable();
            next.dedup();
            self.edges.extend(next.into_iter().map(|to| (at as u32, to)));
        }
        true
    }

    /// Takes a scan into the answers and its state into the store; gives the number of the state.
    fn take(&mut self, at: usize, step: Step<'_>) -> Option<u32> {
        for shown in step.shown {
            self.settle(at, step.m, step.way, shown);
        }
        if step.fault.is_some() && !self.model.slice.is_whole() {
            // The chart may go on where its slice does not.
            self.hole.get_or_insert(Reason::NotRepeated);
        }
        let to = step.next.filter(|_| self.goes_on()).map(|image| {
            let number = self.store.len() as u32;
            self.store.find_or_insert(image).unwrap_or_else(|| {
                self.parents.push(at as u32);
                self.inputs.push(&step.m.inputs, &mut self.key);
                if !self.ways.is_empty() {
                    self.ways.push(step.way);
                }
                number
            })
        });
        if let Some(look) = &mut self.look {
            let Step { m, tried, state, fault, .. } = step;
            look(Scene { depth: self.depth, from: at, to: to.map(|t| t as usize), m, tried, state, fault });
        }
        to
    }

    /// Notes why not all runs are seen.
    fn note(&mut self, at: usize, done: &Expanded) {
        self.cut |= done.cut;
        self.cut_passes |= done.cut_passes;
        if let Some(gap) = done.gap.filter(|_| self.hole.is_none()) {
            self.hole = Some(gap.reason(self.model));
        }
        if done.stuck && !done.stopped && self.stuck.is_none() {
            self.hole = Some(Reason::NoInput(self.depth));
            self.stuck = Some(at);
        }
    }
}
