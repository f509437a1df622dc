//! Why a condition has its value: the parts that decide it, and since when each has the value that it has.

use g7_compile::tree::{Expr, ExprKind, Gate};
use g7_engine::{State, WatchId};
use g7_model::say;

use crate::answer::{Cause, Fact};
use crate::parts::{Operands, watched};
use crate::signal::{Pos, Signal};
use crate::text::{at, truth};
use crate::trail::Trail;
use crate::{Why, parts};

/// Changes that are looked at, one before the other, to find the one that gave a part its value.
const ROUNDS: usize = 40;
/// Operands of a part whose changes are told.
const OPERANDS: usize = 3;

/// Since when a part has its value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Since {
    Start,
    /// An operand changed then.
    Change(Pos),
    /// A time was over then.
    Time(Pos),
    /// For no longer than this pass: it is an edge.
    Edge(Pos),
    /// There is no edge.
    NoEdge,
    /// At least since then; the changes before were not looked at.
    Long(Pos),
}

impl Since {
    /// The moment, to compare with others; that of the start is the first of all.
    pub(crate) fn pos(self) -> Option<Pos> {
        match self {
            Since::Start => None,
            Since::Change(pos) | Since::Time(pos) | Since::Edge(pos) | Since::Long(pos) => Some(pos),
            Since::NoEdge => None,
        }
    }
}

/// A part that decides the value of a condition.
#[derive(Clone, Copy)]
pub(crate) struct Decisive<'e> {
    pub(crate) part: &'e Expr,
    pub(crate) value: bool,
    pub(crate) since: Since,
    /// It is one of those that came last, and so gave the whole its value.
    pub(crate) last: bool,
}

