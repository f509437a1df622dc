//! One scan as bits: its sections, the passes of a search for stability, and what is looked
//! at on the way.
//!
//! # Invariants
//!
//! - The sights are those of `look.rs`: transitions that clear are noted where all of them are
//!   known and none has acted; a conflict is looked for where they are judged.
//! - A pass that is made under a condition changes nothing where the condition does not hold.

use std::collections::{BTreeMap, BTreeSet};

use g7_engine::{FaultKind, StepId};
use g7_equations::{Class, MemoryId, Section, Stmt, What};

use super::exec::{Exec, NODES};
use super::latches::alike;
use super::parts::{Part, parts};
use super::value::Value;
use crate::look::sides;
use crate::sat::{Effort, Found, Init, Signal, System, decide};

/// Most passes that are unrolled.
const PASSES: usize = 32;

/// The sights of a scan.
#[derive(Clone, Debug)]
pub(crate) struct Sights {
    /// For each transition: it clears.
    pub(crate) clears: Vec<Signal>,
    /// As [`crate::look::Passes::conflict`].
    pub(crate) conflict: Signal,
    /// As [`crate::look::Passes::unsafe_`].
    pub(crate) unsafe_: Signal,
    /// For each of the watched steps: it was active as the scan began; it is active behind some pass.
    pub(crate) active: BTreeMap<MemoryId, (Signal, Signal)>,
    /// The search for stability does not end because a part comes back, and not the whole.
    pub(crate) partly: Signal,
    /// For each pass but the first: some scan makes it. Where it is 0, no later pass is made.
    pub(crate) passes: Vec<Signal>,
    /// Where `partly` is 1, for each step and each watched memory: its part may do more in passes that were not
    /// unrolled.
    pub(crate) beside: BTreeMap<MemoryId, Signal>,
}

/// The places of a pass.
struct Places {
    /// Sections before the evolution: edges, PRE, services.
    opening: usize,
    /// The section that says which orders disagree.
    orders: Option<usize>,
    /// The section that judges the transitions.
    judged: Option<usize>,
    /// Sections up to the one that says last which transitions clear.
    chosen: usize,
}

/// One scan in the making.
pub(crate) struct Scan<'x, 'a> {
    pub(crate) x: &'x mut Exec<'a>,
    pub(crate) sights: Sights,
    places: Places,
    /// By transition (rank): the memories of "clearable" and of "clears".
    clears: Vec<(Option<MemoryId>, Option<MemoryId>)>,
    steps: Vec<Option<MemoryId>>,
    /// Pairs of transitions that must not be clearable together.
    rivals: Vec<(u32, u32)>,
    /// Memories that some question looks at in each pass: steps, and actions that have run.
    watched: BTreeSet<MemoryId>,
}

impl<'x, 'a> Scan<'x, 'a> {
    /// `rivals` are the pairs of transitions that may be in conflict, `watched` steps and notes of actions
    /// of which some question asks what they are in each pass.
    pub(crate) fn new(
        x: &'x mut Exec<'a>,
        rivals: Vec<(u32, u32)>,
        watched: BTreeSet<MemoryId>,
    ) -> Scan<'x, 'a> {
        let (e, t) = (x.e, x.model.compiled.program.tables());
        let known = e.by_meaning();
        let find = |what| known.get(&what).copied();
        let ranks = 0..t.transitions.len() as u32;
        let clears: Vec<_> = ranks.map(|r| (find(What::Clearable(r)), find(What::Clears(r)))).collect();
        let steps = (0..t.steps.len() as u32).map(|s| find(What::Step(StepId(s)))).collect();
        let meaning = |m: MemoryId| e.memory(m).map(|m| m.what);
        let with = |test: &dyn Fn(&Stmt) -> bool| {
            let holds = |s: &Section| {
                let mut found = false;
                s.body.iter().for_each(|s| s.visit(&mut |s| found |= test(s)));
                found
            };
            (e.pass.iter().position(holds), e.pass.iter().rposition(holds))
        };
        let sets = |is: &dyn Fn(What) -> bool| {
            with(&|s| matches!(s, Stmt::Set(m, _) if meaning(*m).is_some_and(is)))
        };
        let started = sets(&|w| w == What::Started).0;
        let judged = sets(&|w| matches!(w, What::Clearable(_))).0;
        let places = Places {
            opening: started.map_or(0, |i| i + 1),
            orders: with(&|s| matches!(s, Stmt::Fault(FaultKind::Forcing { .. }, _))).0,
            judged,
            chosen: sets(&|w| matches!(w, What::Clearable(_) | What::Clears(_))).1.map_or(0, |i| i + 1),
        };
        let none = Signal::FALSE;
        let sights = Sights {
            clears: vec![none; clears.len()],
            conflict: none,
            unsafe_: none,
            active: BTreeMap::new(),
            partly: none,
            passes: Vec::new(),
            beside: BTreeMap::new(),
        };
        Scan { x, sights, places, clears, steps, rivals, watched }
    }

