//! The inputs that matter in a state: those that some part reads which the next scan may wake.
//!
//! From the active steps all transitions are followed that their situation enables, whatever
//! their receptivities, and from the steps behind these again, as far as one scan can go.
//! These parts read more than the scan reads, never less.

use g7_engine::{Extra, NONE, Op, Program, Rows, Situation, State, StepId, Subject, Tables, WatchId};

/// A set of inputs, by their places.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Places(Vec<u64>);

impl Places {
    fn new(count: usize) -> Places {
        Places(vec![0; count.div_ceil(64)])
    }

    fn insert(&mut self, place: usize) {
        if let Some(w) = self.0.get_mut(place / 64) {
            *w |= 1 << (place % 64);
        }
    }

    fn add(&mut self, places: &[u32]) {
        places.iter().for_each(|i| self.insert(*i as usize));
    }

    fn join(&mut self, other: &Places) {
        for (w, o) in self.0.iter_mut().zip(&other.0) {
            *w |= o;
        }
    }

    pub(crate) fn contains(&self, place: usize) -> bool {
        self.0.get(place / 64).is_some_and(|w| w >> (place % 64) & 1 != 0)
    }

    fn clear(&mut self) {
        self.0.fill(0);
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = usize> + '_ {
        let bits = |w: u64| (0..64).filter(move |i| w >> i & 1 != 0);
        self.0.iter().enumerate().flat_map(move |(k, w)| bits(*w).map(move |i| k * 64 + i))
    }
}

/// A transition with what follows when it clears.
struct Arc {
    from: Vec<u32>,
    to: Vec<u32>,
    reads: Vec<u32>,
}

/// Room for the work of [`Asking`], kept from one state to the next.
#[derive(Default)]
pub(crate) struct Room {
    active: Vec<bool>,
    /// For each arc, how many of the steps before it are not active yet.
    missing: Vec<u32>,
    /// Steps to be activated.
    new: Vec<u32>,
    /// Arcs whose preceding steps are active.
    ready: Vec<u32>,
    next: Vec<u32>,
}

/// The inputs that each part of a program reads.
pub(crate) struct Asking {
    count: usize,
    arcs: Vec<Arc>,
    /// For each step, the arcs behind it.
    outs: Vec<Vec<u32>>,
    /// For each arc, the number of steps before it; arcs without any.
    needs: Vec<u32>,
    sources: Vec<u32>,
    /// For each step, what is read while it is active, as it becomes so or ceases to be.
    steps: Vec<Vec<u32>>,
    /// For each step, the steps that become active with it, by links or by orders.
    with: Vec<Vec<u32>>,
    /// Read in every scan by code of the chart.
    always: Places,
    /// Kept from scan to scan, or read by conditions of questions and assumptions.
    watched: Places,
    initial: Vec<u32>,
    /// A scan may go further than one transition.
    far: bool,
    /// Code may change any step.
    free: bool,
}

impl Asking {
    /// `queries` are codes that are evaluated behind each scan.
    pub(crate) fn new(p: &Program, queries: impl Iterator<Item = g7_engine::Code>) -> Asking {
        let t = p.tables();
        let count = (t.inputs.end - t.inputs.start) as usize;
        let reads = |subjects: Vec<Subject>| {
            let mut places: Vec<u32> = Vec::new();
            for s in subjects {
                places.extend(p.reads(s).inputs(p).map(|a| a.0 - t.inputs.start));
            }
            places.sort_unstable();
            places.dedup();
            places
        };
        let all = |list: Vec<u32>| {
            let mut places = Places::new(count);
            places.add(&list);
            places
        };
        let mut arcs = Vec::new();
        for (rank, tr) in (0u32..).zip(&t.transitions) {
            let from = ends(t, tr.from.0, tr.more_from);
            let to = ends(t, tr.to.0, tr.more_to);
            let mut subjects = vec![Subject::Transition(rank)];
            subjects.extend((tr.on_clearing != NONE).then_some(Subject::Action(tr.on_clearing)));
            arcs.push(Arc { from, to, reads: reads(subjects) });
        }
        let mut with: Vec<Vec<u32>> = (0..t.steps.len() as u32)
            .map(|s| extra(t, s).map_or(Vec::new(), |e| steps(t, e.links)))
            .collect();
        for order in &t.orders {
            if let (Situation::Steps(rows), Some(list)) =
                (order.situation, with.get_mut(order.step.0 as usize))
            {
                list.extend(steps(t, rows));
            }
        }
        let mut outs = vec![Vec::new(); t.steps.len()];
        for (k, arc) in (0u32..).zip(&mut arcs) {
            arc.from.sort_unstable();
            arc.from.dedup();
            for step in &arc.from {
                outs.get_mut(*step as usize).into_iter().for_each(|list| list.push(k));
            }
        }
        let needs: Vec<u32> = arcs.iter().map(|a| a.from.len() as u32).collect();
        let sources = (0u32..).zip(&needs).filter(|(_, n)| **n == 0).map(|(k, _)| k).collect();
        let code = [t.pre, t.services, t.post, t.tail].map(Subject::Code);
        let gates = (0..t.blocks.len() as u32).map(Subject::Gate);
        let bodies = t.blocks.iter().filter(|b| b.action != NONE).map(|b| Subject::Action(b.action));
        let watches = (0..t.watches.len() as u32).map(|w| Subject::Watch(WatchId(w)));
        Asking {
            count,
            arcs,
            outs,
            needs,
            sources,
            steps: (0..t.steps.len() as u32).map(|s| reads(of_step(t, s))).collect(),
            with,
            always: all(reads(code.into_iter().chain(gates).chain(bodies).collect())),
            watched: all(reads(watches.chain(queries.map(Subject::Code)).collect())),
            initial: t.initial.iter().map(|s| s.0).collect(),
            far: t.rules.stable || t.rules.sequential,
            free: t.code.iter().any(|op| matches!(op, Op::Service(_))),
        }
    }

