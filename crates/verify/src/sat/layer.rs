//! The SAT layer: answers the questions of a chart by its system of bits, those about one scan and those
//! about all that can follow.

use g7_engine::{State, scan};

use crate::asked::Asking;
use crate::explicit::threads;
use crate::explore::Move;
use crate::layer::{Budget, Layer, undecided};
use crate::look::replay;
use crate::model::Model;
use crate::question::{Claim, Question};
use crate::reason::Reason;
use crate::sat::dead::{Ends, ends};
use crate::sat::decide::{Effort, Found, Proof, decide_with};
#[cfg(not(target_family = "wasm"))]
use crate::sat::diagram::{Effort as Sets, diagram};
use crate::sat::graph::Signal;
use crate::sat::needs::Needs;
use crate::sat::simulate::Trace;
use crate::sat::stays::is_trap;
use crate::sat::traps::{Clauses, Trap, Way, traps};
use crate::sat::wide::{Wanted, wide};
use crate::system::{Asked, Follows, Observed, Translated, system_until};
use crate::verdict::{Certificate, Evidence, Open, Run, Verdict, is_open};

/// Scans of the search for all states in the turn [`FEWEST`], of a system with [`SMALL`] nodes; larger ones have
/// fewer, and each turn more allows twice as many.
const SCANS: usize = 2_000_000;
const SMALL: usize = 1000;
/// Nodes for the sets of states in the turn [`FEWEST`]. Each later turn allows twice as many, up to `MOST`: a call of
/// the library cannot be stopped, and with more nodes it may take longer than seconds.
#[cfg(not(target_family = "wasm"))]
const ROOM: usize = 1 << 18;
#[cfg(not(target_family = "wasm"))]
const MOST: usize = 1 << 21;
/// Ticks in which the solver checks a set, in the turn [`FEWEST`].
#[cfg(not(target_family = "wasm"))]
const CHECK: u64 = 1 << 20;
/// The first turn in which all states are searched for, and the last in which more are than before.
const FEWEST: u32 = 9;
const TURNS: u32 = 30;

/// Bounded search, induction and PDR as a layer, and the search for all states where these find nothing.
#[derive(Clone, Copy, Debug)]
pub struct Satisfiability {
    /// Most turns, each with twice the work of the one before.
    pub turns: u32,
}

impl Default for Satisfiability {
    /// As many turns as the time allows.
    fn default() -> Satisfiability {
        Satisfiability { turns: 40 }
    }
}

impl Layer for Satisfiability {
    fn name(&self) -> &'static str {
        "sat"
    }

    fn answer(
        &self,
        model: &Model<'_>,
        questions: &[Question],
        answers: &mut [Option<Verdict>],
        budget: &Budget<'_>,
    ) {
        let (open, mine): (Vec<usize>, Vec<Question>) =
            undecided(questions, answers).into_iter().map(|(i, q)| (i, q.clone())).unzip();
        // A plant is no part of the system of bits.
        if mine.is_empty() || model.plant.is_some() {
            return;
        }
        let Some(translated) = system_until(model, &mine, Observed::Asked, budget.stop) else { return };
        let effort = Effort { bytes: budget.bytes, turns: self.turns, stop: budget.stop };
        let work = Work { model, translated: &translated, effort: &effort, budget };
        for (i, verdict) in open.iter().zip(work.verdicts(&mine)) {
            if let Some(slot) = answers.get_mut(*i) {
                *slot = Some(joined(slot.take(), verdict));
            }
        }
        let runs = runs(answers);
        for i in open {
            let (Some(q), Some(slot)) = (questions.get(i), answers.get_mut(i)) else { continue };
            if let (Claim::Asked(_), true) = (&q.claim, is_open(slot))
                && let Some(run) = asks(model, &q.claim, &runs)
            {
                *slot = Some(Verdict::Proved(Evidence::Run(run)));
            }
        }
    }
}

