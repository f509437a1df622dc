//! The numbers of steps and transitions in the frames of a run, and the ids that they stand for.

use std::collections::BTreeMap;

use g7_ide::ids::{self, Thing};
use g7_model::Span;
use g7_rig::{Bench, Source};

/// The ids of the parts of a program, by their numbers in frames.
#[derive(Debug, Default)]
pub struct Places {
    pub(super) steps: Vec<String>,
    pub(super) transitions: Vec<String>,
    /// The number of the transition with each rank.
    ranks: Vec<Option<u32>>,
}

impl Places {
    /// The ids for a bench that was built from this source.
    pub fn new(source: &Source, bench: &Bench) -> Places {
        let mut steps: BTreeMap<Span, String> = BTreeMap::new();
        let mut places = Places::default();
        let mut numbers: BTreeMap<Span, u32> = BTreeMap::new();
        for (at, thing) in ids::things(&source.document) {
            match thing {
                Thing::Step(_, s) => {
                    steps.insert(s.name.at.0, thing.id());
                }
                Thing::Transition(..) => {
                    numbers.insert(at, places.transitions.len() as u32);
                    places.transitions.push(thing.id());
                }
                Thing::Action(..) => {}
            }
        }
        places.steps = bench.steps.iter().map(|s| steps.get(&s.at).cloned().unwrap_or_default()).collect();
        let symbols = &bench.compiled.symbols;
        let number =
            |rank| symbols.is_written(rank).then(|| numbers.get(&symbols.transition_place(rank)).copied());
        places.ranks = (0..symbols.transitions()).map(|rank| number(rank).flatten()).collect();
        places
    }

    /// The ids of the steps of the bench, in its order.
    pub fn steps(&self) -> &[String] {
        &self.steps
    }

    /// The ids of the transitions.
    pub fn transitions(&self) -> &[String] {
        &self.transitions
    }

    /// The number of the transition with this rank.
    pub fn transition(&self, rank: u32) -> Option<u32> {
        self.ranks.get(rank as usize).copied().flatten()
    }

    pub(super) fn transition_id(&self, number: u32) -> Option<String> {
        self.transitions.get(number as usize).cloned()
    }

    pub(super) fn step(&self, id: &str) -> Option<u32> {
        self.steps.iter().position(|s| s == id).and_then(|i| u32::try_from(i).ok())
    }

    pub(super) fn transition_of(&self, id: &str) -> Option<u32> {
        self.transitions.iter().position(|t| t == id).and_then(|i| u32::try_from(i).ok())
    }

    pub(super) fn step_id(&self, number: u32) -> Option<String> {
        self.steps.get(number as usize).cloned()
    }
}
