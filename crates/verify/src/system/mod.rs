//! A chart's equations as a transition system of bits, for the SAT layer.
//!
//! ```text
//! Model, Question -> equations::Equations -> range (how many bits a memory needs)
//!                                         -> latches, moves (state, inputs)
//!                                         -> scan, exec, expr, word (one scan)
//!                                         -> claims, traps (what each question looks for) -> Translated
//! ```
//!
//! One step of the system is one scan, as in `model.rs`: the inputs of the step are those of
//! the scan, the latches the memories that last. The reference is `equations::Machine`; tests
//! compare the system with the engine itself.
//!
//! # Invariants
//!
//! - What cannot be expressed (arithmetic of floating point, texts, large products) is any
//!   value of its type, from inputs of its own, and has a [`Limit`]. So the system has every
//!   run of the chart and perhaps more: what it never reaches, the chart never reaches; a run
//!   that it shows is repeated with `engine::scan` before it counts ([`crate::replay`]).
//! - Passes and loops are unrolled up to bounds. Where more could follow, the signal "unsure"
//!   of each question is 1 and no scan follows. A search for stability that comes back to a
//!   state is the fault that it is in the engine.
//! - Behind a fault no scan follows.
//! - Times are numbers of periods where all that is added to them is, and end where nothing
//!   tells longer ones apart (`range.rs` says why that is exact).

mod claims;
mod exec;
mod expr;
mod latches;
mod limit;
mod moves;
pub(crate) mod needs;
mod parts;
mod places;
pub(crate) mod range;
mod scan;
#[cfg(test)]
mod tests;
mod traps;
mod value;
mod word;

use std::collections::BTreeSet;

use g7_compile::ir::VarClass;
use g7_engine::{Addr, FaultKind, NONE, StepId, Tables};
use g7_equations::{Equations, MemoryId, Options, What, equations};
use g7_model::Span;

pub(crate) use claims::Asked;
pub(crate) use traps::Follows;

use crate::explore::Move;
use crate::look::sides;
use crate::model::Model;
use crate::question::{Claim, Question};
use crate::reason::Reason;
use crate::sat::{Cube, Init, Node, Signal, System};
use claims::End;
use exec::Exec;
use latches::Latches;
use limit::{Limit, Unknown};
use moves::{Source, Sources};
use scan::Scan;
pub(crate) use value::{Value, same};

/// How exact the outputs are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Observed {
    /// As exact as the chart and its questions need.
    Asked,
    /// The outputs as they are, for a comparison of two charts.
    Outputs,
    /// All outputs and variables as they are, for a comparison with the engine.
    #[cfg_attr(not(test), expect(dead_code, reason = "it is compared in the tests"))]
    All,
}

/// A chart as a transition system.
pub(crate) struct Translated {
    /// The system. Its list of bad signals is empty.
    pub(crate) system: System,
    /// For each question its signals, or why it cannot be asked in this way.
    pub(crate) asked: Vec<Result<Asked, Reason>>,
    /// For each question about what can follow its signals.
    pub(crate) follows: Vec<Option<Follows>>,
    /// Latches that make a number together, the lowest bit first.
    pub(crate) words: Vec<Vec<Signal>>,
    /// The scan has ended without a fault, and no earlier one had any.
    pub(crate) sound: Signal,
    /// 1 in the scans behind one that a fault has ended.
    pub(crate) stopped: Signal,
    /// The faults, each with the signal that it is the one that ends the scan.
    pub(crate) faults: Vec<(FaultKind, Span, Signal)>,
    /// The scan has more passes or loops than were unrolled.
    pub(crate) uncovered: Signal,
    /// The outputs behind the scan, safe ones behind a fault.
    pub(crate) outputs: Vec<(MemoryId, Addr, Vec<Value>)>,
    /// Situations, as a scan begins, that are thought never to be reached: two steps of a sequence, or none.
    pub(crate) candidates: Vec<Cube>,
    /// Activity of each step behind the scan.
    pub(crate) steps: Vec<Signal>,
    /// For each pass but the first: the scan makes it.
    pub(crate) passes: Vec<Signal>,
    #[cfg_attr(not(test), expect(dead_code, reason = "it is compared in the tests"))]
    shown: Shown,
    sources: Sources,
    unknown: Vec<Unknown>,
}

/// The values that the tests compare with the engine.
#[cfg_attr(not(test), expect(dead_code, reason = "it is compared in the tests"))]
struct Shown {
    equations: Equations,
    cells: Vec<Vec<Value>>,
    caps: Vec<Option<i128>>,
}

impl Translated {
    /// The bits of [`System::inputs`] that stand for a word of the chart's inputs, by its place.
    pub(crate) fn bits(&self, place: usize) -> &[usize] {
        self.sources.words.get(place).map_or(&[], Source::bits)
    }