/// Two answers to one question: what is open twice is sure as far as one of them is.
fn joined(old: Option<Verdict>, new: Verdict) -> Verdict {
    match (old, new) {
        (Some(Verdict::Open(old)), Verdict::Open(new)) => {
            // A question that the solver could not be asked keeps the reason of the search.
            let further = if new.scans == 0 { &old } else { &new };
            let reason = further.reason.clone();
            Verdict::Open(Open {
                scans: old.scans.max(new.scans),
                states: old.states.max(new.states),
                reason,
            })
        }
        (_, new) => new,
    }
}

/// The runs of answers, the shortest first.
fn runs(answers: &[Option<Verdict>]) -> Vec<Run> {
    let run = |a: &Option<Verdict>| match a {
        Some(Verdict::Proved(Evidence::Run(r)) | Verdict::Refuted(Evidence::Run(r))) => Some(r.clone()),
        _ => None,
    };
    let mut runs: Vec<Run> = answers.iter().filter_map(run).collect();
    runs.sort_by_key(|r| r.moves.len());
    runs
}

/// The shortest beginning of these runs at which an input is asked for.
fn asks(model: &Model<'_>, claim: &Claim, runs: &[Run]) -> Option<Run> {
    let Claim::Asked(addr) = claim else { return None };
    let p = &model.compiled.program;
    let asking = Asking::new(p, model.compiled.queries.iter().copied());
    let place = (addr.0 - p.tables().inputs.start) as usize;
    let first = |run: &Run| -> Option<Run> {
        let mut s = State::new(p);
        for (k, m) in run.moves.iter().enumerate() {
            let asked = asking.asked(&s).iter().any(|i| i == place);
            let now = s.now().saturating_add(m.wait);
            let fault = scan(p, &mut s, &m.inputs, now).err();
            if asked {
                let moves = run.moves.iter().take(k + 1).cloned().collect();
                return Some(Run { moves, fault, ..Run::default() });
            }
        }
        None
    };
    let found = runs.iter().filter_map(first).min_by_key(|r| r.moves.len())?;
    replay(model, claim, &found).then_some(found)
}

/// A search for all states. It gives an answer for each signal, and tells whether every state has inputs that satisfy
/// the assumptions.
type Visit<'a> = fn(&Work<'a>, &[Signal]) -> Option<(Vec<Found>, Ends)>;

struct Work<'a> {
    model: &'a Model<'a>,
    translated: &'a Translated,
    effort: &'a Effort<'a>,
    budget: &'a Budget<'a>,
}