    /// All sections; `opened` is called behind the inputs and before the evolution.
    pub(crate) fn run(&mut self, opened: impl FnOnce(&mut Exec<'a>)) {
        let e = self.x.e;
        let steps = self.steps.iter().flatten().filter(|s| self.watched.contains(s));
        for memory in steps.copied().collect::<Vec<_>>() {
            let was = self.x.holds(Some(memory));
            self.sights.active.insert(memory, (was, Signal::FALSE));
        }
        self.sections(&e.begin);
        let first = self.places.opening.min(e.pass.len());
        self.sections(e.pass.get(..first).unwrap_or(&[]));
        opened(self.x);
        self.pass(first);
        if let Some((changed, bound)) = e.search {
            self.search(changed, bound as usize);
        }
        self.sections(&e.finish);
    }

    fn sections(&mut self, list: &[Section]) {
        list.iter().for_each(|s| self.x.all(&s.body));
    }

    /// Passes until none changes anything. A state that comes back within a scan comes back
    /// for ever, and so does that of a part.
    fn search(&mut self, changed: MemoryId, bound: usize) {
        let (parts, part_of) = parts(self.x.e, &self.watched);
        let steps = parts.iter().map(|p| p.steps).max().unwrap_or(self.clears.len());
        let most = (2 * steps + 2).clamp(4, PASSES);
        let mut seen = vec![self.x.cells().to_vec()];
        loop {
            let on = self.going(changed);
            if on == Signal::FALSE || self.x.given_up() {
                return;
            }
            if seen.len() >= bound {
                self.end_search(on, FaultKind::Bound);
                return;
            }
            if !is_possible(&self.x.system, on, self.x.stop) {
                // It is left to the proof: no state has a further pass.
                self.x.leave_uncovered(on);
                return;
            }
            if seen.len() >= most || self.x.system.graph.nodes().len() > NODES {
                break;
            }
            self.sights.passes.push(on);
            let outer = self.x.enter(on);
            self.pass(0);
            self.x.leave(on, outer);
            seen.push(self.x.cells().to_vec());
        }
        let on = self.going(changed);
        let Back { whole, moved, closed } = self.comes_back(&parts, &seen);
        let again = self.x.g().or(whole, moved);
        let unstable = self.x.g().and(on, again);
        self.sights.partly = self.x.g().and(unstable, !whole);
        let partly = self.sights.partly;
        for (memory, part) in part_of {
            let closed = closed.get(part).copied().unwrap_or(Signal::FALSE);
            let open = self.x.g().and(partly, !closed);
            self.sights.beside.insert(memory, open);
        }
        self.end_search(unstable, FaultKind::Unstable { cycle: 0 });
        let open = self.x.g().and(on, !again);
        if open != Signal::FALSE {
            self.x.leave_uncovered(open);
        }
    }

    /// Compares the last of these states with those before it.
    fn comes_back(&mut self, parts: &[Part], seen: &[Vec<Vec<Value>>]) -> Back {
        let Some((last, before)) = seen.split_last() else { return Back::default() };
        let lasting = (0u32..).map(MemoryId).zip(&self.x.e.memories);
        let all: Vec<MemoryId> = lasting
            .filter(|(_, m)| matches!(m.class, Class::Kept | Class::Output))
            .map(|(id, _)| id)
            .collect();
        let (mut whole, mut moved, mut closed) = (Vec::new(), Vec::new(), Vec::new());
        for image in before {
            whole.push(alike(self.x, &all, last, image));
        }
        for part in parts {
            let mut same = Vec::new();
            for (image, next) in before.iter().zip(seen.iter().skip(1)) {
                let back = alike(self.x, &part.memories, last, image);
                let stayed = alike(self.x, &part.memories, image, next);
                moved.push(self.x.g().and(back, !stayed));
                same.push(back);
            }
            closed.push(self.x.g().any(same));
        }
        Back { whole: self.x.g().any(whole), moved: self.x.g().any(moved), closed }
    }

    /// 1 where the latest pass has changed something.
    fn going(&mut self, changed: MemoryId) -> Signal {
        let (changed, here) = (self.x.holds(Some(changed)), self.x.here());
        self.x.g().and(changed, here)
    }

    fn end_search(&mut self, here: Signal, kind: FaultKind) {
        self.x.faults.push((kind, Default::default(), here));
        let run = self.x.run;
        self.x.run = self.x.g().and(run, !here);
    }

    /// A pass, its sections from this one on.
    fn pass(&mut self, first: usize) {
        let e = self.x.e;
        let mut run = self.x.run;
        let mut unsafe_ = Signal::FALSE;
        for (i, section) in e.pass.iter().enumerate().skip(first) {
            if Some(i) == self.places.orders {
                run = self.x.run;
            }
            if Some(i) == self.places.judged && !self.rivals.is_empty() {
                let before = self.places.orders.map_or(self.x.run, |_| run);
                self.conflicts(before, &section.body);
            }
            self.x.all(&section.body);
            if i + 1 == self.places.chosen {
                unsafe_ = self.clearings();
            }
        }
        let here = self.x.here();
        let found = self.x.g().and(here, unsafe_);
        self.sights.unsafe_ = self.x.g().or(self.sights.unsafe_, found);
        let mut active = std::mem::take(&mut self.sights.active);
        for (memory, (_, behind)) in &mut active {
            let on = self.x.holds(Some(*memory));
            let on = self.x.g().and(on, here);
            *behind = self.x.g().or(*behind, on);
        }
        self.sights.active = active;
    }

    /// Notes the transitions that clear; gives whether a step is activated while it is active,
    /// and not deactivated.
    fn clearings(&mut self) -> Signal {
        let here = self.x.here();
        let t = self.x.model.compiled.program.tables();
        let mut now = Vec::new();
        for (clearable, clears) in self.clears.clone() {
            let clears = self.x.holds(clears.or(clearable));
            now.push(self.x.g().and(clears, here));
        }
        for (all, new) in self.sights.clears.iter_mut().zip(&now) {
            *all = self.x.g().or(*all, *new);
        }
        let mut sides_of = vec![(Vec::new(), Vec::new()); self.steps.len()];
        for (rank, clears) in (0u32..).zip(&now) {
            let (from, to) = sides(t, rank);
            for s in from {
                sides_of.get_mut(s as usize).into_iter().for_each(|(l, _)| l.push(*clears));
            }
            for s in to {
                sides_of.get_mut(s as usize).into_iter().for_each(|(_, e)| e.push(*clears));
            }
        }
        let mut found = Vec::new();
        for (step, (leaves, enters)) in self.steps.clone().into_iter().zip(sides_of) {
            let active = self.x.holds(step);
            let (leaves, enters) = (self.x.g().any(leaves), self.x.g().any(enters));
            found.push(self.x.g().all([active, enters, !leaves]));
        }
        self.x.g().any(found)
    }

    /// Notes where two rivals are clearable; `run` is that before orders that disagree have
    /// ended the scan. Each transition is judged by itself, as if none before it were clearable.
    fn conflicts(&mut self, run: Signal, judging: &[Stmt]) {
        let ranks: BTreeMap<MemoryId, usize> =
            self.clears.iter().enumerate().filter_map(|(rank, c)| Some((c.0?, rank))).collect();
        let count = self.clears.len();
        let aside: BTreeSet<MemoryId> = (0u32..)
            .map(MemoryId)
            .zip(&self.x.e.memories)
            .filter(|(_, m)| matches!(m.what, What::Clearable(_) | What::Settled(_)))
            .map(|(id, _)| id)
            .collect();
        let off = || vec![Value::truth(Signal::FALSE)];
        let holds = self.x.glance(|x| {
            x.run = run;
            aside.iter().for_each(|m| x.put(*m, off()));
            let mut holds = vec![Signal::FALSE; count];
            for s in judging {
                x.all(std::slice::from_ref(s));
                let mut set = Vec::new();
                s.visit(&mut |s| {
                    if let Stmt::Set(m, _) = s {
                        set.push(*m);
                    }
                });
                for m in set.into_iter().filter(|m| aside.contains(m)) {
                    let (now, run) = (x.holds(Some(m)), x.run);
                    let now = x.g().and(now, run);
                    if let Some(found) = ranks.get(&m).and_then(|rank| holds.get_mut(*rank)) {
                        *found = x.g().or(*found, now);
                    }
                }
                aside.iter().for_each(|m| x.put(*m, off()));
            }
            holds
        });
        let path = self.x.path;
        let here = self.x.g().and(path, run);
        let mut pairs = Vec::new();
        for (a, b) in &self.rivals {
            let of = |r: &u32| holds.get(*r as usize).copied().unwrap_or(Signal::FALSE);
            pairs.push(self.x.g().and(of(a), of(b)));
        }
        let any = self.x.g().any(pairs);
        let found = self.x.g().and(any, here);
        self.sights.conflict = self.x.g().or(self.sights.conflict, found);
    }
}

/// The states of a search that its last state was compared with.
struct Back {
    /// 1 where it is one of them as a whole.
    whole: Signal,
    /// 1 where some part of it is what it was, and was something else in between.
    moved: Signal,
    /// For each part, 1 where it is what it was before.
    closed: Vec<Signal>,
}

impl Default for Back {
    fn default() -> Back {
        Back { whole: Signal::FALSE, moved: Signal::FALSE, closed: Vec::new() }
    }
}

/// False if no state and no inputs make the signal 1.
fn is_possible(system: &System, s: Signal, stop: &(dyn Fn() -> bool + Sync)) -> bool {
    let mut any = system.clone();
    for l in &mut any.latches {
        (l.init, l.next) = (Init::Free, l.signal);
    }
    let effort = Effort { bytes: usize::MAX, turns: 1, stop };
    !matches!(decide(&any, &[s], &effort).first(), Some(Found::Never(_)))
}
