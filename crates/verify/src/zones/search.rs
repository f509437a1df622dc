//! The search by zones: visits the nodes of the graph, which are sets of states, breadth first, and answers
//! the questions about them.

mod traps;

use super::clocks::{Clocks, Moved, Shape};
use super::graph::{Edge, Graph};
use super::matrix::{From, Span, Zone};
use super::sights::{Eye, Sight};
use super::turns::Turn;
use crate::asked::{Asking, Places, Room};
use crate::expand::Gap;
use crate::explore::Move;
use crate::layer::Budget;
use crate::model::Model;
use crate::monitor::{IDLE, has_memory};
use crate::outcome::{Outcome, asks_for_traps};
use crate::question::{Claim, Question};
use crate::reason::Reason;
use crate::tries;
use crate::verdict::{Certificate, Run, Verdict};
use crate::world::World;

/// Nodes, and combinations of inputs of a node, between two questions whether to stop.
const PATIENCE: usize = 64;

pub(super) struct Search<'a> {
    pub(super) model: &'a Model<'a>,
    budget: &'a Budget<'a>,
    pub(super) asking: Asking,
    /// The places of all inputs.
    places: Vec<usize>,
    /// Room to tell what a scan has read.
    room: (Room, Places),
    /// Questions without an answer, with their numbers.
    pub(super) open: Vec<(usize, &'a Question)>,
    answers: Vec<(usize, Verdict)>,
    clocks: Clocks<'a>,
    eye: Eye<'a>,
    pub(super) graph: Graph,
    /// For each node: the inputs of the scan that led there.
    inputs: Vec<Vec<u64>>,
    /// For each node that had its turn, where it leads; empty if no question asks for that.
    pub(super) turns: Vec<Turn>,
    asks_for_traps: bool,
    scans: usize,
    depth: usize,
    /// Why not all runs were seen.
    hole: Option<Reason>,
    cut: bool,
    cut_passes: bool,
}

/// The states of a node that lie between the same bounds at the next scan.
struct Part {
    zone: Zone,
    limits: Vec<Span>,
}

/// The moves of a part.
struct Tries<'n> {
    at: usize,
    shape: &'n Shape,
    part: &'n Part,
    /// Scans of the period that go by before the scan: none before the first one of all.
    elapse: i64,
    /// The images with the least and with the greatest values; the other is empty where they are the same.
    images: [Vec<u64>; 2],
    asked: Places,
    /// The active steps before the scan.
    active: Vec<u32>,
    is_started: bool,
    tried: bool,
}

/// The end of a try with one combination of inputs.
enum Trial {
    /// No question is left.
    Over,
    /// The assumptions do not allow it.
    Refused,
    /// A scan was made, which cleared these transitions.
    Made(Vec<u32>),
    /// A scan was made, of which less is known.
    Unknown,
}

impl<'a> Search<'a> {
    /// A search for the answers to questions of which at most one remembers something; `None` where there
    /// are no clocks.
    pub(super) fn new(
        model: &'a Model<'a>,
        budget: &'a Budget<'a>,
        open: Vec<(usize, &'a Question)>,
    ) -> Option<Search<'a>> {
        let mut image = Vec::new();
        World::new(model).image(&mut image);
        let memory = open.iter().map(|(_, q)| &q.claim).find(|c| has_memory(c));
        let clocks = Clocks::new(model, memory.map(|c| (c, image.len())));
        if clocks.is_empty() {
            return None;
        }
        image.push(IDLE);
        let graph = Graph::new(&clocks.start(image)?);
        let initial = model.inputs.iter().map(|v| v.tried.first().copied().unwrap_or(0)).collect();
        Some(Search {
            model,
            budget,
            asking: Asking::new(&model.compiled.program, model.codes()),
            places: (0..model.inputs.len()).collect(),
            room: Default::default(),
            asks_for_traps: open.iter().any(|(_, q)| asks_for_traps(&q.claim)),
            open,
            answers: Vec::new(),
            clocks,
            eye: Eye::new(model, memory),
            graph,
            inputs: vec![initial],
            turns: Vec::new(),
            scans: 0,
            depth: 0,
            hole: None,
            cut: false,
            cut_passes: false,
        })
    }