impl Why<'_> {
    /// The moment before this one: the stage before it, or the end of the scan before. `None` at the start of the run.
    pub(crate) fn earlier(&self, pos: Pos) -> Option<Pos> {
        match pos.stage.checked_sub(1) {
            Some(stage) => Some(Pos { scan: pos.scan, stage }),
            None => pos.scan.checked_sub(1).map(|scan| self.past.end(scan)),
        }
    }

    /// The parts that decide a condition in a state of the run at a moment; empty where its value is not known.
    pub(crate) fn decisive<'e>(&self, e: &'e Expr, state: &State, pos: Pos) -> Vec<Decisive<'e>> {
        let p = self.past.program;
        match &e.kind {
            ExprKind::Not(x) => self.decisive(x, state, pos),
            ExprKind::Gate(gate, a, b) => {
                let Some(value) = self.parts.holds(p, e, state) else { return Vec::new() };
                let settles = match gate {
                    // One operand alone decides where the value is this.
                    Gate::And => Some(false),
                    Gate::Or => Some(true),
                    Gate::Xor => None,
                };
                let alone = settles == Some(value);
                let mut sides: Vec<Vec<Decisive<'e>>> = Vec::new();
                for side in [a, b] {
                    if !alone || self.parts.holds(p, side, state) == Some(value) {
                        sides.push(self.decisive(side, state, pos));
                    }
                }
                last_of(&mut sides, alone);
                sides.into_iter().flatten().collect()
            }
            _ => {
                let Some(value) = self.parts.value(p, e, state) else { return Vec::new() };
                vec![Decisive { part: e, value, since: self.since(e, value, pos), last: true }]
            }
        }
    }

    /// Since when a part has the value that it has at a moment.
    fn since(&self, e: &Expr, value: bool, pos: Pos) -> Since {
        let p = self.past.program;
        if let ExprKind::Rise(watch) | ExprKind::Fall(watch) = e.kind {
            if !value {
                return Since::NoEdge;
            }
            let signals = self.seen_by(watch).signals;
            return Since::Edge(self.past.last_change(&signals, pos).unwrap_or(pos));
        }
        let mut operands = Operands::of(self.compiled, e);
        for watch in operands.edges.clone() {
            operands.signals.extend(self.seen_by(watch).signals);
        }
        let mut until = pos;
        for _ in 0..ROUNDS {
            let Some(change) = self.past.last_change(&operands.signals, until) else {
                return self.timed(e, value, (None, until), &operands).unwrap_or(Since::Start);
            };
            if let Some(since) = self.timed(e, value, (Some(change), until), &operands) {
                return since;
            }
            let look = self.past.look(change.scan);
            if self.parts.value(p, e, look.before(change.stage)) != Some(value) {
                return Since::Change(change);
            }
            match self.earlier(change) {
                Some(earlier) => until = earlier,
                None => return Since::Start,
            }
        }
        Since::Long(until)
    }

    /// The scan in which a time gave a part its value, behind the last change of its operands.
    fn timed(
        &self,
        e: &Expr,
        value: bool,
        (from, to): (Option<Pos>, Pos),
        operands: &Operands,
    ) -> Option<Since> {
        if operands.clocks.is_empty() {
            return None;
        }
        let p = self.past.program;
        let holds = |scan: usize| self.parts.value(p, e, &self.past.behind(scan)) == Some(value);
        let first = from.map_or(0, |pos| pos.scan);
        let known = match from {
            Some(pos) => self.parts.value(p, e, self.past.look(pos.scan).after(pos.stage)) == Some(value),
            None => holds(0),
        };
        if known || first >= to.scan {
            return None;
        }
        // Between two changes of its operands such a part changes once: a time is over and stays so.
        let (mut low, mut high) = (first, to.scan);
        while high - low > 1 {
            let middle = low + (high - low) / 2;
            if holds(middle) { high = middle } else { low = middle }
        }
        Some(Since::Time(Pos { scan: high, stage: 1 }))
    }

    /// The operands of what a watch looks at.
    pub(crate) fn seen_by(&self, watch: WatchId) -> Operands {
        watched(self.compiled, watch).map(|e| Operands::of(self.compiled, e)).unwrap_or_default()
    }

    /// The sentence about a decisive part, with its causes where they are followed.
    pub(crate) fn part(&self, d: &Decisive<'_>, pos: Pos, follow: bool, trail: &mut Trail) -> Cause {
        match (parts::read(d.part), d.since) {
            (Some(signal), Since::Change(change)) => return self.event(signal, change, follow, trail),
            (Some(signal), Since::Start) => return self.since_start(signal, follow),
            _ => {}
        }
        let (text, value) = (self.names.expr(d.part), truth(d.value));
        let places = [d.part.at];
        let now = self.past.time(d.since.pos().unwrap_or(Pos { scan: 0, stage: 0 }).scan);
        let then = at(now);
        let (said, fact) = match d.since {
            Since::Start => (say!("`{text}` is {value} since the start"), Fact::Start),
            Since::Change(_) => (say!("`{text}` is {value} since {then}"), Fact::Part(d.value)),
            Since::Time(_) => (say!("`{text}` is {value} since {then}: the time was over"), Fact::Time),
            Since::Edge(_) => (say!("`{text}` is {value} at {then}"), Fact::Part(d.value)),
            Since::NoEdge => (
                say!("`{text}` is FALSE: there is no edge at {}", at(self.past.time(pos.scan))),
                Fact::Part(false),
            ),
            Since::Long(_) => (say!("`{text}` is {value} since {then} or longer"), Fact::Bound),
        };
        let now = if d.since == Since::NoEdge { self.past.time(pos.scan) } else { now };
        let mut cause = Cause::new(said, fact, now, places);
        cause.aside = !follow;
        cause.because(self.behind_part(d, pos, follow, trail))
    }

    fn behind_part(&self, d: &Decisive<'_>, pos: Pos, follow: bool, trail: &mut Trail) -> Vec<Cause> {
        let mut operands = Operands::of(self.compiled, d.part);
        for watch in operands.edges.clone() {
            operands.signals.extend(self.seen_by(watch).signals);
        }
        match d.since {
            Since::Change(change) | Since::Edge(change) if follow => {
                let look = self.past.look(change.scan);
                let changed = |s: &&Signal| look.changes(self.past.program, **s, change.stage);
                let changed: Vec<Signal> =
                    operands.signals.iter().filter(changed).take(OPERANDS).copied().collect();
                changed.into_iter().map(|s| self.event(s, change, true, trail)).collect()
            }
            // The times and the values that stand beside them, without their causes.
            Since::Time(_) | Since::NoEdge => {
                let all = operands.signals.iter().take(OPERANDS);
                all.map(|s| self.standing(*s, pos, false, trail)).collect()
            }
            Since::Change(_) | Since::Edge(_) | Since::Start | Since::Long(_) => Vec::new(),
        }
    }

    /// The sentence about the last change of a signal at or before a moment.
    pub(crate) fn standing(&self, signal: Signal, pos: Pos, follow: bool, trail: &mut Trail) -> Cause {
        match self.past.last_change(&[signal], pos) {
            Some(change) => self.event(signal, change, follow, trail),
            None => self.since_start(signal, follow),
        }
    }
}

/// Of the sides of a gate those stay marked that gave it its value: where one alone decides it, the side that came
/// first; otherwise the one that came last.
fn last_of(sides: &mut [Vec<Decisive<'_>>], alone: bool) {
    let came =
        |side: &[Decisive<'_>]| side.iter().filter(|d| d.last).map(|d| d.since.pos()).max().unwrap_or(None);
    let times: Vec<Option<Pos>> = sides.iter().map(|s| came(s)).collect();
    let chosen = if alone { times.iter().min() } else { times.iter().max() }.copied();
    for (side, time) in sides.iter_mut().zip(&times) {
        if Some(*time) != chosen {
            side.iter_mut().for_each(|d| d.last = false);
        }
    }
}
