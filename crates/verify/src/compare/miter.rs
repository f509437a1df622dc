//! Both charts as one system of bits, and the questions about it: does a run tell them apart?
//!
//! Each chart is translated by itself, with the same values of the inputs that both have; these
//! are one in the whole. There is a signal for each output (and step), so that each depends on as little as
//! it can, one for faults, and one for scans that are not known whole.

use std::collections::BTreeMap;

use g7_engine::Addr;

use super::equality::Equality;
use super::run::class;
use super::sides::Sides;
use crate::layer::Budget;
use crate::reason::{Part, Reason};
use crate::sat::{
    Effort, Ends, Found, Proof, Signal, System, Trace, aiger, decide_related, ends, join, mapped,
};
use crate::system::{Observed, Translated, Value, same, system, system_until};
use crate::verdict::{Certificate, Open};

/// Both charts as one system.
pub(super) struct Miter {
    whole: System,
    parts: [Translated; 2],
    /// For the inputs of the second chart's system, their places among those of the whole.
    inputs: Vec<usize>,
    /// 1 where a run tells the charts apart, each by itself.
    differ: Vec<Signal>,
    /// 1 behind a scan of which one chart is not known whole.
    unsure: Signal,
    /// A text is compared, of which bits know nothing.
    texts: bool,
}

impl Miter {
    pub(super) fn new(sides: &Sides<'_>) -> Miter {
        let [a, b] = &sides.models;
        Miter::of(sides, [a, b].map(|m| system(m, &[], Observed::Outputs)))
    }

    /// The same, unless the caller wants no more work before it is made.
    pub(super) fn until(sides: &Sides<'_>, stop: &(dyn Fn() -> bool + Sync)) -> Option<Miter> {
        let [a, b] = &sides.models;
        let made = |model| system_until(model, &[], Observed::Outputs, stop);
        Some(Miter::of(sides, [made(a)?, made(b)?]))
    }

    fn of(sides: &Sides<'_>, [a, b]: [Translated; 2]) -> Miter {
        let mut whole = a.system.clone();
        let mut shared = vec![None; b.system.inputs.len()];
        for input in &sides.inputs {
            let [Some(of_a), Some(of_b)] = input.places else { continue };
            for (i, k) in a.bits(of_a).iter().zip(b.bits(of_b)) {
                if let (Some(slot), Some(signal)) = (shared.get_mut(*k), a.system.inputs.get(*i)) {
                    *slot = Some(*signal);
                }
            }
        }
        let map = join(&mut whole, &b.system, &shared);
        let place = |s: &Signal| whole.inputs.iter().position(|i| *i == mapped(&map, *s)).unwrap_or(0);
        let inputs = b.system.inputs.iter().map(place).collect();
        let mut miter =
            Miter { whole, parts: [a, b], inputs, differ: Vec::new(), unsure: Signal::FALSE, texts: false };
        miter.signals(sides, &map);
        miter
    }

    /// Makes the signals that are asked for.
    fn signals(&mut self, sides: &Sides<'_>, map: &[Signal]) {
        let [a, b] = &self.parts;
        let of_b = |s: Signal| mapped(map, s);
        let g = &mut self.whole.graph;
        let open = [a.uncovered, of_b(b.uncovered)];
        let over = [a.stopped, of_b(b.stopped)];
        let on = !g.any(over);
        let open = g.any(open);
        self.unsure = g.and(on, open);
        let known = g.and(on, !open);
        // Faults by their class.
        let mut faults: BTreeMap<&str, [Vec<Signal>; 2]> = BTreeMap::new();
        for (kind, _, s) in &a.faults {
            faults.entry(class(*kind)).or_default()[0].push(*s);
        }
        for (kind, _, s) in &b.faults {
            faults.entry(class(*kind)).or_default()[1].push(of_b(*s));
        }
        let mut each = Vec::new();
        for [x, y] in faults.into_values() {
            let (x, y) = (g.any(x), g.any(y));
            each.push(g.xor(x, y));
        }
        let (sound, other) = (a.sound, of_b(b.sound));
        each.push(g.xor(sound, other));
        let fault = g.any(each);
        let mut differ = vec![g.and(known, fault)];
        let both = g.all([known, sound, other]);
        for pair in &sides.outputs {
            let [x, y] = [value(a, pair.at[0]), value(b, pair.at[1])];
            let (Some(x), Some(y)) = (x, y) else {
                self.texts = true;
                continue;
            };
            let y = moved(y, of_b);
            if matches!(x, Value::Text(_)) || matches!(y, Value::Text(_)) {
                self.texts = true;
                continue;
            }
            let equal = same(g, x, &y);
            differ.push(g.and(both, !equal));
        }
        for (_, [x, y]) in &sides.steps {
            let active = |t: &Translated, s: Option<g7_engine::StepId>| {
                s.and_then(|s| t.steps.get(s.0 as usize).copied()).unwrap_or(Signal::FALSE)
            };
            let other = of_b(active(b, *y));
            let apart = g.xor(active(a, *x), other);
            differ.push(g.and(both, apart));
        }
        differ.sort_unstable();
        differ.dedup();
        differ.retain(|s| *s != Signal::FALSE);
        self.differ = differ;
    }

