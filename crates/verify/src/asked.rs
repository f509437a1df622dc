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

    fn join(&mut self, other: &Places) {
        for (w, o) in self.0.iter_mut().zip(&other.0) {
            *w |= o;
        }
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
    reads: Places,
}

/// The inputs that each part of a program reads.
pub(crate) struct Asking {
    count: usize,
    arcs: Vec<Arc>,
    /// For each step, what is read while it is active, as it becomes so or ceases to be.
    steps: Vec<Places>,
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
            let mut places = Places::new(count);
            for s in subjects {
                p.reads(s).inputs(p).for_each(|a| places.insert((a.0 - t.inputs.start) as usize));
            }
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
        let code = [t.pre, t.services, t.post, t.tail].map(Subject::Code);
        let gates = (0..t.blocks.len() as u32).map(Subject::Gate);
        let bodies = t.blocks.iter().filter(|b| b.action != NONE).map(|b| Subject::Action(b.action));
        let watches = (0..t.watches.len() as u32).map(|w| Subject::Watch(WatchId(w)));
        Asking {
            count,
            arcs,
            steps: (0..t.steps.len() as u32).map(|s| reads(of_step(t, s))).collect(),
            with,
            always: reads(code.into_iter().chain(gates).chain(bodies).collect()),
            watched: reads(watches.chain(queries.map(Subject::Code)).collect()),
            initial: t.initial.iter().map(|s| s.0).collect(),
            far: t.rules.stable || t.rules.sequential,
            free: t.code.iter().any(|op| matches!(op, Op::Service(_))),
        }
    }

    /// The inputs that parts of the chart may read in the next scan.
    pub(crate) fn asked(&self, state: &State) -> Places {
        let mut found = self.always.clone();
        let mut active = vec![false; self.steps.len()];
        let mut new: Vec<u32> = state.active().map(|s: StepId| s.0).collect();
        if !state.is_started() || self.free {
            new.extend(&self.initial);
        }
        if self.free {
            new.extend(0..self.steps.len() as u32);
        }
        let mut fired = vec![false; self.arcs.len()];
        let mut round = 0;
        while !new.is_empty() || round == 0 {
            while let Some(s) = new.pop() {
                let Some(on) = active.get_mut(s as usize) else { continue };
                if !std::mem::replace(on, true) {
                    self.steps.get(s as usize).into_iter().for_each(|p| found.join(p));
                    new.extend(self.with.get(s as usize).into_iter().flatten());
                }
            }
            if round > 0 && !self.far {
                break;
            }
            round += 1;
            let is_active = |s: &u32| active.get(*s as usize).copied().unwrap_or(false);
            for (arc, fired) in
                self.arcs.iter().zip(&mut fired).filter(|(a, f)| !**f && a.from.iter().all(is_active))
            {
                *fired = true;
                found.join(&arc.reads);
                new.extend(&arc.to);
            }
        }
        found
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

    /// The transitions behind a step.
    pub(crate) fn behind(&self, step: StepId) -> usize {
        self.arcs.iter().filter(|a| a.from.contains(&step.0)).count()
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