    /// Searches, and answers all questions.
    pub(super) fn run(mut self) -> Vec<(usize, Verdict)> {
        let (mut at, mut level) = (0usize, 1usize);
        while at < self.graph.nodes.len() && !self.open.is_empty() {
            if at == level {
                self.depth += 1;
                level = self.graph.nodes.len();
            }
            if let Some(hole) = self.bound(at) {
                self.hole = Some(hole);
                break;
            }
            if !self.expand(at) {
                break;
            }
            at += 1;
        }
        self.depth += usize::from(at >= self.graph.nodes.len());
        if self.hole.is_none() && self.asks_for_traps {
            self.traps();
        }
        self.close();
        self.answers
    }

    /// Why the search is to stop here.
    fn bound(&self, at: usize) -> Option<Reason> {
        let bytes = self.graph.bytes() + self.graph.nodes.len() * self.model.inputs.len() * 8;
        let full = self.budget.full(self.graph.nodes.len(), bytes);
        full.or_else(|| at.is_multiple_of(PATIENCE).then(|| self.stopped()).flatten())
    }

    fn stopped(&self) -> Option<Reason> {
        self.budget.over(self.scans)
    }

    /// Tries all moves of a node; false if it was stopped meanwhile.
    fn expand(&mut self, at: usize) -> bool {
        let mut turn = Turn::default();
        let Some(node) = self.graph.nodes.get(at).filter(|n| n.covered.is_none()) else {
            self.turns.push(turn);
            return true;
        };
        let (shape, elapse) = (self.graph.shape(node), i64::from(at != 0));
        let later = node.zone.later(elapse);
        for part in self.parts(&shape, &later) {
            let before = |values: Vec<i64>| values.into_iter().map(|v| v - elapse).collect::<Vec<_>>();
            let (least, greatest) = (before(part.zone.least()), before(part.zone.greatest()));
            let mut images = [Vec::new(), Vec::new()];
            self.clocks.image(&shape, &least, &mut images[0]);
            if least != greatest {
                self.clocks.image(&shape, &greatest, &mut images[1]);
            }
            self.eye.world.put(&images[0]);
            let asked = self.asking.asked(&self.eye.world.charts);
            let charts = &self.eye.world.charts;
            let (active, is_started) = (charts.active().map(|s| s.0).collect(), charts.is_started());
            let (shape, part) = (&shape, &part);
            let mut tries =
                Tries { at, shape, part, elapse, images, asked, active, is_started, tried: false };
            turn.begin_part();
            if !self.vectors(&mut tries, &mut turn) {
                return false;
            }
        }
        self.turns.push(if self.asks_for_traps { turn } else { Turn::default() });
        true
    }

    /// The parts of a zone, which has gone on to the next scan.
    fn parts(&self, shape: &Shape, later: &Zone) -> Vec<Part> {
        let mut parts = vec![Part { zone: later.clone(), limits: Vec::new() }];
        for clock in 0..later.clocks() {
            let split = |part: Part| {
                let intervals = self.clocks.intervals(shape, clock, part.zone.span(clock));
                intervals.into_iter().filter_map(move |interval| {
                    let limits = [&part.limits[..], &[interval]].concat();
                    Some(Part { zone: part.zone.within(&limits)?, limits })
                })
            };
            parts = parts.into_iter().flat_map(split).collect();
        }
        parts
    }

