//! Claims as signals: 1 where a scan breaks the claim (or shows it, for those of some run).
//!
//! The meaning of claims about the ends of scans is `monitor::step`: it is asked for all values
//! of its conditions, and the table is made of gates. Only numbers that would make the table
//! long have a circuit of their own: "at most" and the time of "within".

use std::collections::BTreeMap;

use g7_engine::{Addr, FaultKind, StepId};
use g7_equations::{MemoryId, What};

use super::exec::Exec;
use super::scan::Sights;
use super::value::Value;
use super::word::{self, Word, width};
use crate::look::sides;
use crate::monitor::{IDLE, is_of_scans, step};
use crate::question::{Claim, Query};
use crate::reason::{Part, Reason};
use crate::sat::{Init, Signal};

/// A question in the system.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Asked {
    /// 1 at a scan that breaks the claim, or shows it if it is of some run.
    pub bad: Signal,
    /// 1 at a scan behind which the claim is not decided: more passes or loops than were
    /// unrolled, or a condition without a value.
    pub unsure: Signal,
}

/// Most values that the memory of a monitor has.
const STATES: u64 = 3;

/// The end of a scan.
pub(crate) struct End<'x, 'a> {
    pub(crate) x: &'x mut Exec<'a>,
    pub(crate) sights: &'x Sights,
    /// 1 in the scans behind one that a fault has ended.
    pub(crate) stopped: Signal,
    /// By query: its value, and 1 where it has none.
    known: BTreeMap<u32, (Signal, Signal)>,
    /// That of [`End::left`], once it is known.
    left: Option<Signal>,
}

impl<'x, 'a> End<'x, 'a> {
    pub(crate) fn new(x: &'x mut Exec<'a>, sights: &'x Sights, stopped: Signal) -> End<'x, 'a> {
        End { x, sights, stopped, known: BTreeMap::new(), left: None }
    }

    /// The signals of a claim.
    ///
    /// # Errors
    ///
    /// Why the claim cannot be asked of one scan after the other.
    pub(crate) fn asked(&mut self, claim: &Claim) -> Result<Asked, Reason> {
        let open = self.x.uncovered.clone();
        let open = self.x.g().any(open);
        let stopped = self.stopped;
        if matches!(claim, Claim::LeadsTo { .. } | Claim::NoDeadlock | Claim::Asked(_)) {
            return Err(Reason::Future);
        }
        let (bad, unsure) =
            if is_of_scans(claim) { self.of_scans(claim) } else { (self.shows(claim), Signal::FALSE) };
        let unsure = self.x.g().or(unsure, open);
        let beside = self.beside(claim);
        let unsure = self.x.g().or(unsure, beside);
        let unsure = match claim {
            // The situation in which an endless search is left is of the engine's own choice.
            Claim::Active(_) => {
                let left = self.left();
                self.x.g().or(unsure, left)
            }
            _ => unsure,
        };
        Ok(Asked { bad: self.x.g().and(bad, !stopped), unsure: self.x.g().and(unsure, !stopped) })
    }

    /// The scan has ended without a fault.
    fn sound(&self) -> Signal {
        self.x.run
    }

    /// As [`crate::look::shows`].
    fn shows(&mut self, claim: &Claim) -> Signal {
        let t = self.x.model.compiled.program.tables();
        let clears = |rank: u32| self.sights.clears.get(rank as usize).copied().unwrap_or(Signal::FALSE);
        match claim {
            Claim::Active(s) if t.initial.contains(s) => Signal::TRUE,
            Claim::Active(s) => {
                let meets = |r: &u32| {
                    let (from, to) = sides(t, *r);
                    from.contains(&s.0) || to.contains(&s.0)
                };
                let mut any: Vec<Signal> =
                    (0..t.transitions.len() as u32).filter(meets).map(clears).collect();
                let (on, endless) = (self.flag(What::Step(*s)), self.fault(is_endless));
                any.push(self.x.g().and(on, !endless));
                self.x.g().any(any)
            }
            Claim::Clears(rank) => clears(*rank),
            Claim::Runs(rank) => self.flag(What::Ran(*rank)),
            Claim::On(addr) => {
                let on = self.is_on(*addr);
                let sound = self.sound();
                self.x.g().and(on, sound)
            }
            Claim::NoConflict => self.sights.conflict,
            Claim::NoUnsafe => self.sights.unsafe_,
            Claim::NoInstability => self.fault(is_endless),
            Claim::NoOpposedOrders => self.fault(|k| matches!(k, FaultKind::Forcing { .. })),
            Claim::NoFault => self.fault(|k| !is_endless(k) && !matches!(k, FaultKind::Forcing { .. })),
            Claim::NoOpposedWrites => {
                let all = (0u32..).map(MemoryId).zip(&self.x.e.memories);
                let list: Vec<MemoryId> =
                    all.filter(|(_, m)| matches!(m.what, What::Conflict(_))).map(|(id, _)| id).collect();
                let any: Vec<Signal> = list.into_iter().map(|m| self.x.holds(Some(m))).collect();
                let (any, sound) = (self.x.g().any(any), self.sound());
                self.x.g().and(any, sound)
            }
            _ => Signal::FALSE,
        }
    }

