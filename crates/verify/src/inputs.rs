//! Moves made of values of the inputs and times to wait.

use std::collections::BTreeSet;

use g7_engine::{Extra, NONE, Program, Reads, Rows, State, StepId, Subject, Tables, WatchId};

use crate::explore::{Move, Moves};

/// The inputs that are tried in a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// All inputs that some part of the program reads, in every combination.
    All,
    /// The inputs that the enabled transitions, the actions of the active steps and
    /// those of the steps around enabled transitions read. Up to so many are combined,
    /// else those of one reader after the other. This finds most states quickly, but
    /// it decides nothing about all runs: a transient situation may read others.
    Asked {
        /// Most inputs that are combined with one another.
        together: usize,
    },
}

/// A part of the program that reads inputs while certain steps are active.
struct Reader {
    needs: Vec<u32>,
    /// Places in the inputs, ascending.
    inputs: Vec<usize>,
}

/// Tries values of inputs, each with several times to wait.
pub struct Inputs {
    /// For each input word, the values to be tried.
    values: Vec<Vec<u64>>,
    /// The times to wait, ns.
    waits: Vec<i64>,
    which: Which,
    read: Vec<usize>,
    /// Steps that the first scan activates before it judges anything.
    initial: Vec<u32>,
    readers: Vec<Reader>,
}

impl Inputs {
    /// Moves for a program. `values` has, for each word of
    /// [`g7_engine::Tables::inputs`], the values that the input may take; an input
    /// without any stays 0. `waits` has the times to wait before a scan, ns:
    /// with 0 alone, time stands still.
    ///
    /// A search with these moves decides about the runs in which inputs take these
    /// values and scans follow one another at these times.
    pub fn new(p: &Program, which: Which, values: Vec<Vec<u64>>, waits: Vec<i64>) -> Inputs {
        let mut inputs = Inputs {
            values,
            waits,
            which,
            read: Vec::new(),
            initial: p.tables().initial.iter().map(|s| s.0).collect(),
            readers: Vec::new(),
        };
        inputs.readers = inputs.readers_of(p);
        inputs.read = inputs.reader(p, Vec::new(), all(p.tables())).inputs;
        inputs
    }

    /// The places of the inputs among what is read that have values to be tried.
    fn places(&self, p: &Program, reads: &Reads) -> Vec<usize> {
        let from = p.tables().inputs.start;
        let places = reads.inputs(p).map(|a| (a.0 - from) as usize);
        places.filter(|i| self.values.get(*i).is_some_and(|v| !v.is_empty())).collect()
    }

    fn reader(&self, p: &Program, needs: Vec<u32>, subjects: Vec<Subject>) -> Reader {
        let inputs: BTreeSet<usize> = subjects.iter().flat_map(|s| self.places(p, &p.reads(*s))).collect();
        Reader { needs, inputs: inputs.into_iter().collect() }
    }

    fn readers_of(&self, p: &Program) -> Vec<Reader> {
        let t = p.tables();
        let reader = |needs, subjects| self.reader(p, needs, subjects);
        let mut readers = vec![reader(Vec::new(), always(t))];
        for (rank, tr) in (0u32..).zip(&t.transitions) {
            let needs: Vec<u32> = ends(t, tr.from.0, tr.more_from).collect();
            let mut subjects = vec![Subject::Transition(rank)];
            subjects.extend((tr.on_clearing != NONE).then_some(Subject::Action(tr.on_clearing)));
            // Actions run as their steps are entered and left.
            let around = ends(t, tr.from.0, tr.more_from).chain(ends(t, tr.to.0, tr.more_to));
            subjects.extend(around.flat_map(|step| stored(t, step)));
            readers.push(reader(needs, subjects));
        }
        for step in 0..t.steps.len() as u32 {
            readers.push(reader(vec![step], while_active(t, step)));
        }
        readers.retain(|r| !r.inputs.is_empty());
        readers
    }

