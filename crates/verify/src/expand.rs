//! One state of a search, expanded: all scans that lead on from it, with what each shows.
//!
//! Nothing here stores states or decides in which order they are visited. `search.rs` does so for one
//! machine; others may do it in another way. A state is given and comes back as its image: that of the
//! charts, that of their plant, and one word for what the claim with a memory remembers. Equal images
//! have equal futures. The scans of a state come in an order that follows from its image and the inputs
//! before it alone, so two expanders of one model show the same.

use g7_engine::{Fault, FaultKind, Program, State, scan};

use crate::asked::{Asking, Places};
use crate::explore::Move;
use crate::look::{Passes, Scanned, allowed, passes, shows};
use crate::model::Model;
use crate::monitor::{IDLE, has_memory, is_of_scans, judge};
use crate::question::{Claim, Question};
use crate::scene::Tried;
use crate::tries::{MOST, Tries, count};
use crate::world::World;

/// Combinations of inputs of a state between two questions whether to stop.
const PATIENCE: usize = 64;

/// A state to be expanded.
#[derive(Clone, Copy, Debug)]
pub struct Here<'s> {
    /// Its image, as [`Expander::start`] or [`Step::next`] gave it.
    pub image: &'s [u64],
    /// The inputs of the scan that led there, a word for each word of [`g7_engine::Tables::inputs`];
    /// the initial ones at the start. Inputs that cannot matter keep these values, and each other one
    /// takes its present value first. They make no difference to the images that follow.
    pub inputs: &'s [u64],
    /// No scan was made before: the next one is at time 0.
    pub first: bool,
}

/// One scan of a state that is expanded.
pub struct Step<'s> {
    /// The inputs, and the time since the scan before.
    pub m: &'s Move,
    /// The way in which the plant ticked; 0 unless it draws random numbers.
    pub way: u8,
    /// The image of the state behind it; `None` behind a fault.
    pub next: Option<&'s [u64]>,
    /// The fault that stopped the charts.
    pub fault: Option<Fault>,
    /// It changes the situation or clears a transition, or ends with a fault. For a claim with a memory:
    /// nothing is remembered behind it.
    pub leads_on: bool,
    /// The questions that it answers. Each is shown once and then no more looked for.
    pub shown: &'s [Shown],
    /// The places of the inputs that are tried in the state before it.
    pub(crate) tried: &'s [usize],
    /// The charts behind it.
    pub(crate) state: &'s mut State,
}

/// An answer that a scan gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// The run up to this scan shows what the claim is about.
    Run {
        /// The number of the question, as the expander was given it.
        question: usize,
        /// The fault with which the scan ends.
        fault: Option<Fault>,
    },
    /// A condition of the claim cannot be evaluated.
    Unclear {
        /// The number of the question.
        question: usize,
        /// The fault of the condition.
        fault: Fault,
    },
}

impl Shown {
    /// The number of the question.
    pub fn question(&self) -> usize {
        match self {
            Shown::Run { question, .. } | Shown::Unclear { question, .. } => *question,
        }
    }
}

/// The reason why the scans of a state are not all that may matter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gap {
    /// So many inputs matter at once that not all combinations were tried.
    Combinations(usize),
    /// The input at this place takes more values than were tried.
    Values(usize),
    /// A fault stopped the plant.
    Plant(FaultKind),
}

/// The end of an expansion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Expanded {
    /// Scans made.
    pub scans: usize,
    /// No input satisfies the assumptions, so no scan was made.
    pub stuck: bool,
    /// Not all scans that may matter were made.
    pub gap: Option<Gap>,
    /// The caller has stopped it.
    pub stopped: bool,
    /// Some scan cleared or ran more than it reports.
    pub cut: bool,
    /// Some scan had more passes than were looked at for conflicts and unsafe markings.
    pub cut_passes: bool,
}

