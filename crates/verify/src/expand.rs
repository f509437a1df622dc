//! One state of a search, expanded: all scans that lead on from it, with what each shows.
//!
//! Nothing here stores states or decides in which order they are visited. `search.rs` does so for one
//! machine; others may do it in another way. A state is given and comes back as its image: that of the
//! charts, that of their plant, and one word for what the claim with a memory remembers. Equal images
//! have equal futures. The scans of a state come in an order that follows from its image and the inputs
//! before it alone, so two expanders of one model show the same.

use g7_engine::{Fault, FaultKind, Program, State, scan};

use crate::asked::{Asking, Places, Room};
use crate::explore::Move;
use crate::look::{Passes, Scanned, allowed, passes, shows};
use crate::model::Model;
use crate::monitor::{IDLE, has_memory, judge_each};
use crate::question::{Claim, Question};
use crate::scene::Tried;
use crate::tries::{MOST, Tries, count};
use crate::values::Values;
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
    /// The plant drew a random number, of which not all were tried.
    Chance,
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

/// The reason why the combinations of the inputs at these places are not all that matter.
pub(crate) fn gap(inputs: &[Values], places: &[usize]) -> Option<Gap> {
    if count(inputs, places) > MOST {
        return Some(Gap::Combinations(places.len()));
    }
    let open = places.iter().find(|i| inputs.get(**i).is_some_and(|v| !v.whole));
    open.copied().map(Gap::Values)
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
    /// The places of the inputs that are free.
    free: Vec<usize>,
    /// The initial inputs.
    initial: Vec<u64>,
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
    room: Room,
    /// The inputs that the scan in hand may have read.
    read: Places,
    given: Vec<u64>,
    active: Vec<u32>,
    m: Move,
    shown: Vec<Shown>,
    image: Vec<u64>,
}

/// The parts of a state that its scans need.
struct Origin {
    memory: u64,
    is_started: bool,
    /// Conflicts and unsafe markings are looked for.
    conflict: bool,
    safety: bool,
}

/// The end of a try with one combination of inputs.
enum Trial {
    /// The assumptions do not allow it.
    Refused,
    /// A scan was made, and has reported all that it cleared.
    Made,
    /// A scan was made, of which less is known.
    Unknown,
}

