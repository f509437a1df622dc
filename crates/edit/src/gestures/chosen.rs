//! The steps and transitions of one chart that the user has chosen.

use std::collections::BTreeSet;

use g7_model::{Span, Transition};

use super::nodes::{Node, node, one_chart};
use crate::change::Refusal;
use crate::draft::Draft;
use crate::id::ItemId;

/// The chosen steps and transitions of one chart.
pub(crate) struct Chosen {
    pub(crate) chart: String,
    pub(crate) steps: Vec<String>,
    pub(crate) transitions: BTreeSet<Span>,
    names: BTreeSet<String>,
}

impl Chosen {
    /// The steps (in the order of the text) and transitions that the ids name.
    #[inline(never)]
    pub(crate) fn new(d: &Draft<'_>, ids: &[ItemId]) -> Result<Chosen, Refusal> {
        let chart = one_chart(ids)?.to_owned();
        let (mut names, mut transitions) = (BTreeSet::new(), BTreeSet::new());
        for id in ids {
            match node(d, id)? {
                Node::Step(s) => {
                    names.insert(s);
                }
                Node::Transition(t) => {
                    transitions.insert(t);
                }
            }
        }
        let steps = d.chart(&chart)?.steps().map(|s| s.name.text.to_string());
        let steps = steps.filter(|s| names.contains(s)).collect();
        Ok(Chosen { chart, steps, transitions, names })
    }

    pub(crate) fn has_step(&self, name: &str) -> bool {
        self.names.contains(name)
    }

    pub(crate) fn has(&self, t: &Transition) -> bool {
        self.transitions.contains(&t.at.0)
    }
}