    /// Tries all inputs of a part; false if it was stopped meanwhile.
    fn vectors(&mut self, tries: &mut Tries<'_>, turn: &mut Turn) -> bool {
        let last = self.inputs.get(tries.at).cloned().unwrap_or_default();
        let all = &self.model.inputs;
        let mut vectors = tries::Tries::default();
        vectors.begin_read(&self.places, &last);
        let mut m = Move { inputs: Vec::new(), wait: tries.elapse * self.model.period };
        let (mut made, mut lazy) = (0usize, true);
        while vectors.next(all, &mut m.inputs) {
            if made.is_multiple_of(PATIENCE)
                && made > 0
                && let Some(hole) = self.stopped()
            {
                self.hole = Some(hole);
                return false;
            }
            made += 1;
            let trial = self.attempt(tries, turn, &m);
            if matches!(trial, Trial::Over) {
                return true;
            }
            lazy = lazy && self.learn(tries, &mut vectors, &trial, &last);
        }
        if !tries.tried {
            self.hole.get_or_insert(Reason::NoInput(self.depth));
        }
        true
    }

    /// Learns from a scan which inputs can make a difference. If they have too many combinations, those
    /// in which one of them differs are tried instead; gives false then.
    fn learn(&mut self, tries: &Tries<'_>, vectors: &mut tries::Tries, trial: &Trial, last: &[u64]) -> bool {
        let inputs = &self.model.inputs;
        let (room, read) = &mut self.room;
        match trial {
            // The assumptions have read what they need; no transition was judged.
            Trial::Refused => self.asking.read(&[], tries.is_started, &[], room, read),
            Trial::Made(cleared) => self.asking.read(&tries.active, tries.is_started, cleared, room, read),
            Trial::Unknown | Trial::Over => *read = self.asking.matter(&tries.asked),
        }
        let open = vectors.read(inputs, |i| read.contains(i)).map(Gap::Values);
        let count = vectors.too_many(inputs);
        if let Some(gap) = open.or(count.map(Gap::Combinations)) {
            self.hole.get_or_insert(gap.reason(self.model));
        }
        if count.is_none() {
            return true;
        }
        let all: Vec<usize> = self.asking.matter(&tries.asked).iter().collect();
        vectors.begin(inputs, &all, last, true);
        // The first of these is the combination that was made before all others.
        vectors.next(inputs, &mut Vec::new());
        false
    }

    /// Makes one move of a part.
    fn attempt(&mut self, tries: &mut Tries<'_>, turn: &mut Turn, m: &Move) -> Trial {
        let [image, other] = &tries.images;
        let may = self.eye.allows(image, m);
        if !other.is_empty() && self.eye.allows(other, m) != may {
            self.disagree();
        }
        if !may {
            return Trial::Refused;
        }
        if !std::mem::replace(&mut tries.tried, true) {
            self.see_asked(tries, m);
        }
        self.scans += 1;
        let mut after = Vec::new();
        let sight = self.eye.see(image, m, &self.open, &mut after);
        let scanned = tries.part.zone.least();
        let moved =
            if sight.fault().is_none() { self.clocks.moved(after, tries.shape, &scanned) } else { None };
        if !other.is_empty() {
            self.scans += 1;
            let mut after = Vec::new();
            let again = self.eye.see(other, m, &self.open, &mut after);
            let scanned = tries.part.zone.greatest();
            let same = sight.fault().is_some() || self.clocks.moved(after, tries.shape, &scanned) == moved;
            if again != sight || !same {
                self.disagree();
            }
        }
        if sight.fault().is_some() && !self.model.slice.is_whole() {
            // The chart may go on where its slice does not.
            self.hole.get_or_insert(Reason::NotRepeated);
        }
        self.cut |= sight.cut;
        self.cut_passes |= sight.cut_passes;
        self.settle(tries, m, &sight);
        if self.open.is_empty() {
            return Trial::Over;
        }
        let to = match moved {
            Some(moved) => Some(self.lead(tries, moved, m)),
            None if sight.fault().is_none() => {
                self.disagree();
                None
            }
            None => None,
        };
        turn.add(sight.on, to);
        if sight.cut { Trial::Unknown } else { Trial::Made(sight.cleared) }
    }

