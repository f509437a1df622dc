//! The system is the engine: both run side by side from the start, 64 runs at once, with
//! random inputs, and agree on steps, variables, step times, faults and all questions.
//!
//! `charts.rs` has charts for one thing each, `endless.rs` searches that never end, `random.rs` random ones,
//! the conformance cases and the examples, `words.rs` the circuits by themselves.

mod charts;
mod endless;
mod random;
mod wide;
mod words;

use g7_engine::{Fault, FaultKind, State, StepId, scan};
use g7_equations::{Class, What};
use g7_model::{Document, FileId, ProfileName};

use super::value::Value;
use super::{Observed, Translated, system};
use crate::ask::{Asked, ask};
use crate::explore::Move;
use crate::look::{Scanned, allowed, in_some_pass, passes, shows};
use crate::model::Model;
use crate::monitor::{IDLE, is_of_scans, judge};
use crate::question::{Claim, Question};
use crate::sat::{Node, Signal, Values, evaluate};
use crate::world::World;

/// Runs side by side.
const LANES: usize = 64;

/// The amount that was compared.
#[derive(Clone, Copy, Debug, Default)]
struct Count {
    /// Charts.
    charts: usize,
    /// Pairs of a state and inputs that were compared.
    pairs: usize,
    /// Pairs behind which more passes or loops follow than were unrolled.
    uncovered: usize,
    /// Faults.
    faults: usize,
    /// Scans that showed what a question looks for.
    shown: usize,
    /// Charts with something that bits cannot express.
    limited: usize,
    /// Answers that an endless search leaves open.
    unsure: usize,
    /// Inputs that the assumptions forbid.
    forbidden: usize,
}

impl Count {
    fn add(&mut self, o: Count) {
        self.charts += o.charts;
        self.pairs += o.pairs;
        self.uncovered += o.uncovered;
        self.faults += o.faults;
        self.shown += o.shown;
        self.limited += o.limited;
        self.unsure += o.unsure;
        self.forbidden += o.forbidden;
    }
}

struct Rng(u64);

impl Rng {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
}

/// One of the runs.
struct Lane {
    state: State,
    memories: Vec<u64>,
    fresh: bool,
}

/// A chart with its system.
struct Pair<'m> {
    model: &'m Model<'m>,
    questions: &'m [Question],
    translated: Translated,
    /// By memory: no limit touches it.
    clear: Vec<bool>,
    /// By question: no limit touches it.
    sure: Vec<bool>,
    control: bool,
    touched: Vec<bool>,
}

fn signals(v: &Value) -> Vec<Signal> {
    match v {
        Value::Whole(w) => w.bits().to_vec(),
        Value::Real(bits) => bits.clone(),
        Value::Text(_) => Vec::new(),
    }
}

/// The word of a value in one lane; nothing for texts.
fn word_of(v: &Value, values: &Values, lane: usize) -> Option<u64> {
    let bit = |s: Signal| values.get(s) >> lane & 1 != 0;
    match v {
        Value::Whole(w) => Some(w.read(bit) as u64),
        Value::Real(bits) => Some((0..).zip(bits).fold(0, |v, (i, s)| v | u64::from(bit(*s)) << i)),
        Value::Text(_) => None,
    }
}

/// By node: some limit touches it.
fn touched(t: &Translated) -> Vec<bool> {
    let graph = &t.system.graph;
    let mut found = vec![false; graph.nodes().len()];
    t.unknown.iter().flat_map(|u| &u.bits).for_each(|s| found[s.node() as usize] = true);
    loop {
        for (i, node) in graph.nodes().iter().enumerate() {
            if let Node::And(a, b) = node {
                found[i] |= found[a.node() as usize] || found[b.node() as usize];
            }
        }
        let before = found.clone();
        for l in &t.system.latches {
            found[l.signal.node() as usize] |= found[l.next.node() as usize];
        }
        if found == before {
            return found;
        }
    }
}

