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
use crate::layer::{Budget, Layer};
use crate::model::Model;
use crate::monitor::has_memory;
use crate::outcome::{halted, more, stuck_behind, too_large, too_many};
use crate::question::{Claim, Question};
use crate::scene::{Extent, Look, Scene, Tried, Until};
use crate::store::Store;
use crate::verdict::{Open, Verdict, is_open};
use crate::world::WAYS;

/// States, and scans of a state, between two questions whether to stop.
const PATIENCE: usize = 64;

/// The explicit search as a layer.
#[derive(Clone, Copy, Debug, Default)]
pub struct Explicit;

impl Layer for Explicit {
    fn name(&self) -> &'static str {
        "search"
    }

    fn answer(
        &self,
        model: &Model<'_>,
        questions: &[Question],
        answers: &mut [Option<Verdict>],
        budget: &Budget<'_>,
    ) {
        let rows =
            || questions.iter().enumerate().zip(answers.iter()).filter(|(_, a)| is_open(a)).map(|(q, _)| q);
        let (alone, together): (Vec<_>, Vec<_>) = rows().partition(|(_, q)| has_memory(&q.claim));
        let groups = std::iter::once(together).chain(alone.into_iter().map(|q| vec![q]));
        let found: Vec<(usize, Verdict)> =
            groups.filter(|g| !g.is_empty()).flat_map(|g| Search::new(model, budget, g).run()).collect();
        for (i, verdict) in found {
            if let Some(answer) = answers.get_mut(i) {
                *answer = Some(verdict);
            }
        }
    }
}

/// Answers questions like [`Explicit`], with a choice of the inputs that are tried, and shows
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
    search.run()
}

pub(crate) struct Search<'a> {
    pub(crate) tried: Tried,
    pub(crate) look: Option<Look<'a>>,
    /// The first scan takes place with the initial values of the inputs.
    pub(crate) rest: bool,
    /// The search begins behind these scans.
    pub(crate) start: &'a [Move],
    pub(crate) until: Until,
    model: &'a Model<'a>,
    budget: &'a Budget<'a>,
    expander: Option<Expander<'a>>,
    /// Number of the inputs.
    count: usize,
    /// Questions without an answer, with their numbers.
    open: Vec<(usize, &'a Question)>,
    answers: Vec<(usize, Verdict)>,
    /// The claim that remembers something.
    memory: Option<&'a Claim>,
    store: Store,
    /// For each state: the state before.
    parents: Vec<u32>,
    /// For each state: the inputs of the scan that led there.
    inputs: Vec<u64>,
    /// For each state: the way in which the plant ticked there; empty unless it draws.
    ways: Vec<u8>,
    /// For each state that was expanded: some move leads on at once.
    leads_on: Vec<bool>,
    /// Moves of states that none leads on.
    edges: Vec<(u32, u32)>,
    scans: usize,
    depth: usize,
    /// Why not all runs were seen.
    hole: Option<(String, String)>,
    /// The first state in which no input satisfies the assumptions.
    pub(crate) stuck: Option<usize>,
    /// Reports of a scan were cut.
    cut: bool,
    /// A scan had more passes than were looked at.
    cut_passes: bool,
}

impl<'a> Search<'a> {
    pub(crate) fn new(
        model: &'a Model<'a>,
        budget: &'a Budget<'a>,
        open: Vec<(usize, &'a Question)>,
    ) -> Search<'a> {
        Search {
            tried: Tried::Matter,
            look: None,
            rest: false,
            start: &[],
            until: Until::Answered,
            model,
            budget,
            expander: None,
            count: model.inputs.len(),
            memory: open.iter().map(|(_, q)| &q.claim).find(|c| has_memory(c)),
            open,
            answers: Vec::new(),
            store: Store::new(0),
            parents: Vec::new(),
            inputs: Vec::new(),
            ways: Vec::new(),
            leads_on: Vec::new(),
            edges: Vec::new(),
            scans: 0,
            depth: 0,
            hole: None,
            stuck: None,
            cut: false,
            cut_passes: false,
        }
    }