    /// Asks the solver, for so many turns.
    pub(super) fn solve(&self, sides: &Sides<'_>, turns: u32, budget: &Budget<'_>) -> Equality {
        let effort = Effort { bytes: budget.bytes, turns, stop: budget.stop };
        let mut signals = self.differ.clone();
        signals.push(self.unsure);
        let (found, lemmas) = decide_related(&self.whole, &signals, &effort);
        let (differ, unsure) = found.split_at(self.differ.len());
        let reached = differ.iter().filter_map(trace).min_by_key(|t| t.inputs.len());
        if let Some(trace) = reached {
            return sides.apart(&self.vectors(sides, trace)).unwrap_or_else(|| self.limited(trace));
        }
        let stopped = || {
            let sure =
                found.iter().filter_map(|f| if let Found::Open(n) = f { Some(*n) } else { None }).min();
            open(sure.unwrap_or(0), Reason::Stopped)
        };
        match unsure.first() {
            Some(Found::Reached(trace)) => {
                return open(trace.inputs.len() - 1, Reason::Loops);
            }
            Some(Found::Never(_)) if found.iter().all(|f| matches!(f, Found::Never(_))) => {}
            _ => return stopped(),
        }
        if self.texts {
            return open(0, Reason::Part(Part::Texts));
        }
        match ends(&self.whole, &effort) {
            Ends::None => Equality::Equal(certificate(&found, lemmas)),
            Ends::Behind(n) => open(n, Reason::NoInput(n)),
            Ends::Open => open(0, Reason::Assumptions),
        }
    }

    /// The values of the inputs of both charts in each scan of a trace.
    fn vectors(&self, sides: &Sides<'_>, trace: &Trace) -> Vec<Vec<u64>> {
        let [a, b] = &self.parts;
        let own: Vec<Vec<bool>> = trace
            .inputs
            .iter()
            .map(|bits| self.inputs.iter().map(|i| bits.get(*i).copied().unwrap_or(false)).collect())
            .collect();
        let (of_a, of_b) = (a.moves(&trace.inputs), b.moves(&own));
        let each = of_a.iter().zip(&of_b).map(|(x, y)| {
            let word = |input: &super::sides::Input| {
                let [p, q] = input.places;
                // A side whose system does not read the input does not tell its value.
                let first = p.filter(|p| q.is_none() || !a.bits(*p).is_empty());
                let (list, at) = first.map_or((&y.inputs, q), |p| (&x.inputs, Some(p)));
                at.and_then(|at| list.get(at)).copied().unwrap_or(0)
            };
            sides.inputs.iter().map(word).collect()
        });
        each.collect()
    }

    /// A run that the engines do not repeat: the system has more runs than the charts.
    fn limited(&self, trace: &Trace) -> Equality {
        let [a, b] = &self.parts;
        let all = |t: &Translated| -> Vec<Signal> {
            let outputs = t.outputs.iter().flat_map(|(_, _, v)| v).flat_map(bits);
            outputs.chain([t.sound]).chain(t.steps.iter().copied()).collect()
        };
        let limits = [a.limits(&all(a)), b.limits(&all(b))].concat();
        let reason = limits.first().map_or(Reason::NotRepeated, |limit| Reason::Part(limit.part));
        open(trace.inputs.len().saturating_sub(1), reason)
    }

    /// Writes the system as a binary AIGER file.
    pub(super) fn aiger(&self) -> Vec<u8> {
        let mut whole = self.whole.clone();
        let mut bad = vec![whole.graph.any(self.differ.iter().copied())];
        bad.extend((self.unsure != Signal::FALSE).then_some(self.unsure));
        aiger(&whole, &bad)
    }
}

fn trace(found: &Found) -> Option<&Trace> {
    if let Found::Reached(trace) = found { Some(trace) } else { None }
}

/// The value of an output's word.
fn value(t: &Translated, at: Addr) -> Option<&Value> {
    let list = t.outputs.iter().find(|(_, first, v)| (first.0..first.0 + v.len() as u32).contains(&at.0));
    list.and_then(|(_, first, v)| v.get((at.0 - first.0) as usize))
}

/// A value with other signals.
fn moved(v: &Value, of: impl Fn(Signal) -> Signal) -> Value {
    match v {
        Value::Whole(w) => Value::Whole(w.moved(of)),
        Value::Real(bits) => Value::Real(bits.iter().map(|s| of(*s)).collect()),
        Value::Text(t) => Value::Text(t.clone()),
    }
}

fn bits(v: &Value) -> Vec<Signal> {
    match v {
        Value::Whole(w) => w.bits().to_vec(),
        Value::Real(bits) => bits.clone(),
        Value::Text(_) => Vec::new(),
    }
}

fn open(scans: usize, reason: Reason) -> Equality {
    Equality::Open(Open { scans, states: 0, reason })
}

/// All proofs as one: the clauses of an induction over one step are those of the relations alone.
fn certificate(found: &[Found], lemmas: usize) -> Certificate {
    let of = |f: &Found| match f {
        Found::Never(Proof::Invariant(clauses)) => clauses.len(),
        _ => 0,
    };
    Certificate::Invariant { clauses: lemmas + found.iter().map(of).sum::<usize>() }
}
