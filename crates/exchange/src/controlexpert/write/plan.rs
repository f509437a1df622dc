//! The structure of a chart, as far as its drawing follows from it.

use std::collections::HashMap;

use crate::flow::Ends;

/// A transition that the grid has no place for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Undrawn {
    /// No step stands before it.
    Source(usize),
    /// No step stands behind it.
    Sink(usize),
    /// The transition joins branches, but this step has another transition besides.
    Joined(usize, usize),
    /// The transition begins branches, but this step begins other branches as well.
    Parted(usize, usize),
}

/// Steps and transitions by number.
#[derive(Debug)]
pub(super) struct Plan {
    transitions: Vec<Ends>,
    /// The transitions behind each step, in the order in which they are evaluated.
    out: Vec<Vec<usize>>,
    /// The transitions that lead to each step and to no other.
    into: Vec<Vec<usize>>,
    /// The groups of steps that begin parallel branches.
    sets: Vec<Vec<usize>>,
    /// The group that a transition leads to.
    set_behind: Vec<Option<usize>>,
    /// The group of a step.
    set_of: Vec<Option<usize>>,
    /// The steps at which drawing begins: initial and entry steps.
    first: Vec<usize>,
}

impl Plan {
    /// The structure. `ranks` gives the order of the transitions behind one step; drawing begins at the steps `first`.
    ///
    /// # Errors
    ///
    /// The transitions that the grid has no place for.
    pub(super) fn new(
        steps: usize,
        transitions: Vec<Ends>,
        ranks: &[(u32, usize)],
        first: Vec<usize>,
    ) -> Result<Plan, Vec<Undrawn>> {
        let mut wrong = Vec::new();
        let mut plan = Plan {
            out: vec![Vec::new(); steps],
            into: vec![Vec::new(); steps],
            sets: Vec::new(),
            set_behind: vec![None; transitions.len()],
            set_of: vec![None; steps],
            transitions,
            first,
        };
        plan.lists(ranks, &mut wrong);
        plan.joins(&mut wrong);
        plan.groups(&mut wrong);
        if wrong.is_empty() { Ok(plan) } else { Err(wrong) }
    }

    fn lists(&mut self, ranks: &[(u32, usize)], wrong: &mut Vec<Undrawn>) {
        for (number, ends) in self.transitions.iter().enumerate() {
            for step in &ends.from {
                self.out.get_mut(*step).into_iter().for_each(|list| list.push(number));
            }
            if let [only] = ends.to.as_slice() {
                self.into.get_mut(*only).into_iter().for_each(|list| list.push(number));
            }
            match (ends.from.is_empty(), ends.to.is_empty()) {
                (true, _) => wrong.push(Undrawn::Source(number)),
                (false, true) => wrong.push(Undrawn::Sink(number)),
                (false, false) => {}
            }
        }
        for list in &mut self.out {
            list.sort_by_key(|t| ranks.get(*t).copied());
        }
    }

    /// A joint stands directly below its steps. So these steps have no other transition.
    fn joins(&self, wrong: &mut Vec<Undrawn>) {
        for (number, ends) in self.transitions.iter().enumerate() {
            if ends.from.len() > 1 {
                let shared = ends.from.iter().find(|s| self.out(**s).len() > 1);
                wrong.extend(shared.map(|step| Undrawn::Joined(number, *step)));
            }
        }
    }

    /// A branch stands directly above its steps. So a step stands below one branch only.
    fn groups(&mut self, wrong: &mut Vec<Undrawn>) {
        let mut known: HashMap<Vec<usize>, usize> = HashMap::new();
        for number in 0..self.transitions.len() {
            let to = self.to(number).to_vec();
            if to.len() < 2 {
                continue;
            }
            let mut key = to.clone();
            key.sort_unstable();
            let next = self.sets.len();
            let set = *known.entry(key).or_insert(next);
            if set == next {
                let shared = to.iter().find(|s| self.set_of(**s).is_some());
                wrong.extend(shared.map(|step| Undrawn::Parted(number, *step)));
                for step in &to {
                    self.set_of.get_mut(*step).into_iter().for_each(|s| *s = Some(set));
                }
                self.sets.push(to);
            }
            self.set_behind.get_mut(number).into_iter().for_each(|s| *s = Some(set));
        }
    }

    pub(super) fn steps(&self) -> usize {
        self.out.len()
    }

    pub(super) fn transitions(&self) -> usize {
        self.transitions.len()
    }

    pub(super) fn from(&self, transition: usize) -> &[usize] {
        self.transitions.get(transition).map_or(&[], |t| &t.from)
    }

    pub(super) fn to(&self, transition: usize) -> &[usize] {
        self.transitions.get(transition).map_or(&[], |t| &t.to)
    }

    pub(super) fn out(&self, step: usize) -> &[usize] {
        self.out.get(step).map_or(&[], Vec::as_slice)
    }

    pub(super) fn into(&self, step: usize) -> &[usize] {
        self.into.get(step).map_or(&[], Vec::as_slice)
    }

    pub(super) fn sets(&self) -> usize {
        self.sets.len()
    }

    pub(super) fn set(&self, set: usize) -> &[usize] {
        self.sets.get(set).map_or(&[], Vec::as_slice)
    }

    pub(super) fn set_of(&self, step: usize) -> Option<usize> {
        self.set_of.get(step).copied().flatten()
    }

    pub(super) fn set_behind(&self, transition: usize) -> Option<usize> {
        self.set_behind.get(transition).copied().flatten()
    }

    /// All steps, in the order in which a drawing may begin at them.
    pub(super) fn roots(&self) -> impl Iterator<Item = usize> + '_ {
        self.first.iter().copied().chain(0..self.steps())
    }
}