    /// All values of some inputs, the others as they are.
    fn combine(&self, inputs: &[usize], last: &[u64], found: &mut BTreeSet<Vec<u64>>) {
        let mut list = vec![last.to_vec()];
        for at in inputs {
            let values = self.values.get(*at).map_or(&[][..], Vec::as_slice);
            let each = |old: Vec<u64>| {
                values.iter().map(move |value| {
                    let mut new = old.clone();
                    if let Some(word) = new.get_mut(*at) {
                        *word = *value;
                    }
                    new
                })
            };
            list = list.into_iter().flat_map(each).collect();
        }
        found.extend(list);
    }
}

impl Moves for Inputs {
    fn moves(&self, _: &Program, state: &State, last: &[u64], into: &mut Vec<Move>) -> bool {
        let mut found = BTreeSet::new();
        match self.which {
            Which::All => self.combine(&self.read, last, &mut found),
            Which::Asked { together } => {
                let active = |s: &u32| {
                    state.is_active(StepId(*s)) || (!state.is_started() && self.initial.contains(s))
                };
                let active = |r: &&Reader| r.needs.iter().all(active);
                let asked = || self.readers.iter().filter(active);
                let all: BTreeSet<usize> = asked().flat_map(|r| r.inputs.iter().copied()).collect();
                found.insert(last.to_vec());
                if all.len() <= together {
                    self.combine(&all.into_iter().collect::<Vec<_>>(), last, &mut found);
                } else {
                    asked().for_each(|r| self.combine(&r.inputs, last, &mut found));
                }
            }
        }
        for inputs in found {
            into.extend(self.waits.iter().map(|wait| Move { inputs: inputs.clone(), wait: *wait }));
        }
        self.which == Which::All
    }
}

/// The steps on one side of a transition.
fn ends(t: &Tables, first: u32, more: Rows) -> impl Iterator<Item = u32> {
    let more = t.arcs.get(more.start as usize..more.end as usize).unwrap_or(&[]);
    std::iter::once(first).filter(|s| *s != NONE).chain(more.iter().map(|s| s.0))
}

/// All parts that read.
fn all(t: &Tables) -> Vec<Subject> {
    let rows = |n: usize, part: fn(u32) -> Subject| (0..n as u32).map(part);
    let mut subjects = always(t);
    subjects.extend(rows(t.transitions.len(), Subject::Transition));
    subjects.extend(rows(t.watches.len(), |w| Subject::Watch(WatchId(w))));
    subjects.extend(rows(t.events.len(), Subject::Event));
    subjects.extend(rows(t.actions.len(), Subject::Action));
    subjects.extend(rows(t.contributions.len(), Subject::Contribution));
    subjects
}

/// The parts that read in every scan.
fn always(t: &Tables) -> Vec<Subject> {
    let mut subjects: Vec<Subject> = [t.pre, t.services, t.post, t.tail].map(Subject::Code).to_vec();
    subjects.extend((0..t.blocks.len() as u32).map(Subject::Gate));
    subjects.extend(t.blocks.iter().filter(|b| b.action != NONE).map(|b| Subject::Action(b.action)));
    subjects
}

fn extra(t: &Tables, step: u32) -> Option<&Extra> {
    t.steps.get(step as usize).and_then(|s| t.extras.get(s.extra as usize))
}

/// The actions that run as a step is activated and deactivated.
fn stored(t: &Tables, step: u32) -> Vec<Subject> {
    let rows = extra(t, step).map(|e| [e.on, e.off]);
    let lists = rows.into_iter().flatten();
    lists
        .flat_map(|r| t.action_lists.get(r.start as usize..r.end as usize).unwrap_or(&[]))
        .map(|a| Subject::Action(*a))
        .collect()
}

/// The parts that read while a step is active.
fn while_active(t: &Tables, step: u32) -> Vec<Subject> {
    let Some(e) = extra(t, step) else { return Vec::new() };
    let mut subjects = Vec::new();
    for row in e.events.start..e.events.end {
        subjects.push(Subject::Event(row));
        subjects.extend(t.events.get(row as usize).map(|e| Subject::Action(e.action)));
    }
    let periodics = t.periodics.get(e.periodics.start as usize..e.periodics.end as usize).unwrap_or(&[]);
    subjects.extend(periodics.iter().map(|a| Subject::Action(*a)));
    subjects.extend((e.contributions.start..e.contributions.end).map(Subject::Contribution));
    subjects
}
