//! Which symbol an entry of a layout section names, and how far away it can place one.

use std::collections::HashMap;

use g7_model::{Chart, Placed};

use crate::End;

/// Greatest coordinate that a layout section can give.
pub(crate) const FAR: i32 = 10_000_000;

/// The symbols of a chart by the names that a layout section uses. If a name occurs twice, the first
/// symbol has it.
pub(crate) struct Named<'c> {
    steps: HashMap<&'c str, u32>,
    labels: HashMap<&'c str, u32>,
}

impl<'c> Named<'c> {
    #[inline(never)]
    pub(crate) fn new(chart: &'c Chart) -> Named<'c> {
        let mut named = Named { steps: HashMap::new(), labels: HashMap::new() };
        for (n, s) in (0..).zip(chart.steps()) {
            named.steps.entry(&s.name.text).or_insert(n);
        }
        for (n, t) in (0..).zip(chart.transitions()) {
            if let Some(label) = &t.label {
                named.labels.entry(&label.text).or_insert(n);
            }
        }
        named
    }

    /// The step or transition that an entry places; `None` for a comment and for an unknown name.
    pub(crate) fn symbol(&self, entry: &Placed) -> Option<End> {
        match entry {
            Placed::Step(name) => self.steps.get(&*name.text).copied().map(End::Step),
            Placed::Transition(label) => self.labels.get(&*label.text).copied().map(End::Transition),
            Placed::TransitionNumber(n) => Some(End::Transition(*n)),
            _ => None,
        }
    }
}