    /// The moves of a trace of the system: for each scan the values of [`System::inputs`].
    pub(crate) fn moves(&self, trace: &[Vec<bool>]) -> Vec<Move> {
        self.sources.moves(trace)
    }

    /// The limits that these signals depend on, over all scans.
    pub(crate) fn limits(&self, of: &[Signal]) -> Vec<&Limit> {
        let cone = cone(&self.system, of);
        let touched = |u: &&Unknown| u.bits.iter().any(|b| cone.get(b.node() as usize) == Some(&true));
        let mut found: Vec<&Limit> = self.unknown.iter().filter(touched).map(|u| &u.limit).collect();
        found.dedup();
        found
    }
}

/// The nodes that signals depend on, in this step and those before; constraints are left out.
fn cone(system: &System, of: &[Signal]) -> Vec<bool> {
    let mut found = vec![false; system.graph.nodes().len()];
    let mut work: Vec<Signal> = of.to_vec();
    while let Some(s) = work.pop() {
        if found.get_mut(s.node() as usize).is_none_or(|f| std::mem::replace(f, true)) {
            continue;
        }
        match system.graph.node(s) {
            Node::And(a, b) => work.extend([a, b]),
            Node::Latch(i) => work.extend(system.latches.get(i as usize).map(|l| l.next)),
            Node::False | Node::Input(_) => {}
        }
    }
    found
}

/// The system of a chart, with the signals of its questions.
pub(crate) fn system(model: &Model<'_>, questions: &[Question], observed: Observed) -> Translated {
    translate(model, questions, observed, &|| false).0
}

/// The same, or nothing if the caller wants no more before the system is whole.
pub(crate) fn system_until(
    model: &Model<'_>,
    questions: &[Question],
    observed: Observed,
    stop: &(dyn Fn() -> bool + Sync),
) -> Option<Translated> {
    let (translated, whole) = translate(model, questions, observed, stop);
    whole.then_some(translated)
}

/// The system, and true if it is whole: the caller has not wanted to stop.
fn translate(
    model: &Model<'_>,
    questions: &[Question],
    observed: Observed,
    stop: &(dyn Fn() -> bool + Sync),
) -> (Translated, bool) {
    let e = equations(model.compiled, Options { conflicts: true, runs: true, ..Options::default() });
    let t = model.compiled.program.tables();
    let ranges = needs::ranges(&e, model, |what| is_observed(model, questions, observed, what));
    let mut system = System::default();
    let (latches, cells) = Latches::new(&e, &ranges, &mut system);
    let mut sources = Sources::new(model);
    let known = e.by_meaning();
    let latch = |what| match cells.get(known.get(&what)?.0 as usize)?.first()? {
        Value::Whole(w) => {
            w.bits().first().copied().filter(|b| matches!(system.graph.node(*b), Node::Latch(_)))
        }
        Value::Real(_) | Value::Text(_) => None,
    };
    let candidates = candidates(t, latch);
    let mut x = Exec::new(&e, model, cells, system).until(stop);
    for (id, m, at) in moves::inputs(&e) {
        let value = sources.memory(model, &mut x.system, m, at);
        x.put(id, value);
    }
    if let Some(dt) = e.find(What::Dt) {
        let started = x.holds(e.find(What::Started));
        let bits = vec![started, Signal::FALSE];
        x.put(dt, vec![Value::Whole(word::Word::of(bits, model.period.into(), 0, 1))]);
    }
    let before = x.steps();
    let stopped = x.system.latch(Init::Zero);
    let asks = questions.iter().any(|q| q.claim == Claim::NoConflict);
    let rivals = if asks { rivals(t) } else { Vec::new() };
    let watched = questions.iter().filter_map(|q| match q.claim {
        Claim::Active(s) => e.find(What::Step(s)),
        Claim::Runs(rank) => e.find(What::Ran(rank)),
        _ => None,
    });
    let mut scan = Scan::new(&mut x, rivals, watched.collect());
    scan.run(|x| assume(x, model, stopped));
    let sights = scan.sights;
    let mut end = End::new(&mut x, &sights, stopped);
    let (mut asked, mut follows) = (Vec::new(), Vec::new());
    for q in questions {
        let found = traps::follows(&mut end, &q.claim, &before);
        follows.push(found.map(|(_, f)| f));
        asked.push(found.map_or_else(|| end.asked(&q.claim), |(a, _)| Ok(a)));
    }
    latches.take_over(&mut x);
    let words = latches.words();
    let run = x.run;
    let over = x.g().or(stopped, !run);
    x.system.set_next(stopped, over);
    let output = |(id, words): &(MemoryId, Box<[u64]>)| match e.memory(*id)?.what {
        What::Variable(at) => Some((*id, at, latches::safe(&mut x, *id, words))),
        _ => None,
    };
    let outputs = e.safe.iter().filter_map(output).collect();
    let steps = x.steps();
    let uncovered = x.uncovered.clone();
    let uncovered = x.g().any(uncovered);
    let sound = x.g().and(run, !stopped);
    let caps = (0..e.memories.len() as u32).map(|m| ranges.cap_of(MemoryId(m))).collect();
    let (cells, faults) = (x.cells().to_vec(), x.faults.clone());
    let (system, unknown) = (std::mem::take(&mut x.system), std::mem::take(&mut x.unknown));
    let whole = !x.given_up();
    drop(x);
    let shown = Shown { equations: e, cells, caps };
    let translated = Translated {
        system,
        asked,
        follows,
        words,
        sound,
        stopped,
        faults,
        uncovered,
        outputs,
        candidates,
        steps,
        passes: sights.passes,
        shown,
        sources,
        unknown,
    };
    (translated, whole)
}

