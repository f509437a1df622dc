//! The explicit search: all states of a chart, breadth first, with all that each question
//! looks for.
//!
//! A state is its canonical image with one word more: what a claim remembers (`monitor.rs`).
//! Questions that remember nothing share one search, each other has its own. Numbers of
//! states follow the order in which they were found, so the first run that shows
//! something is a shortest one.

use g7_engine::{Fault, Program, State, StepId, scan};

use crate::asked::{Asking, Places};
use crate::explore::Move;
use crate::layer::{Budget, Layer};
use crate::look::{PASSES, Passes, Scanned, allowed, passes, replay, shows};
use crate::model::Model;
use crate::monitor::{IDLE, has_memory, is_of_scans, judge};
use crate::question::{Claim, Question};
use crate::scene::{Extent, Look, Scene, Tried, Until};
use crate::store::Store;
use crate::verdict::{Certificate, Evidence, Open, Run, Verdict};

/// Most combinations of inputs that are tried in one state.
const MOST: usize = 1 << 16;
/// States between two questions whether to stop.
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
        let is_open = |a: &Option<Verdict>| matches!(a, None | Some(Verdict::Open(_)));
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
            asking: Asking::new(p, model.compiled.queries.iter().copied()),
            memory: open.iter().map(|(_, q)| &q.claim).find(|c| has_memory(c)),
            open,
            answers: Vec::new(),
            store: Store::new(0),
            width: 0,
            parents: Vec::new(),
            inputs: Vec::new(),
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
        let (mut state, mut other) = (State::new(self.p), State::new(self.p));
        let mut image = Vec::new();
        for m in self.start {
            let now = state.now().saturating_add(m.wait);
            // The caller has a run without a fault; behind one nothing would be found.
            let _fault = scan(self.p, &mut state, &m.inputs, now);
        }
        state.canonical(self.p, &mut image);
        self.width = image.len();
        image.push(IDLE);
        self.store = Store::new(image.len());
        self.store.insert(&image);
        self.parents.push(0);
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
            if let Some((reason, help)) = self.bound(at) {
                self.hole = Some((reason, help));
                break;
            }
            self.expand(at, &mut state, &mut other, &mut image);
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
        let open = self.hole.clone().map(|(reason, help)| self.so_far(reason, help));
        Extent { states: self.store.len(), scans: self.scans, open }
    }

    /// Why the search is to stop here.
    fn bound(&self, at: usize) -> Option<(String, String)> {
        let bytes =
            self.store.bytes() + self.parents.len() * 5 + self.inputs.len() * 8 + self.edges.len() * 8;
        if self.store.len() > self.budget.states {
            return Some((format!("there are more than {} states", self.budget.states), more("--states")));
        }
        if bytes > self.budget.bytes {
            let mib = self.budget.bytes >> 20;
            return Some((format!("the states need more than {mib} MiB"), more("--memory")));
        }
        (at.is_multiple_of(PATIENCE) && (self.budget.stop)())
            .then(|| ("the search was stopped".to_owned(), more("--time")))
    }

    /// Tries all moves of a state.
    fn expand(&mut self, at: usize, state: &mut State, other: &mut State, image: &mut Vec<u64>) {
        let from: Vec<u64> = self.store.image(at).to_vec();
        let (own, memory) = from.split_at(self.width.min(from.len()));
        let memory = memory.first().copied().unwrap_or(IDLE);
        put(self.p, state, own);
        let asked = self.asking.asked(state);
        let count = self.asking.count();
        let last: Vec<u64> = self.inputs.get(at * count..(at + 1) * count).unwrap_or(&[]).to_vec();
        let wait = self.wait(at);
        let (mut tried, mut on) = (false, false);
        let mut next: Vec<u32> = Vec::new();
        let places = self.places(&asked);
        for inputs in self.vectors(at, &places, last) {
            put(self.p, state, own);
            let now = state.now().saturating_add(wait);
            let m = Move { inputs, wait };
            if !self.model.assume.is_empty() {
                put(self.p, other, own);
                if !allowed(self.model, other, &m, now) {
                    continue;
                }
            }
            self.scans += 1;
            if !std::mem::replace(&mut tried, true) {
                self.see_asked(at, &asked, &m);
            }
            self.see_passes(at, other, own, &m, now);
            let active: Vec<StepId> = state.active().collect();
            let report = scan(self.p, state, &m.inputs, now);
            self.see(at, &Scanned { state, report }, &m);
            let Ok(report) = report else {
                on |= self.memory.is_none();
                self.show_scan(at, None, &m, &places, state, report.err());
                continue;
            };
            let Some(memory) = self.judge(at, state, memory, &m) else {
                self.show_scan(at, None, &m, &places, state, None);
                continue;
            };
            on |= match self.memory {
                Some(_) => memory == IDLE,
                None => report.cleared > 0 || !state.active().eq(active.iter().copied()),
            };
            state.canonical(self.p, image);
            image.push(memory);
            let number = self.store.len() as u32;
            let to = self.store.find_or_insert(image).unwrap_or_else(|| {
                self.parents.push(at as u32);
                self.inputs.extend_from_slice(&m.inputs);
                number
            });
            next.push(to);
            self.show_scan(at, Some(to as usize), &m, &places, state, None);
        }
        if !tried && self.stuck.is_none() {
            let reason = format!("no input satisfies the assumptions {}", behind(self.depth));
            let help = "weaken the assumptions: without inputs there are no runs, and every claim would hold";
            self.hole = Some((reason, help.to_owned()));
            self.stuck = Some(at);
        }
        self.leads_on.push(on);
        if !on {
            next.sort_unstable();
            next.dedup();
            self.edges.extend(next.into_iter().map(|to| (at as u32, to)));
        }
    }

    fn show_scan(
        &mut self,
        from: usize,
        to: Option<usize>,
        m: &Move,
        tried: &[usize],
        state: &mut State,
        fault: Option<Fault>,
    ) {
        let depth = self.depth;
        if let Some(look) = &mut self.look {
            look(Scene { depth, from, to, m, tried, state, fault });
        }
    }

    /// The places of the inputs that are tried in a state.
    fn places(&self, asked: &Places) -> Vec<usize> {
        match self.tried {
            Tried::Matter => self.asking.matter(asked).iter().collect(),
            Tried::All => (0..self.asking.count()).collect(),
        }
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
                _ if count > MOST => Some((
                    format!("{} inputs matter at once, in more combinations than are tried", places.len()),
                    "assume what the environment keeps, such as limit switches that exclude each other"
                        .to_owned(),
                )),
                Some(i) => Some((
                    format!("the input `{}` takes more values than are tried", self.name(*i)),
                    "compare it with constants only, or give it a smaller type".to_owned(),
                )),
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

    fn see_passes(&mut self, at: usize, other: &mut State, own: &[u64], m: &Move, now: i64) {
        let wants = |c: &Claim| self.open.iter().any(|(_, q)| q.claim == *c);
        let (conflict, safety) = (wants(&Claim::NoConflict), wants(&Claim::NoUnsafe));
        if !conflict && !safety {
            return;
        }
        put(self.p, other, own);
        let Passes { conflict, unsafe_, cut } = passes(self.p, other, &m.inputs, now, conflict);
        self.cut_passes |= cut;
        if conflict || unsafe_ {
            // A fault in the same scan belongs to the run.
            put(self.p, other, own);
            let fault = scan(self.p, other, &m.inputs, now).err();
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

    /// Judges the claims about the end of a scan; gives what is to be remembered, or nothing
    /// where the search need not go on.
    fn judge(&mut self, at: usize, s: &mut State, memory: u64, m: &Move) -> Option<u64> {
        let mut hits = Vec::new();
        let mut kept = IDLE;
        let open = self.open.clone();
        for (i, q) in open.iter().filter(|(_, q)| is_of_scans(&q.claim)) {
            match judge(self.model, &q.claim, s, memory, m.wait) {
                Ok(seen) => {
                    hits.extend(seen.hit.then_some(*i));
                    kept = if has_memory(&q.claim) { seen.memory } else { kept };
                }
                Err(fault) => {
                    let reason = format!("a condition of this property cannot be evaluated: {}", fault.kind);
                    let help =
                        "guard it, as in `n > 0 and x / n > 2`, with a condition of its own".to_owned();
                    self.give(*i, Verdict::Open(self.so_far(reason, help)));
                }
            }
        }
        if !hits.is_empty() {
            self.settle_those(at, m, None, &hits);
        }
        Some(kept).filter(|_| self.goes_on())
    }

    /// Answers the open questions that a scan shows.
    fn settle(&mut self, at: usize, m: &Move, fault: Option<Fault>, is_shown: impl Fn(&Claim) -> bool) {
        let hits: Vec<usize> =
            self.open.iter().filter(|(_, q)| is_shown(&q.claim)).map(|(i, _)| *i).collect();
        if !hits.is_empty() {
            self.settle_those(at, m, fault, &hits);
        }
    }

    fn settle_those(&mut self, at: usize, m: &Move, fault: Option<Fault>, hits: &[usize]) {
        let mut run = self.path(at);
        run.moves.push(m.clone());
        run.fault = fault;
        for i in hits {
            self.show(*i, run.clone());
        }
    }

    /// Answers a question with a run, if the run does the same again.
    fn show(&mut self, i: usize, run: Run) {
        let Some((_, q)) = self.open.iter().find(|(n, _)| *n == i) else { return };
        let claim = &q.claim;
        let verdict = if !replay(self.model, claim, &run) {
            let help = "please report this: search and engine do not agree".to_owned();
            Verdict::Open(self.so_far("the run that was found does not show it again".to_owned(), help))
        } else if claim.is_of_some_run() {
            Verdict::Proved(Evidence::Run(run))
        } else {
            Verdict::Refuted(Evidence::Run(run))
        };
        self.give(i, verdict);
    }

    fn give(&mut self, i: usize, verdict: Verdict) {
        self.open.retain(|(n, _)| *n != i);
        self.answers.push((i, verdict));
    }

    /// The time before the next scan behind a state: the first scan of all is at time 0.
    fn wait(&self, at: usize) -> i64 {
        if at == 0 && self.start.is_empty() { 0 } else { self.model.period }
    }

    /// The run that leads to a state from the beginning of the search.
    pub(crate) fn path(&self, mut at: usize) -> Run {
        let count = self.asking.count();
        let mut moves = Vec::new();
        while at > 0 {
            let before = self.parents.get(at).copied().unwrap_or(0) as usize;
            let inputs = self.inputs.get(at * count..(at + 1) * count).unwrap_or(&[]).to_vec();
            moves.push(Move { inputs, wait: self.wait(before) });
            at = before;
        }
        moves.reverse();
        Run { moves, fault: None }
    }

    /// Finds the states from which no run leads on: deadlocks, or causes without their effect.
    fn traps(&mut self) {
        let Some(i) = self.open.iter().find(|(_, q)| asks_for_traps(&q.claim)).map(|(i, _)| *i) else {
            return;
        };
        let mut back: Vec<(u32, u32)> = self.edges.iter().map(|(from, to)| (*to, *from)).collect();
        back.sort_unstable();
        let mut good = self.leads_on.clone();
        for (at, on) in good.iter_mut().enumerate() {
            *on |= self.memory.is_some() && self.store.image(at).last() == Some(&IDLE);
        }
        let mut work: Vec<u32> = (0u32..).zip(&good).filter(|(_, g)| **g).map(|(at, _)| at).collect();
        while let Some(at) = work.pop() {
            let first = back.partition_point(|(to, _)| *to < at);
            for (_, from) in back.iter().skip(first).take_while(|(to, _)| *to == at) {
                if let Some(g) = good.get_mut(*from as usize).filter(|g| !**g) {
                    *g = true;
                    work.push(*from);
                }
            }
        }
        let bad: Vec<usize> = good.iter().enumerate().filter(|(_, g)| !**g).map(|(at, _)| at).collect();
        if let Some(at) = bad.into_iter().find(|at| self.memory.is_some() || !self.is_end(*at)) {
            self.show(i, self.path(at));
        }
    }

    /// True if no active step has a transition behind it.
    fn is_end(&self, at: usize) -> bool {
        let mut s = State::new(self.p);
        put(self.p, &mut s, self.store.image(at).get(..self.width).unwrap_or(&[]));
        s.active().all(|step| self.asking.behind(step) == 0)
    }

    /// Answers what is left over.
    fn close(&mut self) {
        let certificate = Certificate::Search { states: self.store.len(), scans: self.scans };
        let cut = ("a scan does more than it reports".to_owned(), String::new());
        let cut_passes = (
            format!("a scan has more than {PASSES} passes"),
            "make every evolution end first, with an edge (`↑a`) or a step that waits".to_owned(),
        );
        for (i, q) in std::mem::take(&mut self.open) {
            let hidden = match &q.claim {
                Claim::Active(_) | Claim::Clears(_) | Claim::Runs(_) => self.cut.then_some(&cut),
                Claim::NoConflict | Claim::NoUnsafe => self.cut_passes.then_some(&cut_passes),
                _ => None,
            };
            let hole = self.hole.as_ref().or(hidden).cloned();
            let verdict = match hole {
                Some((reason, help)) => Verdict::Open(self.so_far(reason, help)),
                None if q.claim.is_of_some_run() => {
                    Verdict::Refuted(Evidence::Certificate(certificate.clone()))
                }
                None => Verdict::Proved(Evidence::Certificate(certificate.clone())),
            };
            self.answers.push((i, verdict));
        }
    }

    fn so_far(&self, reason: String, help: String) -> Open {
        Open { scans: self.depth, states: self.store.len(), reason, help }
    }
}

fn asks_for_traps(claim: &Claim) -> bool {
    matches!(claim, Claim::NoDeadlock | Claim::LeadsTo { .. })
}

fn more(option: &str) -> String {
    format!("allow more with {option}, or assume what the environment keeps")
}

fn behind(depth: usize) -> String {
    if depth == 0 { "at the start".to_owned() } else { format!("behind a run of {depth} scans") }
}

/// Makes a state one of the store, which holds images of the program alone.
fn put(p: &Program, state: &mut State, image: &[u64]) {
    let done = state.restore(p, image);
    debug_assert!(done.is_ok(), "{done:?}");
}