    /// Notes that a time was read in a way that is not understood.
    fn disagree(&mut self) {
        self.hole.get_or_insert(Reason::Times);
    }

    /// The node behind a move, and whether it is the same one because time has gone on in it.
    fn lead(&mut self, tries: &Tries<'_>, moved: Moved, m: &Move) -> (u32, bool) {
        let Moved { shape, to } = moved;
        let stays = |(i, from): (usize, &From)| *from == From::Old(i);
        let repeats =
            tries.elapse > 0 && shape == *tries.shape && !to.is_empty() && to.iter().enumerate().all(stays);
        let zone = tries.part.zone.moved(&to);
        let limits = tries.part.limits.clone();
        // A zone that is not empty is not empty later.
        let zone = if repeats { zone.ever_later().within(&limits).unwrap_or(zone) } else { zone };
        let edge = Edge { inputs: m.inputs.clone(), limits, to, repeats };
        let number = self.graph.add(&shape, zone, Some((tries.at as u32, edge)), tries.at + 1);
        if number as usize == self.inputs.len() {
            self.inputs.push(m.inputs.clone());
        }
        (number, repeats && number as usize == tries.at)
    }

    fn see_asked(&mut self, tries: &Tries<'_>, m: &Move) {
        let first = self.model.compiled.program.tables().inputs.start;
        let asks = |a: u32| tries.asked.iter().any(|i| i as u32 + first == a);
        let hits: Vec<usize> = self
            .open
            .iter()
            .filter(|(_, q)| matches!(&q.claim, Claim::Asked(a) if asks(a.0)))
            .map(|(i, _)| *i)
            .collect();
        if !hits.is_empty()
            && let Some(run) = self.path(tries, m)
        {
            hits.into_iter().for_each(|i| self.show(i, &run));
        }
    }

    /// Answers the questions of which a scan shows something.
    fn settle(&mut self, tries: &Tries<'_>, m: &Move, sight: &Sight) {
        for (i, fault) in &sight.without {
            self.give(*i, Verdict::Open(self.outcome().so_far(Reason::Condition(*fault))));
        }
        if sight.hits.is_empty() {
            return;
        }
        let Some(run) = self.path(tries, m) else {
            self.disagree();
            return;
        };
        let run = Run { fault: sight.fault(), ..run };
        sight.hits.iter().for_each(|i| self.show(*i, &run));
    }

    /// A run to a part, with a move of it.
    fn path(&self, tries: &Tries<'_>, m: &Move) -> Option<Run> {
        let node = self.graph.nodes.get(tries.at)?;
        let target = tries.part.zone.later(-tries.elapse).and(&node.zone)?;
        let mut run = self.graph.run(tries.at as u32, &target, self.model.period)?;
        run.moves.push(m.clone());
        Some(run)
    }

    /// Answers a question with a run, if the run does the same again.
    pub(super) fn show(&mut self, i: usize, run: &Run) {
        let Some((_, q)) = self.open.iter().find(|(n, _)| *n == i) else { return };
        let verdict = self.outcome().shown(self.model, &q.claim, run.clone());
        self.give(i, verdict);
    }

    pub(super) fn give(&mut self, i: usize, verdict: Verdict) {
        self.open.retain(|(n, _)| *n != i);
        self.answers.push((i, verdict));
    }

    /// Answers what is left over.
    fn close(&mut self) {
        let certificate = Certificate::Zones { zones: self.graph.met().count(), scans: self.scans };
        let end = self.outcome();
        for (i, q) in std::mem::take(&mut self.open) {
            self.answers.push((i, end.without_run(&q.claim, certificate.clone())));
        }
    }

    /// How far the search has come; its states are nodes.
    pub(super) fn outcome(&self) -> Outcome {
        Outcome {
            states: self.graph.nodes.len(),
            scans: self.scans,
            depth: self.depth,
            hole: self.hole.clone(),
            cut: self.cut,
            cut_passes: self.cut_passes,
        }
    }
}