    /// The inputs that parts of the chart may read in the next scan.
    pub(crate) fn asked(&self, state: &State) -> Places {
        let mut found = Places::new(self.count);
        let steps = state.active().map(|s: StepId| s.0);
        self.find(steps, state.is_started(), self.far, true, &mut Room::default(), &mut found);
        found
    }

    /// The inputs that parts of the chart may have read in a scan that began with these steps and
    /// cleared these transitions (ranks), and those that are kept or that questions read. For any other
    /// values of all other inputs the scan would have been the same.
    pub(crate) fn read(
        &self,
        before: &[u32],
        is_started: bool,
        cleared: &[u32],
        room: &mut Room,
        found: &mut Places,
    ) {
        let entered = cleared.iter().filter_map(|r| self.arcs.get(*r as usize)).flat_map(|a| &a.to);
        self.find(before.iter().chain(entered).copied(), is_started, false, false, room, found);
        found.join(&self.watched);
    }

    /// The inputs that are read from these steps on. With `follow`, transitions clear whatever their receptivities,
    /// and with `far` those behind them as well.
    fn find(
        &self,
        steps: impl Iterator<Item = u32>,
        is_started: bool,
        far: bool,
        follow: bool,
        room: &mut Room,
        found: &mut Places,
    ) {
        let Room { active, missing, new, ready, next } = room;
        if found.0.len() == self.always.0.len() {
            found.clear();
            found.join(&self.always);
        } else {
            found.clone_from(&self.always);
        }
        active.clear();
        active.resize(self.steps.len(), false);
        missing.clone_from(&self.needs);
        ready.clone_from(&self.sources);
        new.clear();
        new.extend(steps);
        if !is_started || self.free {
            new.extend(&self.initial);
        }
        if self.free {
            new.extend(0..self.steps.len() as u32);
        }
        let mut first = true;
        loop {
            while let Some(s) = new.pop() {
                let Some(on) = active.get_mut(s as usize) else { continue };
                if !std::mem::replace(on, true) {
                    self.steps.get(s as usize).into_iter().for_each(|list| found.add(list));
                    new.extend(self.with.get(s as usize).into_iter().flatten());
                    for arc in self.outs.get(s as usize).into_iter().flatten() {
                        if let Some(n) = missing.get_mut(*arc as usize) {
                            *n = n.saturating_sub(1);
                            ready.extend((*n == 0).then_some(*arc));
                        }
                    }
                }
            }
            if ready.is_empty() || !(first || far) {
                return;
            }
            first = false;
            std::mem::swap(ready, next);
            for arc in next.drain(..).filter_map(|k| self.arcs.get(k as usize)) {
                found.add(&arc.reads);
                if follow {
                    new.extend(&arc.to);
                }
            }
        }
    }

    /// The same with those that are kept, and those that questions read.
    pub(crate) fn matter(&self, asked: &Places) -> Places {
        let mut all = asked.clone();
        all.join(&self.watched);
        all
    }

    /// Number of inputs.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Shows the steps of each part that reads inputs, with the places of these.
    pub(crate) fn each(
        &self,
        mut show: impl FnMut(&mut dyn Iterator<Item = u32>, &mut dyn Iterator<Item = usize>),
    ) {
        for arc in &self.arcs {
            show(&mut arc.from.iter().chain(&arc.to).copied(), &mut arc.reads.iter().map(|i| *i as usize));
        }
        for ((s, reads), with) in (0u32..).zip(&self.steps).zip(&self.with) {
            show(&mut std::iter::once(s).chain(with.iter().copied()), &mut reads.iter().map(|i| *i as usize));
        }
    }

    /// The transitions behind a step.
    pub(crate) fn behind(&self, step: StepId) -> usize {
        self.outs.get(step.0 as usize).map_or(0, Vec::len)
    }
}

fn ends(t: &Tables, first: u32, more: Rows) -> Vec<u32> {
    std::iter::once(first).filter(|s| *s != NONE).chain(steps(t, more)).collect()
}

fn steps(t: &Tables, rows: Rows) -> Vec<u32> {
    t.arcs.get(rows.start as usize..rows.end as usize).unwrap_or(&[]).iter().map(|s| s.0).collect()
}

fn extra(t: &Tables, step: u32) -> Option<&Extra> {
    t.steps.get(step as usize).and_then(|s| t.extras.get(s.extra as usize))
}

/// The parts that read while a step is active, as it becomes so and as it ceases to be.
fn of_step(t: &Tables, step: u32) -> Vec<Subject> {
    let Some(e) = extra(t, step) else { return Vec::new() };
    let rows = |r: Rows| r.start as usize..r.end as usize;
    let stored = [e.on, e.off].into_iter().flat_map(|r| t.action_lists.get(rows(r)).unwrap_or(&[]));
    let each = t.periodics.get(rows(e.periodics)).unwrap_or(&[]);
    let mut subjects: Vec<Subject> = stored.chain(each).map(|a| Subject::Action(*a)).collect();
    for row in e.events.start..e.events.end {
        subjects.push(Subject::Event(row));
        subjects.extend(t.events.get(row as usize).map(|e| Subject::Action(e.action)));
    }
    subjects.extend((e.contributions.start..e.contributions.end).map(Subject::Contribution));
    subjects
}
