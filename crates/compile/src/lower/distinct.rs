//! Steps gathered in some order, each of them once.

use std::collections::HashSet;

use g7_engine::StepId as Number;

/// Up to so many steps a look at each of them is quicker than a hash.
const FEW: usize = 16;

/// Steps in the order in which they were added first.
#[derive(Default)]
pub(super) struct Distinct {
    list: Vec<Number>,
    /// The same steps, as soon as there are more than a few: a transition may have
    /// a hundred thousand on one side.
    known: HashSet<u32>,
}

impl Distinct {
    /// Adds a step that is not there yet.
    pub(super) fn add(&mut self, step: Number) {
        if self.list.len() == FEW {
            self.known.extend(self.list.iter().map(|s| s.0));
        }
        let new = if self.list.len() < FEW { !self.list.contains(&step) } else { self.known.insert(step.0) };
        if new {
            self.list.push(step);
        }
    }

    pub(super) fn clear(&mut self) {
        self.list.clear();
        self.known.clear();
    }

    pub(super) fn as_slice(&self) -> &[Number] {
        &self.list
    }
}
