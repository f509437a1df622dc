//! The explicit search: all states of a chart, breadth first, with all that each question
//! looks for.
//!
//! A state is its canonical image with one word more: what a claim remembers (`monitor.rs`).
//! Questions that remember nothing share one search, each other has its own. Numbers of
//! states follow the order in which they were found, so the first run that shows
//! something is a shortest one.

mod answers;

use g7_engine::{Fault, Program, State, StepId, scan};

use crate::asked::{Asking, Places};
use crate::explore::Move;
use crate::layer::{Budget, Layer};
use crate::look::{Passes, Scanned, allowed, passes, shows};
use crate::model::Model;
use crate::monitor::{IDLE, has_memory};
use crate::question::{Claim, Question};
use crate::reason::Reason;
use crate::scene::{Extent, Look, Scene, Tried, Until};
use crate::store::Store;
use crate::verdict::{Verdict, is_open};
use crate::world::{WAYS, World};

/// Most combinations of inputs that are tried in one state.
const MOST: usize = 1 << 16;
/// States, and combinations of inputs of a state, between two questions whether to stop.
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

/// The moves of one state.
struct Tries {
    at: usize,
    /// The memory of the claim in the state.
    memory: u64,
    asked: Places,
    /// The places of the inputs that are tried.
    places: Vec<usize>,
    /// One was made.
    tried: bool,
    /// One leads on at once.
    on: bool,
    /// The states behind them.
    next: Vec<u32>,
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
    p: &'a Program,
    budget: &'a Budget<'a>,
    asking: Asking,
    /// Questions without an answer, with their numbers.
    open: Vec<(usize, &'a Question)>,
    answers: Vec<(usize, Verdict)>,
    /// The claim that remembers something.
    memory: Option<&'a Claim>,
    store: Store,
    /// Words of an image without the memory.
    width: usize,
    /// For each state: the state before.
    parents: Vec<u32>,
    /// For each state: the inputs of the scan that led there.
    inputs: Vec<u64>,
    /// For each state: the way in which the plant ticked there; empty unless it draws.
    ways: Vec<u8>,
    /// The way of the moves in hand.
    way: u8,
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
}

impl<'a> Search<'a> {
    pub(crate) fn new(
        model: &'a Model<'a>,
        budget: &'a Budget<'a>,
        open: Vec<(usize, &'a Question)>,
    ) -> Search<'a> {
        let p: &Program = &model.compiled.program;
        Search {
            tried: Tried::Matter,
            look: None,
            rest: false,
            start: &[],
            until: Until::Answered,
            model,
            p,
            budget,
            asking: Asking::new(p, model.codes()),
            memory: open.iter().map(|(_, q)| &q.claim).find(|c| has_memory(c)),
            open,
            answers: Vec::new(),
            store: Store::new(0),
            width: 0,
            parents: Vec::new(),
            inputs: Vec::new(),
            ways: Vec::new(),
            way: 0,
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
        let (mut world, mut other) = (World::new(self.model), World::new(self.model));
        let mut image = Vec::new();
        for m in self.start {
            let now = world.charts.now().saturating_add(m.wait);
            // The caller has a run without a fault; behind one nothing would be found.
            let _fault = scan(self.p, &mut world.charts, &m.inputs, now);
        }
        world.image(&mut image);
        self.width = image.len();
        image.push(IDLE);
        self.store = Store::new(image.len());
        self.store.insert(&image);
        self.parents.push(0);
        if world.has_chance() {
            self.ways.push(0);
        }
        match self.start.last() {
            Some(m) => self.inputs.extend_from_slice(&m.inputs),
            None => {
                let initial = self.model.inputs.iter().map(|v| v.tried.first().copied().unwrap_or(0));
                self.inputs.extend(initial);
            }
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
            if !self.expand(at, &mut world, &mut other, &mut image) {
                break;
            }
            at += 1;
        }
        self.depth += usize::from(at >= self.store.len());
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
        let open = self.hole.clone().map(|reason| self.so_far(reason));
        Extent { states: self.store.len(), scans: self.scans, open }
    }

    /// Why the search is to stop here.
    fn bound(&self, at: usize) -> Option<Reason> {
        let bytes =
            self.store.bytes() + self.parents.len() * 5 + self.inputs.len() * 8 + self.edges.len() * 8;
        if self.store.len() > self.budget.states {
            return Some(Reason::States(self.budget.states));
        }
        if bytes > self.budget.bytes {
            return Some(Reason::Memory(self.budget.bytes >> 20));
        }
        at.is_multiple_of(PATIENCE).then(|| self.stopped()).flatten()
    }

    /// Tells that the search is to stop.
    fn stopped(&self) -> Option<Reason> {
        if self.scans >= self.budget.scans {
            return Some(Reason::Scans(self.budget.scans));
        }
        (self.budget.stop)().then_some(Reason::Stopped)
    }

    /// Tries all moves of a state; false if it was stopped meanwhile.
    fn expand(
        &mut self,
        at: usize,
        world: &mut World<'a>,
        other: &mut World<'a>,
        image: &mut Vec<u64>,
    ) -> bool {
        let from: Vec<u64> = self.store.image(at).to_vec();
        let (own, memory) = from.split_at(self.width.min(from.len()));
        let memory = memory.first().copied().unwrap_or(IDLE);
        world.put(own);
        let asked = self.asking.asked(&world.charts);
        let count = self.asking.count();
        let last: Vec<u64> = self.inputs.get(at * count..(at + 1) * count).unwrap_or(&[]).to_vec();
        let wait = self.wait(at);
        let places = self.places(&asked);
        let mut tries = Tries { at, memory, asked, places, tried: false, on: false, next: Vec::new() };
        for way in world.ways() {
            world.put(own);
            let mut given = last.clone();
            self.way = way;
            let ticked = world.tick(wait, way, &mut given);
            if way > 0 && !world.drew() {
                break;
            }
            if world.drew() && self.hole.is_none() {
                self.hole = Some(Reason::Chance(WAYS.into()));
            }
            if let Err(fault) = ticked {
                self.hole.get_or_insert(Reason::Plant(fault.kind));
                tries.tried = true;
                continue;
            }
            for (k, inputs) in self.vectors(at, &tries.places, given).into_iter().enumerate() {
                if k.is_multiple_of(PATIENCE)
                    && k > 0
                    && let Some(hole) = self.stopped()
                {
                    self.hole = Some(hole);
                    return false;
                }
                world.put_charts(own);
                self.attempt(&mut tries, own, &Move { inputs, wait }, world, other, image);
            }
        }
        if !tries.tried && self.stuck.is_none() {
            self.hole = Some(Reason::NoInput(self.depth));
            self.stuck = Some(at);
        }
        let Tries { on, mut next, .. } = tries;
        self.leads_on.push(on);
        if !on {
            next.sort_unstable();
            next.dedup();
            self.edges.extend(next.into_iter().map(|to| (at as u32, to)));
        }
        true
    }

    /// Makes one move of a state; the plant has made its own before.
    fn attempt(
        &mut self,
        tries: &mut Tries,
        own: &[u64],
        m: &Move,
        world: &mut World<'a>,
        other: &mut World<'a>,
        image: &mut Vec<u64>,
    ) {
        let at = tries.at;
        let now = world.charts.now().saturating_add(m.wait);
        if !self.model.assume.is_empty() {
            other.put_charts(own);
            if !allowed(self.model, other, m, now) {
                return;
            }
        }
        self.scans += 1;
        if !std::mem::replace(&mut tries.tried, true) {
            let asked = tries.asked.clone();
            self.see_asked(at, &asked, m);
        }
        self.see_passes(at, other, own, m, now);
        let active: Vec<StepId> = world.charts.active().collect();
        let report = scan(self.p, &mut world.charts, &m.inputs, now);
        self.see(at, &Scanned { state: &world.charts, report }, m);
        let Ok(report) = report else {
            tries.on |= self.memory.is_none();
            self.show_scan(tries, None, m, world, report.err());
            return;
        };
        let Some(memory) = self.judge(at, world, tries.memory, m) else {
            self.show_scan(tries, None, m, world, None);
            return;
        };
        tries.on |= match self.memory {
            Some(_) => memory == IDLE,
            None => report.cleared > 0 || !world.charts.active().eq(active.iter().copied()),
        };
        world.image(image);
        image.push(memory);
        let number = self.store.len() as u32;
        let to = self.store.find_or_insert(image).unwrap_or_else(|| {
            self.parents.push(at as u32);
            self.inputs.extend_from_slice(&m.inputs);
            if world.has_chance() {
                self.ways.push(self.way);
            }
            number
        });
        tries.next.push(to);
        self.show_scan(tries, Some(to as usize), m, world, None);
    }

    fn show_scan(
        &mut self,
        tries: &Tries,
        to: Option<usize>,
        m: &Move,
        world: &mut World<'a>,
        fault: Option<Fault>,
    ) {
        let depth = self.depth;
        if let Some(look) = &mut self.look {
            let state = &mut world.charts;
            look(Scene { depth, from: tries.at, to, m, tried: &tries.places, state, fault });
        }
    }

    /// The places of the inputs that are tried in a state.
    fn places(&self, asked: &Places) -> Vec<usize> {
        let places: Vec<usize> = match self.tried {
            Tried::Matter => self.asking.matter(asked).iter().collect(),
            Tried::All => (0..self.asking.count()).collect(),
        };
        places.into_iter().filter(|i| !self.model.is_driven(*i)).collect()
    }

    /// The inputs that are tried in a state; leaves a note where they are not all that matter.
    fn vectors(&mut self, at: usize, places: &[usize], last: Vec<u64>) -> Vec<Vec<u64>> {
        if self.rest && at == 0 && self.start.is_empty() {
            return vec![last];
        }
        let tried = |i: usize| self.model.inputs.get(i).map_or(&[][..], |v| &v.tried);
        let count = places.iter().fold(1usize, |n, i| n.saturating_mul(tried(*i).len().max(1)));
        let set = |old: &[u64], i: usize, value: u64| {
            let mut new = old.to_vec();
            new.get_mut(i).into_iter().for_each(|w| *w = value);
            new
        };
        // The present value comes first, so that a run changes an input only where it must.
        let values = |i: usize| {
            let now = last.get(i).copied();
            let others = tried(i).iter().copied().filter(move |v| Some(*v) != now);
            now.filter(|v| tried(i).contains(v)).into_iter().chain(others)
        };
        let mut list = vec![last.clone()];
        for i in places {
            if count > MOST {
                list.extend(tried(*i).iter().map(|v| set(&last, *i, *v)).filter(|v| *v != last));
            } else {
                list = list.iter().flat_map(|old| values(*i).map(|v| set(old, *i, v))).collect();
            }
        }
        if self.hole.is_none() {
            let open = places.iter().find(|i| self.model.inputs.get(**i).is_some_and(|v| !v.whole));
            self.hole = match open {
                _ if count > MOST => Some(Reason::Combinations(places.len())),
                Some(i) => Some(Reason::Values(self.name(*i).to_owned())),
                None => None,
            };
        }
        list
    }

    fn name(&self, place: usize) -> &str {
        let addr = g7_engine::Addr(self.p.tables().inputs.start + place as u32);
        self.model.compiled.symbols.variable_at(addr).map_or("", |v| &v.name)
    }

    fn see_asked(&mut self, at: usize, asked: &Places, m: &Move) {
        let first = self.p.tables().inputs.start;
        self.settle(
            at,
            m,
            None,
            |c| matches!(c, Claim::Asked(a) if asked.iter().any(|i| i as u32 + first == a.0)),
        );
    }

    fn see_passes(&mut self, at: usize, other: &mut World<'a>, own: &[u64], m: &Move, now: i64) {
        let wants = |c: &Claim| self.open.iter().any(|(_, q)| q.claim == *c);
        let (conflict, safety) = (wants(&Claim::NoConflict), wants(&Claim::NoUnsafe));
        if !conflict && !safety {
            return;
        }
        other.put_charts(own);
        let Passes { conflict, unsafe_, cut } = passes(self.p, &mut other.charts, &m.inputs, now, conflict);
        self.cut_passes |= cut;
        if conflict || unsafe_ {
            // A fault in the same scan belongs to the run.
            other.put_charts(own);
            let fault = scan(self.p, &mut other.charts, &m.inputs, now).err();
            self.settle(at, m, fault, |c| match c {
                Claim::NoConflict => conflict,
                Claim::NoUnsafe => unsafe_,
                _ => false,
            });
        }
    }

    fn see(&mut self, at: usize, scanned: &Scanned<'_>, m: &Move) {
        let s = scanned.state;
        let t = self.p.tables();
        // As much as the reports of a scan have room for.
        let (most_run, most_cleared) = (t.actions.len() + 64, 2 * t.transitions.len() + 64);
        let listed = scanned.report.map_or(0, |r| r.cleared as usize);
        let cleared = s.cleared().len();
        self.cut |= s.ran().len() >= most_run || cleared < listed || cleared >= most_cleared;
        let p = self.p;
        self.settle(at, m, scanned.report.err(), |c| shows(p, c, scanned));
    }
}
