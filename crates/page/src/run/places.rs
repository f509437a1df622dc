//! The numbers of steps and transitions in the frames of a run, and the ids that they stand for.

use std::collections::BTreeMap;

use g7_ide::ids::{self, Thing};
use g7_model::Span;
use g7_rig::{Bench, Source, StepItem};
use serde::Serialize;

/// A symbol of a drawing in a run.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "RunPart", optional_fields))]
pub struct Part {
    /// The id of the symbol.
    pub id: String,
    /// The instance that it belongs to, `Axis[3]`, if its chart has parameters: then several parts have one symbol.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub instance: Option<String>,
}

impl Part {
    /// A symbol as a part of a chart of the program.
    fn of(symbol: &(String, String), chart: &str) -> Part {
        let (id, drawn) = symbol;
        Part { id: id.clone(), instance: Some(chart.to_owned()).filter(|c| c != drawn) }
    }
}

/// The ids of the parts of a program, by their numbers in frames.
#[derive(Debug, Default)]
pub struct Places {
    steps: Vec<Part>,
    transitions: Vec<Part>,
    /// The number of the transition with each rank.
    ranks: Vec<Option<u32>>,
}

impl Places {
    /// The ids for a bench that was built from this source.
    pub fn new(source: &Source, bench: &Bench) -> Places {
        let mut steps: BTreeMap<Span, (String, String)> = BTreeMap::new();
        let mut transitions = steps.clone();
        for (at, thing) in ids::things(source.whole()) {
            match thing {
                Thing::Step(c, s) => _ = steps.insert(s.name.at.0, (thing.id(), c.name.text.to_string())),
                Thing::Transition(c, ..) => _ = transitions.insert(at, (thing.id(), c.name.text.to_string())),
                Thing::Action(..) => {}
            }
        }
        let symbols = &bench.compiled.symbols;
        let step = |s: &StepItem| steps.get(&s.at).map(|id| Part::of(id, &s.chart)).unwrap_or_default();
        let mut places = Places { steps: bench.steps.iter().map(step).collect(), ..Places::default() };
        let mut numbers: BTreeMap<Part, u32> = BTreeMap::new();
        places.ranks = (0..symbols.transitions())
            .map(|rank| {
                let symbol = transitions.get(&symbols.transition_place(rank));
                let part =
                    Part::of(symbol.filter(|_| symbols.is_written(rank))?, symbols.transition_chart(rank));
                let next = numbers.len() as u32;
                Some(*numbers.entry(part).or_insert(next))
            })
            .collect();
        let mut numbered: Vec<(Part, u32)> = numbers.into_iter().collect();
        numbered.sort_unstable_by_key(|(_, number)| *number);
        places.transitions = numbered.into_iter().map(|(part, _)| part).collect();
        places
    }

    /// The steps of the bench, in its order.
    pub fn steps(&self) -> &[Part] {
        &self.steps
    }

    /// The transitions.
    pub fn transitions(&self) -> &[Part] {
        &self.transitions
    }

    /// The number of the transition with this rank.
    pub fn transition(&self, rank: u32) -> Option<u32> {
        self.ranks.get(rank as usize).copied().flatten()
    }

    pub(super) fn transition_id(&self, number: u32) -> Option<String> {
        self.transitions.get(number as usize).map(|t| t.id.clone())
    }

    /// The numbers of the steps with a symbol: several, if its chart has parameters.
    pub(super) fn steps_of(&self, id: &str) -> impl Iterator<Item = u32> {
        numbers_of(&self.steps, id)
    }

    /// The numbers of the transitions with a symbol.
    pub(super) fn transitions_of(&self, id: &str) -> impl Iterator<Item = u32> {
        numbers_of(&self.transitions, id)
    }

    pub(super) fn step_id(&self, number: u32) -> Option<String> {
        self.steps.get(number as usize).map(|s| s.id.clone())
    }
}

fn numbers_of(parts: &[Part], id: &str) -> impl Iterator<Item = u32> {
    (0u32..).zip(parts).filter(move |(_, p)| p.id == id).map(|(number, _)| number)
}