/// The sequences of `places.rs`, as a scan begins: two steps of one are not active at once, and from the first scan
/// on one of them is; none is active before.
fn candidates(t: &Tables, latch: impl Fn(What) -> Option<Signal>) -> Vec<Cube> {
    let step = |s: u32| latch(What::Step(StepId(s)));
    let cube = |mut signals: Cube| {
        signals.sort_unstable();
        signals
    };
    let sequences = places::sequences(t);
    let pairs = places::exclusive(&sequences);
    let steps: BTreeSet<u32> = pairs.iter().flat_map(|(a, b)| [*a, *b]).collect();
    let started = latch(What::Started);
    let fresh = steps.into_iter().filter_map(|s| Some(cube(vec![!started?, step(s)?])));
    let left = sequences.iter().filter_map(|set| {
        let steps = set.iter().map(|s| Some(!step(*s)?));
        Some(cube(steps.chain([started]).collect::<Option<_>>()?))
    });
    fresh
        .chain(left)
        .chain(pairs.iter().filter_map(|(a, b)| Some(cube(vec![step(*a)?, step(*b)?]))))
        .collect()
}

/// The assumptions bind the inputs, unless the scan has met a fault before the evolution.
fn assume(x: &mut Exec<'_>, model: &Model<'_>, stopped: Signal) {
    let t = model.compiled.program.tables();
    let all = x.glance(|x| {
        // An output that follows one step is on as soon as the step is, in the initial situation too.
        for (i, step) in (0u32..).zip(&t.steps).filter(|(_, s)| s.direct.0 != NONE) {
            let active = x.holds(x.e.find(What::Step(StepId(i))));
            if let Some(output) = x.e.find(What::Variable(step.direct)) {
                x.put(output, vec![Value::truth(active)]);
            }
        }
        let mut all = Vec::new();
        for q in &model.assume {
            let (holds, without) = claims::value_of(x, *q);
            all.push(holds);
            all.push(!without);
        }
        all
    });
    let (all, run) = (x.g().all(all), x.run);
    let free = x.g().or(stopped, !run);
    let constraint = x.g().or(all, free);
    x.system.constraints.push(constraint);
}

/// Pairs of transitions that share a preceding step, where nothing written chooses: as
/// `look.rs` says.
fn rivals(t: &Tables) -> Vec<(u32, u32)> {
    let follows = !t.rules.multi_token || t.rules.numbered_exclusive;
    let shared: Vec<(u32, u32, Vec<u32>)> = (0u32..)
        .zip(&t.transitions)
        .filter(|(_, tr)| tr.shares)
        .map(|(rank, tr)| (rank, tr.priority, sides(t, rank).0))
        .collect();
    let mut pairs = Vec::new();
    for (i, (a, first, from)) in shared.iter().enumerate() {
        for (b, second, other) in shared.iter().skip(i + 1) {
            let chosen = follows && first != second;
            if !chosen && from.iter().any(|s| other.contains(s)) {
                pairs.push((*a, *b));
            }
        }
    }
    pairs
}

/// True for memories that are looked at from outside, so that they are kept as they are.
fn is_observed(model: &Model<'_>, questions: &[Question], observed: Observed, what: What) -> bool {
    let What::Variable(at) = what else { return false };
    let class = || model.compiled.symbols.variable_at(at).map(|v| v.class);
    match observed {
        Observed::Asked => questions.iter().any(|q| q.claim == Claim::On(at)),
        Observed::Outputs => class() == Some(VarClass::Output),
        Observed::All => class().is_some_and(|c| c != VarClass::Const),
    }
}