impl<'m> Pair<'m> {
    fn new(model: &'m Model<'m>, questions: &'m [Question], observed: Observed) -> Pair<'m> {
        let translated = system(model, questions, observed);
        let touched = touched(&translated);
        let free = |list: &[Signal]| list.iter().all(|s| !touched[s.node() as usize]);
        let cells = translated.shown.cells.iter();
        let clear = cells.map(|c| free(&c.iter().flat_map(signals).collect::<Vec<_>>())).collect();
        let asked = translated.asked.iter();
        let sure = asked.map(|a| a.as_ref().is_ok_and(|a| free(&[a.bad, a.unsure]))).collect();
        // The end of the scan decides all the rest.
        let mut ends: Vec<Signal> = translated.faults.iter().map(|f| f.2).collect();
        ends.extend([translated.sound, translated.uncovered]);
        let control = free(&ends);
        Pair { model, questions, translated, clear, sure, control, touched }
    }

    /// Runs `scans` scans in each lane.
    fn run(&self, seed: u64, scans: usize) -> Result<Count, String> {
        let mut count = Count { charts: 1, ..Count::default() };
        count.limited = usize::from(!self.translated.unknown.is_empty());
        if !self.control {
            return Ok(count);
        }
        let p = &self.model.compiled.program;
        let sys = &self.translated.system;
        let mut rng = Rng(seed);
        let new = || Lane { state: State::new(p), memories: vec![IDLE; self.questions.len()], fresh: true };
        let mut lanes: Vec<Lane> = (0..LANES).map(|_| new()).collect();
        let start: Vec<u64> =
            sys.latches.iter().map(|l| if l.init.value() == Some(true) { u64::MAX } else { 0 }).collect();
        let mut latches = start.clone();
        let mut inputs: Vec<u64> = sys.inputs.iter().map(|_| rng.next()).collect();
        for _ in 0..scans {
            let calm = rng.next() % 3;
            for w in &mut inputs {
                let (a, b, c) = (rng.next(), rng.next(), rng.next());
                *w ^= match calm {
                    0 => a,
                    1 => a & b,
                    _ => a & b & c & rng.next(),
                };
            }
            let values = evaluate(&sys.graph, &latches, &inputs);
            let next: Vec<u64> = sys.latches.iter().map(|l| values.get(l.next)).collect();
            let (mut again, mut faulted) = (0u64, 0u64);
            for (k, lane) in lanes.iter_mut().enumerate() {
                let bits = inputs.iter().map(|w| w >> k & 1 != 0).collect();
                let mut m = self.translated.moves(&[bits]).remove(0);
                m.wait = if lane.fresh { 0 } else { self.model.period };
                let faults = count.faults;
                let goes_on = self.step(lane, &m, &values, k, &mut count)?;
                faulted |= u64::from(count.faults > faults) << k;
                if !goes_on {
                    *lane = new();
                    again |= 1 << k;
                }
            }
            if faulted != 0 {
                self.ended(&evaluate(&sys.graph, &next, &inputs), faulted)?;
            }
            latches = next.iter().zip(&start).map(|(n, s)| n & !again | s & again).collect();
        }
        Ok(count)
    }

    /// Nothing happens any more in the lanes that a fault has ended.
    fn ended(&self, values: &Values, faulted: u64) -> Result<(), String> {
        let asked = self.translated.asked.iter().flatten().flat_map(|a| [a.bad, a.unsure]);
        let some = asked.chain([self.translated.sound]).any(|s| values.get(s) & faulted != 0);
        if some { Err("a scan follows a fault".to_owned()) } else { Ok(()) }
    }

    /// One scan of one lane; gives whether it goes on.
    fn step(
        &self,
        lane: &mut Lane,
        m: &Move,
        v: &Values,
        k: usize,
        count: &mut Count,
    ) -> Result<bool, String> {
        let (p, t) = (&self.model.compiled.program, &self.translated);
        let bit = |s: Signal| v.get(s) >> k & 1 != 0;
        let now = lane.state.now().saturating_add(m.wait);
        let constrained = t
            .system
            .constraints
            .split_last()
            .map_or((true, true), |(last, numbers)| (numbers.iter().all(|c| bit(*c)), bit(*last)));
        if !constrained.0 {
            return Ok(false);
        }
        let may = self.model.assume.is_empty()
            || allowed(self.model, &mut World::of(self.model, lane.state.clone()), m, now);
        if may != constrained.1 {
            return Err(format!("the assumptions hold: {may} in the engine"));
        }
        if !may {
            count.forbidden += 1;
            return Ok(false);
        }
        if bit(t.uncovered) {
            count.uncovered += 1;
            return Ok(false);
        }
        lane.fresh = false;
        count.pairs += 1;
        let before = lane.state.clone();
        let report = scan(p, &mut lane.state, &m.inputs, now);
        self.same_end(&report.err(), bit)?;
        // The engine leaves an endless search in a pass of its own choice.
        let endless = report.is_err_and(|f| matches!(f.kind, FaultKind::Unstable { .. } | FaultKind::Bound));
        if !endless {
            self.same_steps(&lane.state, bit).map_err(|why| format!("{why}; {report:?}"))?;
        }
        if report.is_ok() {
            self.same_memories(&lane.state, v, k)?;
        } else {
            count.faults += 1;
        }
        self.same_outputs(&lane.state, v, k)?;
        let conflicts = self.questions.iter().any(|q| q.claim == Claim::NoConflict);
        let seen = passes(p, &mut before.clone(), &m.inputs, now, conflicts);
        let scanned = Scanned { state: &lane.state, report };
        let mut expected = Vec::new();
        for (q, memory) in self.questions.iter().zip(&lane.memories) {
            expected.push(match &q.claim {
                Claim::NoConflict => Some((*memory, seen.conflict)),
                Claim::NoUnsafe => Some((*memory, seen.unsafe_)),
                c if is_of_scans(c) && report.is_ok() => {
                    judge(self.model, c, &mut World::of(self.model, lane.state.clone()), *memory, m.wait)
                        .ok()
                        .map(|s| (s.memory, s.hit))
                }
                c if is_of_scans(c) => Some((*memory, false)),
                c => {
                    let cut = endless && in_passes(c);
                    let more = cut && in_some_pass(p, &mut before.clone(), &m.inputs, now, c);
                    Some((*memory, more || shows(p, c, &scanned)))
                }
            });
        }
        let rows = self.questions.iter().zip(&mut lane.memories).zip(expected).zip(&t.asked).zip(&self.sure);
        for ((((q, memory), expected), asked), sure) in rows {
            let Ok(asked) = asked else { continue };
            if !sure {
                continue;
            }
            match expected {
                None if bit(asked.unsure) => return Ok(false),
                None => return Err(format!("{:?} has no value in the engine", q.claim)),
                Some((kept, hit)) => {
                    *memory = kept;
                    // The scan before has shown it; this one is left in a pass of the engine's own choice.
                    if endless && matches!(q.claim, Claim::Active(s) if before.is_active(s)) {
                        continue;
                    }
                    if bit(asked.unsure) && endless && in_passes(&q.claim) {
                        // Further passes may show more; an end of the engine's own choice as well.
                        count.unsure += 1;
                        continue;
                    }
                    if bit(asked.unsure) || bit(asked.bad) != hit {
                        return Err(format!(
                            "{:?}: {hit} in the engine; unsure {}",
                            q.claim,
                            bit(asked.unsure)
                        ));
                    }
                    count.shown += usize::from(hit);
                }
            }
        }
        Ok(report.is_ok())
    }

    fn same_end(&self, fault: &Option<Fault>, bit: impl Fn(Signal) -> bool) -> Result<(), String> {
        let t = &self.translated;
        let mine: Vec<FaultKind> = t.faults.iter().filter(|f| bit(f.2)).map(|f| f.0).collect();
        let search = |k: &FaultKind| matches!(k, FaultKind::Unstable { .. } | FaultKind::Bound);
        let alike = match (fault, mine.as_slice()) {
            (None, []) => bit(t.sound),
            (Some(f), [one]) => !bit(t.sound) && (f.kind == *one || search(&f.kind) && search(one)),
            _ => false,
        };
        if alike { Ok(()) } else { Err(format!("{fault:?} in the engine, {mine:?} in the system")) }
    }

    fn same_steps(&self, s: &State, bit: impl Fn(Signal) -> bool) -> Result<(), String> {
        for (i, signal) in (0u32..).zip(&self.translated.steps) {
            if self.touched[signal.node() as usize] {
                continue;
            }
            let (mine, theirs) = (bit(*signal), s.is_active(StepId(i)));
            if mine != theirs {
                let name = self.model.compiled.symbols.step_path(StepId(i));
                return Err(format!("step {name}: {theirs} in the engine, {mine} in the system"));
            }
        }
        Ok(())
    }

    fn same_memories(&self, s: &State, v: &Values, k: usize) -> Result<(), String> {
        let shown = &self.translated.shown;
        let rows = shown.equations.memories.iter().zip(&shown.cells).zip(&shown.caps).zip(&self.clear);
        for (((m, cell), cap), clear) in rows {
            let theirs: Vec<u64> = match m.what {
                What::Variable(at) if m.class != Class::Scratch => {
                    let from = at.0 as usize;
                    s.words().get(from..from + cell.len()).unwrap_or(&[]).to_vec()
                }
                What::StepTime(step) | What::StepScans(step) => {
                    let scans = self.model.compiled.program.tables().rules.scan_clock;
                    if scans != matches!(m.what, What::StepScans(_)) {
                        continue;
                    }
                    vec![s.step_time(&self.model.compiled.program, step) as u64]
                }
                _ => continue,
            };
            if !clear {
                continue;
            }
            // As in the latches: beyond the cap all are alike.
            let short = |w: u64| cap.map_or(w, |c| if (w as i64) < 0 { w } else { w.min(c as u64) });
            for (value, word) in cell.iter().zip(theirs) {
                let Some(mine) = word_of(value, v, k) else { continue };
                if short(mine) != short(word) {
                    return Err(format!(
                        "{:?} {:?}: {word} in the engine, {mine} in the system",
                        m.what, m.ty
                    ));
                }
            }
        }
        Ok(())
    }

    fn same_outputs(&self, s: &State, v: &Values, k: usize) -> Result<(), String> {
        let shown = &self.translated.shown;
        for (id, at, values) in &self.translated.outputs {
            if self.clear.get(id.0 as usize) != Some(&true) {
                continue;
            }
            if shown.caps.get(id.0 as usize).copied().flatten().is_some() {
                continue;
            }
            for (i, value) in values.iter().enumerate() {
                let Some(mine) = word_of(value, v, k) else { continue };
                let theirs = s.words().get(at.0 as usize + i).copied().unwrap_or(0);
                if mine != theirs {
                    return Err(format!("output at {at:?}: {theirs} in the engine, {mine} in the system"));
                }
            }
        }
        Ok(())
    }
}

/// Claims about what happens within a scan, in any of its passes.
fn in_passes(claim: &Claim) -> bool {
    use Claim::{Active, Clears, NoConflict, NoUnsafe, Runs};
    matches!(claim, Active(_) | Clears(_) | Runs(_) | NoConflict | NoUnsafe)
}

fn parsed(text: &str) -> Document {
    let (document, problems) = g7_syntax::parse(text, FileId(0));
    assert!(problems.is_empty(), "{problems:?}\n{text}");
    document
}

fn asked(document: &Document, profile: Option<ProfileName>) -> Option<Asked> {
    let own = document.profile().map(|d| d.name).unwrap_or_default();
    ask(document, profile.filter(|p| *p != own)).0
}

fn side_by_side(asked: &Asked, observed: Observed, seed: u64, scans: usize) -> Result<Count, String> {
    let model = Model::new(&asked.compiled, asked.assume.clone());
    Pair::new(&model, &asked.questions, observed).run(seed, scans)
}