    /// 1 where an endless search has activated a step by something other than a transition: the engine may
    /// leave it in a pass in which the step is not active. One signal for all steps, since it is rarely 1.
    fn left(&mut self) -> Signal {
        if let Some(known) = self.left {
            return known;
        }
        let mut any = Vec::new();
        for (memory, (was, behind)) in self.sights.active.clone() {
            if let Some(What::Step(s)) = self.x.e.memory(memory).map(|m| m.what) {
                let seen = self.shows(&Claim::Active(s));
                any.push(self.x.g().all([behind, !was, !seen]));
            }
        }
        let (any, endless) = (self.x.g().any(any), self.fault(is_endless));
        let left = self.x.g().and(any, endless);
        *self.left.insert(left)
    }

    /// 1 where passes of an endless search that were not unrolled may show more of what a claim is
    /// about: the parts of the steps, and what they decide, did not all come back.
    fn beside(&mut self, claim: &Claim) -> Signal {
        let (t, e) = (self.x.model.compiled.program.tables(), self.x.e);
        let step = |s: u32| e.find(What::Step(StepId(s)));
        let of: Vec<Option<MemoryId>> = match claim {
            Claim::Active(s) => vec![step(s.0)],
            // A step that it leaves or enters follows from it.
            Claim::Clears(rank) => {
                let (from, to) = sides(t, *rank);
                vec![from.first().or(to.first()).and_then(|s| step(*s))]
            }
            Claim::Runs(rank) => vec![e.find(What::Ran(*rank))],
            Claim::NoConflict | Claim::NoUnsafe => (0..t.steps.len() as u32).map(step).collect(),
            _ => return Signal::FALSE,
        };
        let open = |m: Option<MemoryId>| {
            m.and_then(|m| self.sights.beside.get(&m)).copied().unwrap_or(self.sights.partly)
        };
        let open: Vec<Signal> = of.into_iter().map(open).collect();
        self.x.g().any(open)
    }

    fn flag(&mut self, what: What) -> Signal {
        let memory = self.x.e.find(what);
        self.x.holds(memory)
    }

    fn fault(&mut self, is: impl Fn(FaultKind) -> bool) -> Signal {
        let any: Vec<Signal> = self.x.faults.iter().filter(|f| is(f.0)).map(|f| f.2).collect();
        self.x.g().any(any)
    }

    /// The word at an address is not 0.
    fn is_on(&mut self, at: Addr) -> Signal {
        let Some(m) = self.x.e.find(What::Variable(at)) else { return Signal::FALSE };
        match self.x.cell(m).first().cloned() {
            Some(Value::Whole(w)) => word::is_true(self.x.g(), &w),
            Some(Value::Real(bits)) => self.x.g().any(bits),
            // The first word of a text is its length.
            Some(Value::Text(_)) => {
                let free = self.x.unknown(g7_model::Type::Bool, Part::Length).whole();
                word::is_true(self.x.g(), &free)
            }
            None => Signal::FALSE,
        }
    }

    /// The value of a condition, and 1 where it has none.
    pub(crate) fn query(&mut self, q: Query) -> (Signal, Signal) {
        if let Some(known) = self.known.get(&q.0) {
            return *known;
        }
        let found = value_of(self.x, q);
        self.known.insert(q.0, found);
        found
    }

    /// A claim about the ends of scans: 1 where it is hit, and where it is not decided.
    fn of_scans(&mut self, claim: &Claim) -> (Signal, Signal) {
        let sound = self.sound();
        let (hit, unsure) = match claim {
            Claim::Within { cause, within, effect } => self.within(*cause, *within, *effect),
            Claim::AtMost(most, list) => self.at_most(*most, list),
            _ => self.table(claim),
        };
        (self.x.g().and(hit, sound), self.x.g().and(unsure, sound))
    }