impl<'a> Expander<'a> {
    /// An expander that looks for questions, each with the number that it has in [`Shown`]. At most one
    /// of them may have a memory ([`Expander::remembers`]).
    pub fn new(model: &'a Model<'a>, questions: &[(usize, &'a Question)]) -> Expander<'a> {
        let p: &Program = &model.compiled.program;
        let mut expander = Expander {
            tried: Tried::Classes,
            rest: false,
            model,
            p,
            asking: Asking::new(p, model.codes()),
            free: (0..model.inputs.len()).filter(|i| !model.is_driven(*i)).collect(),
            initial: model.inputs.iter().map(|v| v.tried.first().copied().unwrap_or(0)).collect(),
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

    /// Only these inputs, by their places, ascending, take other values than their present ones.
    pub(crate) fn keep_to(&mut self, inputs: &[usize]) {
        self.free.retain(|i| inputs.binary_search(i).is_ok());
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
        (image, self.initial.clone())
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

    /// True if the plant may draw random numbers: then its ways are more than those that are tried.
    pub fn has_chance(&self) -> bool {
        self.world.has_chance()
    }

    /// Makes all scans of a state that matter, and shows each to `see`, which tells whether to go on.
    pub fn expand(&mut self, here: Here<'_>, mut see: impl FnMut(Step<'_>) -> bool) -> Expanded {
        let (memory, own) = here.image.split_last().map_or((IDLE, &[][..]), |(m, own)| (*m, own));
        let mut work = std::mem::take(&mut self.work);
        self.world.put(own);
        let wants = |c: &Claim| self.open.iter().any(|(_, open)| *open == c);
        let from = Origin {
            memory,
            is_started: self.world.charts.is_started(),
            conflict: wants(&Claim::NoConflict),
            safety: wants(&Claim::NoUnsafe),
        };
        work.active.clear();
        work.active.extend(self.world.charts.active().map(|s| s.0));
        work.m.wait = if here.first { 0 } else { self.model.period };
        let mut done = Expanded { stuck: true, ..Expanded::default() };
        let is_rest = self.rest && here.first;
        self.find_places(&mut work);
        if !is_rest {
            done.gap = gap(&self.model.inputs, &work.places);
        }
        for way in self.world.ways() {
            if way > 0 {
                self.world.put(own);
            }
            let given = if self.tried == Tried::One { &self.initial } else { here.inputs };
            work.given.clear();
            work.given.extend_from_slice(given);
            let ticked = self.world.tick(work.m.wait, way, &mut work.given);
            // Without a draw every way is the first one.
            if way > 0 && !self.world.drew() {
                break;
            }
            if self.world.drew() {
                done.gap.get_or_insert(Gap::Chance);
            }
            if let Err(fault) = ticked {
                done.gap = Some(Gap::Plant(fault.kind));
                done.stuck = false;
                continue;
            }
            let inputs: &'a [Values] = &self.model.inputs;
            let lazy = !is_rest && matches!(self.tried, Tried::Classes | Tried::One);
            if lazy {
                work.tries.begin_read(&self.free, &work.given);
            } else {
                let places = if is_rest { &[][..] } else { &work.places };
                work.tries.begin(inputs, places, &work.given, false);
            }
            let (mut lazy, mut made) = (lazy, 0usize);
            while !done.stopped && work.tries.next(inputs, &mut work.m.inputs) {
                made += 1;
                done.stopped = made.is_multiple_of(PATIENCE) && self.stop.is_some_and(|stop| stop());
                if done.stopped {
                    break;
                }
                let trial = self.attempt(&from, &mut work, way, &mut done, &mut see);
                if lazy {
                    lazy = self.learn(&from, &mut work, &trial, &mut done);
                }
            }
        }
        self.work = work;
        done
    }

    /// Learns from a scan which inputs can make a difference. If they have too many combinations, those
    /// in which one of them differs are tried instead; gives false then.
    fn learn(&self, from: &Origin, work: &mut Work, trial: &Trial, done: &mut Expanded) -> bool {
        let inputs: &[Values] = &self.model.inputs;
        let Work { room, read, active, tries, places, given, .. } = work;
        match trial {
            // The assumptions have read what they need; no transition was judged.
            Trial::Refused => self.asking.read(&[], from.is_started, &[], room, read),
            Trial::Made => {
                self.asking.read(active, from.is_started, self.world.charts.cleared(), room, read);
            }
            Trial::Unknown => *read = self.asking.matter(&self.asking.asked(self.world.base())),
        }
        let gap = tries.read(inputs, |i| read.contains(i));
        done.gap = done.gap.or(gap.map(Gap::Values));
        if self.tried == Tried::One {
            places.clear();
            places.extend(self.free.iter().filter(|i| read.contains(**i)));
            tries.begin(inputs, places, given, true);
            // The first of these is the combination that was just made.
            tries.next(inputs, &mut work.m.inputs);
            return false;
        }
        let Some(count) = tries.too_many(inputs) else { return true };
        done.gap = Some(Gap::Combinations(count));
        let all = self.asking.matter(&self.asking.asked(self.world.base()));
        places.clear();
        places.extend(self.free.iter().filter(|i| all.contains(**i)));
        tries.begin(inputs, places, given, true);
        tries.next(inputs, &mut work.m.inputs);
        false
    }

    /// Tries one combination of inputs; the plant has made its scan before.
    fn attempt(
        &mut self,
        from: &Origin,
        work: &mut Work,
        way: u8,
        done: &mut Expanded,
        see: &mut impl FnMut(Step<'_>) -> bool,
    ) -> Trial {
        self.world.back();
        let now = self.world.charts.now().saturating_add(work.m.wait);
        if !self.model.assume.is_empty() {
            self.other.back_to(&self.world);
            if !allowed(self.model, &mut self.other, &work.m, now) {
                return Trial::Refused;
            }
        }
        done.scans += 1;
        work.shown.clear();
        if std::mem::replace(&mut done.stuck, false) {
            self.see_asked(&mut work.shown);
        }
        self.see_passes(from, now, work, done);
        let report = scan(self.p, &mut self.world.charts, &work.m.inputs, now);
        let scanned = Scanned { state: &self.world.charts, report };
        let is_cut = scanned.is_cut(self.p);
        done.cut |= is_cut;
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
        // Scans that agree in the inputs read before a fault have the same fault.
        if is_cut { Trial::Unknown } else { Trial::Made }
    }

    /// The places of the inputs that are tried in a state, where that is known before.
    fn find_places(&self, work: &mut Work) {
        let Work { places, read, .. } = work;
        places.clear();
        match self.tried {
            Tried::Matter => {
                *read = self.asking.matter(&self.asking.asked(&self.world.charts));
                places.extend(self.free.iter().filter(|i| read.contains(**i)));
            }
            Tried::All => places.extend_from_slice(&self.free),
            Tried::Classes | Tried::One => {}
        }
    }

    fn see_asked(&mut self, shown: &mut Vec<Shown>) {
        if !self.open.iter().any(|(_, c)| matches!(c, Claim::Asked(_))) {
            return;
        }
        let (asked, first) = (self.asking.asked(self.world.base()), self.p.tables().inputs.start);
        let is_asked = |c: &Claim| matches!(c, Claim::Asked(a) if asked.contains((a.0 - first) as usize));
        show(&mut self.open, shown, None, is_asked);
    }

    fn see_passes(&mut self, from: &Origin, now: i64, work: &mut Work, done: &mut Expanded) {
        if !from.conflict && !from.safety {
            return;
        }
        let inputs = &work.m.inputs;
        self.other.back_to(&self.world);
        let Passes { conflict, unsafe_, cut } =
            passes(self.p, &mut self.other.charts, inputs, now, from.conflict);
        done.cut_passes |= cut;
        if conflict || unsafe_ {
            // A fault in the same scan belongs to the run.
            self.other.back_to(&self.world);
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
        let Expander { open, model, world, .. } = self;
        let Work { shown, m, .. } = work;
        let before = shown.len();
        let claims = open.iter().copied();
        let kept = judge_each(model, claims, world, memory, m.wait, |question, seen| match seen {
            Ok(hit) => shown.extend(hit.then_some(Shown::Run { question, fault: None })),
            Err(fault) => shown.push(Shown::Unclear { question, fault }),
        });
        let new = shown.get(before..).unwrap_or(&[]);
        if !new.is_empty() {
            open.retain(|(question, _)| !new.iter().any(|s| s.question() == *question));
        }
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