impl Work<'_> {
    fn verdicts(&self, questions: &[Question]) -> Vec<Verdict> {
        let asked: Vec<&Asked> = self.translated.asked.iter().flatten().collect();
        let mut signals: Vec<Signal> = asked.iter().flat_map(|a| [a.bad, a.unsure]).collect();
        signals.sort_unstable();
        signals.dedup();
        let pairs: Vec<[Signal; 2]> = asked.iter().map(|a| [a.bad, a.unsure]).collect();
        let needs = Needs::new(&signals, &pairs);
        let candidates = &self.translated.candidates;
        let mut found = decide_with(&self.translated.system, &signals, &needs, candidates, self.effort);
        let seen = self.visit(&signals, &needs, &mut found);
        let of = |s: Signal| {
            let at = signals.binary_search(&s).ok();
            at.and_then(|at| found.get(at)).unwrap_or(&Found::Open(0))
        };
        let proofs = asked.iter().any(|a| matches!(of(a.bad), Found::Never(_)));
        let ends = match seen {
            _ if !proofs => Ends::None,
            // It has found the inputs of each state.
            Some(ends) if ends != Ends::Open => ends,
            _ => ends(&self.translated.system, self.effort),
        };
        let one = |((q, a), f): ((&Question, &Result<Asked, Reason>), &Option<Follows>)| match (a, f) {
            (Ok(a), None) => self.verdict(&q.claim, a, [of(a.bad), of(a.unsure)], &ends),
            // Where runs come to an end without a choice of inputs, nothing is said about what follows.
            (Ok(a), Some(_)) if ends != Ends::None => {
                let nothing = Found::Never(Proof::Invariant(Vec::new()));
                self.verdict(&q.claim, a, [&nothing, &nothing], &ends)
            }
            (Ok(a), Some(f)) => match self.follows(&q.claim, a, f) {
                // A proof counts as one of any other claim does.
                Ok(clauses) => {
                    let proof = Found::Never(Proof::Invariant(clauses));
                    self.verdict(&q.claim, a, [&proof, of(a.unsure)], &ends)
                }
                Err(verdict) => verdict,
            },
            (Err(reason), _) => open(0, reason.clone()),
        };
        let t = self.translated;
        questions.iter().zip(&t.asked).zip(&t.follows).map(one).collect()
    }

    /// Searches all states for the signals that the solver has left open: first as sets, then one by one within the
    /// scans of this turn. Also tells whether every state has inputs that satisfy the assumptions.
    fn visit(&self, signals: &[Signal], needs: &Needs, found: &mut [Found]) -> Option<Ends> {
        let ways: [Visit<'_>; 2] = [Self::sets, Self::states];
        let mut known = None;
        for way in ways {
            let is_shown = |i: usize| matches!(found.get(i), Some(Found::Reached(_)));
            let is_open =
                |i: &usize| matches!(found.get(*i), Some(Found::Open(_))) && needs.is_needed(*i, is_shown);
            let open: Vec<usize> = (0..signals.len()).filter(is_open).collect();
            if open.is_empty() || self.effort.turns < FEWEST || (self.budget.stop)() {
                break;
            }
            let signals: Vec<Signal> = open.iter().filter_map(|i| signals.get(*i)).copied().collect();
            let Some((new, ends)) = way(self, &signals) else { continue };
            for (i, new) in open.into_iter().zip(new) {
                if let Some(slot) = found.get_mut(i) {
                    *slot = match (&*slot, new) {
                        (Found::Open(a), Found::Open(b)) => Found::Open(*a.max(&b)),
                        (_, new) => new,
                    };
                }
            }
            known = Some(ends).filter(|e| *e != Ends::Open).or(known);
        }
        known
    }

    /// All states as sets. Not in the page, where the library behind it does not run.
    #[cfg(not(target_family = "wasm"))]
    fn sets(&self, signals: &[Signal]) -> Option<(Vec<Found>, Ends)> {
        let t = self.translated;
        let turn = self.effort.turns.min(TURNS);
        let effort = Sets { nodes: (ROOM << turn >> FEWEST).min(MOST), ticks: CHECK << turn >> FEWEST };
        let wanted = Wanted::of(signals, &t.passes, 1);
        diagram(&t.system, &wanted, &t.candidates, effort, self.budget).map(|seen| (seen.found, seen.ends))
    }

    #[cfg(target_family = "wasm")]
    fn sets(&self, _: &[Signal]) -> Option<(Vec<Found>, Ends)> {
        None
    }

    /// All states one by one.
    fn states(&self, signals: &[Signal]) -> Option<(Vec<Found>, Ends)> {
        let t = self.translated;
        let times = t.system.graph.nodes().len() / SMALL + 1;
        let left = self.budget.scans.min(SCANS << self.effort.turns.min(TURNS) >> FEWEST) / times;
        let budget = Budget { scans: left, ..*self.budget };
        let seen = wide(&t.system, &Wanted::of(signals, &t.passes, threads()), &budget)?;
        Some((seen.found, seen.ends))
    }

    /// The claim about all that can follow each state: the clauses of a proof that it is always what the claim
    /// asks for, or another verdict.
    fn follows(&self, claim: &Claim, asked: &Asked, follows: &Follows) -> Result<Clauses, Verdict> {
        let Follows { waits, goal, may } = *follows;
        // A value that is not known may be the one that leads on.
        if let Some(limit) = self.translated.limits(&[waits, may]).first() {
            return Err(open(0, Reason::Part(limit.part)));
        }
        let t = self.translated;
        let before = |trace: &Trace| {
            let scans = trace.inputs.len().saturating_sub(1);
            t.moves(trace.inputs.get(..scans).unwrap_or(&[]))
        };
        let mut judge = |trace: &Trace| is_trap(self.model, claim, &before(trace), self.budget);
        match traps(&t.system, &Trap { waits, goal, may, words: &t.words }, self.effort, &mut judge) {
            Way::Always(clauses) => Ok(clauses),
            Way::Trap(trace) => {
                let run = Run { moves: before(&trace), ..Run::default() };
                if !replay(self.model, claim, &run) {
                    return Err(self.limited(asked.bad, run.moves.len()));
                }
                Err(Verdict::Refuted(Evidence::Run(run)))
            }
            Way::Open(scans) => Err(open(scans, Reason::LeadsOn)),
        }
    }

    /// The answer to a question for which this was found of its signal, and of the one that
    /// says that a scan is not known whole.
    fn verdict(&self, claim: &Claim, asked: &Asked, found: [&Found; 2], ends: &Ends) -> Verdict {
        match found {
            [Found::Reached(trace), _] => {
                let scans = trace.inputs.len() - 1;
                match repeat(self.model, self.translated.moves(&trace.inputs)) {
                    Some(run) if replay(self.model, claim, &run) => {
                        let run = Evidence::Run(run);
                        if claim.is_of_some_run() { Verdict::Proved(run) } else { Verdict::Refuted(run) }
                    }
                    _ => self.limited(asked.bad, scans),
                }
            }
            [Found::Never(proof), Found::Never(_)] => match ends {
                Ends::None => {
                    let proof = Evidence::Certificate(certificate(proof));
                    if claim.is_of_some_run() { Verdict::Refuted(proof) } else { Verdict::Proved(proof) }
                }
                Ends::Behind(n) => open(*n, Reason::NoInput(*n)),
                Ends::Open => open(0, Reason::Assumptions),
            },
            [Found::Never(_), Found::Reached(trace)] => open(trace.inputs.len() - 1, Reason::Loops),
            [Found::Never(_), Found::Open(scans)] | [Found::Open(scans), _] => open(*scans, Reason::Stopped),
        }
    }

    /// A run that the engine does not repeat: the system has more runs than the chart.
    fn limited(&self, bad: Signal, scans: usize) -> Verdict {
        let limits = self.translated.limits(&[bad]);
        open(scans, limits.first().map_or(Reason::NotRepeated, |limit| Reason::Part(limit.part)))
    }
}

fn open(scans: usize, reason: Reason) -> Verdict {
    Verdict::Open(Open { scans, states: 0, reason })
}

fn certificate(proof: &Proof) -> Certificate {
    match proof {
        Proof::Invariant(clauses) => Certificate::Invariant { clauses: clauses.len() },
        Proof::Induction(depth) => Certificate::Induction { depth: *depth },
        Proof::Visited { states, scans } => Certificate::Search { states: *states, scans: *scans },
        Proof::Diagram { states, nodes, checked } => {
            Certificate::Diagram { states: *states, nodes: *nodes, checked: *checked }
        }
    }
}

/// A run with these moves; nothing if a fault stops it before its last scan.
fn repeat(model: &Model<'_>, moves: Vec<Move>) -> Option<Run> {
    let p = &model.compiled.program;
    let mut s = State::new(p);
    let mut fault = None;
    for m in &moves {
        if fault.is_some() {
            return None;
        }
        let now = s.now().saturating_add(m.wait);
        fault = scan(p, &mut s, &m.inputs, now).err();
    }
    Some(Run { moves, fault, ..Run::default() })
}