    fn at_most(&mut self, most: u32, list: &[Query]) -> (Signal, Signal) {
        let mut count = Word::constant(0);
        let mut fails = Vec::new();
        for q in list {
            let (holds, without) = self.query(*q);
            count = word::add(self.x.g(), &count, &Word::truth(holds));
            fails.push(without);
        }
        let over = word::less(self.x.g(), &Word::constant(most.into()), &count);
        let fails = self.x.g().any(fails);
        (self.x.g().and(over, !fails), fails)
    }

    /// Counts scans since the first cause that waits: 0 if none does, 1 in its own scan.
    fn within(&mut self, cause: Query, within: i64, effect: Query) -> (Signal, Signal) {
        let last = i128::from(within.max(0) / self.x.model.period) + 1;
        let n = width(0, last) - 1;
        let latches: Vec<Signal> = (0..n).map(|_| self.x.system.latch(Init::Zero)).collect();
        let mut bits = latches.clone();
        bits.push(Signal::FALSE);
        let before = Word::of(bits, 1, 0, last);
        let ((cause, no_cause), (effect, no_effect)) = (self.query(cause), self.query(effect));
        let g = self.x.g();
        let waits = word::is_true(g, &before);
        let more = word::add(g, &before, &Word::constant(1));
        let hit = word::less(g, &Word::constant(last), &more);
        let fails = g.or(no_cause, no_effect);
        let starts = Word::truth(cause);
        let next = word::choose(g, waits, &more, &starts);
        let over = g.or(hit, effect);
        let next = word::choose(g, over, &Word::constant(0), &next);
        for (i, latch) in latches.iter().enumerate() {
            let bit = next.bits().get(i).copied().unwrap_or(Signal::FALSE);
            self.x.system.set_next(*latch, bit);
        }
        let unsure = self.x.g().and(fails, !hit);
        (hit, unsure)
    }

    /// The table of a monitor.
    fn table(&mut self, claim: &Claim) -> (Signal, Signal) {
        let queries: Vec<Query> = match claim {
            Claim::Always(q) | Claim::Never(q) | Claim::Reachable(q) => vec![*q],
            Claim::Until { from, to, holds } => vec![*from, *to, *holds],
            Claim::Between { from, to, never } => vec![*from, *to, *never],
            _ => Vec::new(),
        };
        let has_memory = queries.len() > 1;
        let latches: Vec<Signal> =
            (0..if has_memory { 2 } else { 0 }).map(|_| self.x.system.latch(Init::Zero)).collect();
        let period = self.x.model.period;
        let (mut hits, mut fails, mut next) = (Vec::new(), Vec::new(), [Vec::new(), Vec::new()]);
        for memory in 0..if has_memory { STATES } else { 1 } {
            for row in 0..3usize.pow(queries.len() as u32) {
                // 0, 1, or without a value.
                let digit = |i: usize| row / 3usize.pow(i as u32) % 3;
                let holds = |q: Query| {
                    let i = queries.iter().position(|o| *o == q).unwrap_or(0);
                    if digit(i) == 2 { Err(()) } else { Ok(digit(i) == 1) }
                };
                let seen = step(claim, memory, period, holds);
                let mut parts: Vec<Signal> =
                    latches.iter().enumerate().map(|(i, l)| l.negated_if(memory >> i & 1 == 0)).collect();
                for (i, q) in queries.iter().enumerate() {
                    let (value, without) = self.query(*q);
                    parts.push(if digit(i) == 2 { without } else { !without });
                    parts.push(match digit(i) {
                        0 => !value,
                        1 => value,
                        _ => Signal::TRUE,
                    });
                }
                let here = self.x.g().all(parts);
                match seen {
                    Err(()) => fails.push(here),
                    Ok(seen) => {
                        hits.extend(seen.hit.then_some(here));
                        for (i, list) in next.iter_mut().enumerate() {
                            list.extend((seen.memory >> i & 1 != IDLE).then_some(here));
                        }
                    }
                }
            }
        }
        for (latch, list) in latches.iter().zip(next) {
            let bit = self.x.g().any(list);
            self.x.system.set_next(*latch, bit);
        }
        (self.x.g().any(hits), self.x.g().any(fails))
    }
}

fn is_endless(kind: FaultKind) -> bool {
    matches!(kind, FaultKind::Unstable { .. } | FaultKind::Bound)
}

/// The value of a condition in the state as it is, and 1 where it has none.
pub(crate) fn value_of(x: &mut Exec<'_>, q: Query) -> (Signal, Signal) {
    let Some((before, value)) = x.e.questions.get(q.0 as usize) else {
        return (Signal::FALSE, Signal::TRUE);
    };
    x.glance(|x| {
        x.restart();
        x.all(before);
        let holds = x.truth(value);
        (holds, !x.run)
    })
}