/// Expands states of a model.
pub struct Expander<'a> {
    /// The inputs that are tried.
    pub(crate) tried: Tried,
    /// The first scan takes place with the inputs before it.
    pub(crate) rest: bool,
    model: &'a Model<'a>,
    p: &'a Program,
    asking: Asking,
    /// The questions that are looked for, with their numbers.
    open: Vec<(usize, &'a Claim)>,
    /// The claim that remembers something.
    memory: Option<&'a Claim>,
    /// Tells that the work is to stop.
    stop: Option<&'a (dyn Fn() -> bool + Sync)>,
    world: World<'a>,
    other: World<'a>,
    work: Work,
}

/// Room for the work on one state, kept for the next.
#[derive(Default)]
struct Work {
    places: Vec<usize>,
    tries: Tries,
    given: Vec<u64>,
    active: Vec<u32>,
    m: Move,
    shown: Vec<Shown>,
    image: Vec<u64>,
}

/// The parts of a state that its scans need.
struct Origin<'s> {
    own: &'s [u64],
    memory: u64,
    asked: Places,
}

impl<'a> Expander<'a> {
    /// An expander that looks for questions, each with the number that it has in [`Shown`]. At most one
    /// of them may have a memory ([`Expander::remembers`]).
    pub fn new(model: &'a Model<'a>, questions: &[(usize, &'a Question)]) -> Expander<'a> {
        let p: &Program = &model.compiled.program;
        let mut expander = Expander {
            tried: Tried::Matter,
            rest: false,
            model,
            p,
            asking: Asking::new(p, model.codes()),
            open: Vec::new(),
            memory: None,
            stop: None,
            world: World::new(model),
            other: World::new(model),
            work: Work::default(),
        };
        expander.look_for(questions);
        expander
    }

    /// Looks for these questions from now on.
    pub fn look_for(&mut self, questions: &[(usize, &'a Question)]) {
        self.open.clear();
        self.open.extend(questions.iter().map(|(i, q)| (*i, &q.claim)));
        self.memory = self.open.iter().map(|(_, c)| *c).find(|c| has_memory(c));
    }

    /// Tries these inputs from now on.
    pub fn try_inputs(&mut self, tried: Tried) {
        self.tried = tried;
    }

    /// Lets `stop` end an expansion that has many combinations of inputs to try. It is asked often.
    pub fn stop_when(&mut self, stop: &'a (dyn Fn() -> bool + Sync)) {
        self.stop = Some(stop);
    }

    /// True if a claim remembers something from scan to scan. It needs a search of its own: the images
    /// of this search tell what it remembers.
    pub fn remembers(question: &Question) -> bool {
        has_memory(&question.claim)
    }

    /// The number of the inputs.
    pub fn inputs(&self) -> usize {
        self.asking.count()
    }

    /// The state before the first scan: its image, and the initial inputs.
    pub fn start(&self) -> (Vec<u64>, Vec<u64>) {
        let mut image = Vec::new();
        World::new(self.model).image(&mut image);
        image.push(IDLE);
        let initial = self.model.inputs.iter().map(|v| v.tried.first().copied().unwrap_or(0));
        (image, initial.collect())
    }

    /// The state behind the start and these scans, which no fault stops: its image and the inputs of
    /// the last of them.
    pub(crate) fn behind(&self, moves: &[Move]) -> (Vec<u64>, Vec<u64>) {
        let (mut image, mut inputs) = self.start();
        let mut world = World::new(self.model);
        for m in moves {
            let now = world.charts.now().saturating_add(m.wait);
            // The caller has a run without a fault; behind one nothing would be found.
            let _fault = scan(self.p, &mut world.charts, &m.inputs, now);
            inputs.clone_from(&m.inputs);
        }
        world.image(&mut image);
        image.push(IDLE);
        (image, inputs)
    }

    /// True if nothing can follow a state by rights: no active step has a transition behind it.
    pub fn is_end(&mut self, image: &[u64]) -> bool {
        self.world.put(image.split_last().map_or(&[], |(_, own)| own));
        self.world.charts.active().all(|step| self.asking.behind(step) == 0)
    }

    /// True if the plant draws random numbers: then its ways are more than those that are tried, and
    /// nothing is proved.
    pub fn has_chance(&self) -> bool {
        self.world.has_chance()
    }

    /// Makes all scans of a state that matter, and shows each to `see`, which tells whether to go on.
    pub fn expand(&mut self, here: Here<'_>, mut see: impl FnMut(Step<'_>) -> bool) -> Expanded {
        let (memory, own) = here.image.split_last().map_or((IDLE, &[][..]), |(m, own)| (*m, own));
        let mut work = std::mem::take(&mut self.work);
        self.world.put(own);
        let from = Origin { own, memory, asked: self.asking.asked(&self.world.charts) };
        self.find_places(&from.asked, &mut work.places);
        work.active.clear();
        work.active.extend(self.world.charts.active().map(|s| s.0));
        work.m.wait = if here.first { 0 } else { self.model.period };
        let mut done = Expanded { stuck: true, ..Expanded::default() };
        let is_rest = self.rest && here.first;
        done.gap = if is_rest { None } else { self.gap(&work.places) };
        for way in self.world.ways() {
            self.world.put(own);
            work.given.clear();
            work.given.extend_from_slice(here.inputs);
            if let Err(fault) = self.world.tick(work.m.wait, way, &mut work.given) {
                done.gap = Some(Gap::Plant(fault.kind));
                done.stuck = false;
                continue;
            }
            let places = if is_rest { &[][..] } else { &work.places };
            work.tries.begin(&self.model.inputs, places, &work.given);
            let mut made = 0usize;
            while !done.stopped && work.tries.next(&self.model.inputs, &mut work.m.inputs) {
                made += 1;
                done.stopped = made.is_multiple_of(PATIENCE) && self.stop.is_some_and(|stop| stop());
                if !done.stopped {
                    self.attempt(&from, &mut work, way, &mut done, &mut see);
                }
            }
        }
        self.work = work;
        done
    }

    /// Makes one scan; the plant has made its own before.
    fn attempt(
        &mut self,
        from: &Origin<'_>,
        work: &mut Work,
        way: u8,
        done: &mut Expanded,
        see: &mut impl FnMut(Step<'_>) -> bool,
    ) {
        self.world.put_charts(from.own);
        let now = self.world.charts.now().saturating_add(work.m.wait);
        if !self.model.assume.is_empty() {
            self.other.put_charts(from.own);
            if !allowed(self.model, &mut self.other, &work.m, now) {
                return;
            }
        }
        done.scans += 1;
        work.shown.clear();
        if std::mem::replace(&mut done.stuck, false) {
            self.see_asked(&from.asked, &mut work.shown);
        }
        self.see_passes(from.own, now, work, done);
        let report = scan(self.p, &mut self.world.charts, &work.m.inputs, now);
        let scanned = Scanned { state: &self.world.charts, report };
        done.cut |= is_cut(self.p, &scanned);
        let fault = report.err();
        show(&mut self.open, &mut work.shown, fault, |c| shows(self.p, c, &scanned));
        let mut leads_on = self.memory.is_none();
        if let Ok(report) = report {
            let memory = self.judge(from.memory, work);
            leads_on = match self.memory {
                Some(_) => memory == IDLE,
                None => {
                    let before = work.active.iter().copied();
                    report.cleared > 0 || !self.world.charts.active().map(|s| s.0).eq(before)
                }
            };
            self.world.image(&mut work.image);
            work.image.push(memory);
        }
        let step = Step {
            m: &work.m,
            way,
            next: fault.is_none().then_some(&work.image),
            fault,
            leads_on,
            shown: &work.shown,
            tried: &work.places,
            state: &mut self.world.charts,
        };
        done.stopped = !see(step);
    }

    /// The places of the inputs that are tried in a state.
    fn find_places(&self, asked: &Places, places: &mut Vec<usize>) {
        places.clear();
        let free = |i: &usize| !self.model.is_driven(*i);
        match self.tried {
            Tried::Matter => places.extend(self.asking.matter(asked).iter().filter(free)),
            Tried::All => places.extend((0..self.asking.count()).filter(free)),
        }
    }

    /// The reason why the combinations of these inputs are not all that matter.
    fn gap(&self, places: &[usize]) -> Option<Gap> {
        if count(&self.model.inputs, places) > MOST {
            return Some(Gap::Combinations(places.len()));
        }
        let open = places.iter().find(|i| self.model.inputs.get(**i).is_some_and(|v| !v.whole));
        open.copied().map(Gap::Values)
    }

    fn see_asked(&mut self, asked: &Places, shown: &mut Vec<Shown>) {
        let first = self.p.tables().inputs.start;
        let is_asked =
            |c: &Claim| matches!(c, Claim::Asked(a) if asked.iter().any(|i| i as u32 + first == a.0));
        show(&mut self.open, shown, None, is_asked);
    }

    fn see_passes(&mut self, own: &[u64], now: i64, work: &mut Work, done: &mut Expanded) {
        let wants = |c: &Claim| self.open.iter().any(|(_, open)| *open == c);
        let (conflict, safety) = (wants(&Claim::NoConflict), wants(&Claim::NoUnsafe));
        if !conflict && !safety {
            return;
        }
        let inputs = &work.m.inputs;
        self.other.put_charts(own);
        let Passes { conflict, unsafe_, cut } = passes(self.p, &mut self.other.charts, inputs, now, conflict);
        done.cut_passes |= cut;
        if conflict || unsafe_ {
            // A fault in the same scan belongs to the run.
            self.other.put_charts(own);
            let fault = scan(self.p, &mut self.other.charts, inputs, now).err();
            show(&mut self.open, &mut work.shown, fault, |c| match c {
                Claim::NoConflict => conflict,
                Claim::NoUnsafe => unsafe_,
                _ => false,
            });
        }
    }

    /// Judges the claims about the end of a scan; gives what is to be remembered.
    fn judge(&mut self, memory: u64, work: &mut Work) -> u64 {
        let mut kept = IDLE;
        let Expander { open, model, world, .. } = self;
        open.retain(|(question, claim)| {
            if !is_of_scans(claim) {
                return true;
            }
            let question = *question;
            match judge(model, claim, world, memory, work.m.wait) {
                Ok(seen) => {
                    kept = if has_memory(claim) { seen.memory } else { kept };
                    work.shown.extend(seen.hit.then_some(Shown::Run { question, fault: None }));
                    !seen.hit
                }
                Err(fault) => {
                    work.shown.push(Shown::Unclear { question, fault });
                    false
                }
            }
        });
        kept
    }
}

/// Notes the questions that a scan shows, and looks for them no more.
fn show(
    open: &mut Vec<(usize, &Claim)>,
    shown: &mut Vec<Shown>,
    fault: Option<Fault>,
    is_shown: impl Fn(&Claim) -> bool,
) {
    open.retain(|(question, claim)| {
        let is_shown = is_shown(claim);
        shown.extend(is_shown.then_some(Shown::Run { question: *question, fault }));
        !is_shown
    });
}

/// True if a scan may have cleared or run more than it reports.
fn is_cut(p: &Program, scanned: &Scanned<'_>) -> bool {
    let (s, t) = (scanned.state, p.tables());
    // As much as the reports of a scan have room for.
    let (most_run, most_cleared) = (t.actions.len() + 64, 2 * t.transitions.len() + 64);
    let listed = scanned.report.map_or(0, |r| r.cleared as usize);
    let cleared = s.cleared().len();
    s.ran().len() >= most_run || cleared < listed || cleared >= most_cleared
}