    /// Searches, and answers all questions.
    fn run(mut self) -> Vec<(usize, Verdict)> {
        self.search();
        if self.hole.is_none() {
            self.traps();
        }
        self.close();
        self.answers
    }

    /// Visits all states, or as many as the budget and the questions allow.
    pub(crate) fn search(&mut self) {
        let mut expander = Expander::new(self.model, &self.open);
        (expander.tried, expander.rest) = (self.tried, self.rest);
        expander.stop_when(self.budget.stop);
        let (image, inputs) = expander.behind(self.start);
        self.store = Store::new(image.len());
        self.store.insert(&image);
        self.parents.push(0);
        self.inputs.extend(inputs);
        if expander.has_chance() {
            self.ways.push(0);
            let reason = format!("the plant's chance is tried in {WAYS} ways at each tick, of more");
            let help = "a plant without `random()` and without `arrivals` between two times can be proved";
            self.hole = Some((reason, help.to_owned()));
        }
        let (mut at, mut level) = (0usize, 1usize);
        while at < self.store.len() && self.goes_on() {
            if at == level {
                self.depth += 1;
                level = self.store.len();
            }
            if let Some((reason, help)) = self.bound(at) {
                self.hole = Some((reason, help));
                break;
            }
            if !self.expand(at, &mut expander) {
                break;
            }
            at += 1;
        }
        self.depth += usize::from(at >= self.store.len());
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
        let end = self.outcome();
        let open = self.hole.clone().map(|(reason, help)| Open {
            scans: end.depth,
            states: end.states,
            reason,
            help,
        });
        Extent { states: self.store.len(), scans: self.scans, open }
    }

    /// Why the search is to stop here.
    fn bound(&self, at: usize) -> Option<(String, String)> {
        let bytes =
            self.store.bytes() + self.parents.len() * 5 + self.inputs.len() * 8 + self.edges.len() * 8;
        if self.store.len() > self.budget.states {
            return Some(too_many(self.budget.states));
        }
        if bytes > self.budget.bytes {
            return Some(too_large(self.budget.bytes));
        }
        at.is_multiple_of(PATIENCE).then(|| self.stopped()).flatten()
    }

    /// Tells that the search is to stop.
    fn stopped(&self) -> Option<(String, String)> {
        if self.scans >= self.budget.scans {
            return Some((format!("more than {} scans are needed", self.budget.scans), more("--time")));
        }
        (self.budget.stop)().then(halted)
    }

    /// Tries all moves of a state; false if it was stopped meanwhile.
    fn expand(&mut self, at: usize, expander: &mut Expander<'a>) -> bool {
        let image: Vec<u64> = self.store.image(at).to_vec();
        let inputs: Vec<u64> = self.inputs_of(at).to_vec();
        let here = Here { image: &image, inputs: &inputs, first: self.is_first(at) };
        let (mut on, mut next) = (false, Vec::new());
        let done = expander.expand(here, |step| {
            on |= step.leads_on;
            next.extend(self.take(at, step));
            self.scans += 1;
            self.scans < self.budget.scans || !self.scans.is_multiple_of(PATIENCE)
        });
        self.note(at, &done);
        if done.stopped {
            self.hole = Some(self.stopped().unwrap_or_else(halted));
            return false;
        }
        self.leads_on.push(on);
        if !on {
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
        let to = step.next.filter(|_| self.goes_on()).map(|image| {
            let number = self.store.len() as u32;
            self.store.find_or_insert(image).unwrap_or_else(|| {
                self.parents.push(at as u32);
                self.inputs.extend_from_slice(&step.m.inputs);
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
            self.hole = Some(gap.why(self.model));
        }
        if done.stuck && !done.stopped && self.stuck.is_none() {
            self.hole = Some(stuck_behind(self.depth));
            self.stuck = Some(at);
        }
    }
}
