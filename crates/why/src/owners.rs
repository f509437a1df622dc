//! Who brings along what: for each action the moments at which it runs, for each control block its inputs.

use g7_engine::{Code, Contribution, Extra, NONE, StepId, Tables};

/// A moment at which an action runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Moment {
    Activation(StepId),
    Deactivation(StepId),
    /// While the step is active and this code gives TRUE.
    Event(StepId, Code),
    Clearing(u32),
    EachScan(StepId),
    /// While the control block (row) gives TRUE.
    Block(u32),
}

pub(crate) struct Owners {
    /// By action (rank).
    moments: Vec<Vec<Moment>>,
    /// By control block (row): the steps with their inputs.
    inputs: Vec<Vec<(StepId, Contribution)>>,
}

impl Owners {
    pub(crate) fn new(t: &Tables) -> Owners {
        let mut owners =
            Owners { moments: vec![Vec::new(); t.actions.len()], inputs: vec![Vec::new(); t.blocks.len()] };
        for (step, row) in (0..).map(StepId).zip(&t.steps) {
            if let Some(extra) = t.extras.get(row.extra as usize) {
                owners.of_step(t, step, extra);
            }
        }
        for (rank, row) in (0..).zip(&t.transitions) {
            if row.on_clearing != NONE {
                owners.add(row.on_clearing, Moment::Clearing(rank));
            }
        }
        for (block, row) in (0..).zip(&t.blocks) {
            if row.action != NONE {
                owners.add(row.action, Moment::Block(block));
            }
        }
        owners
    }

    fn of_step(&mut self, t: &Tables, step: StepId, extra: &Extra) {
        let rows = |r: g7_engine::Rows| r.start as usize..r.end as usize;
        for action in t.action_lists.get(rows(extra.on)).unwrap_or(&[]) {
            self.add(*action, Moment::Activation(step));
        }
        for action in t.action_lists.get(rows(extra.off)).unwrap_or(&[]) {
            self.add(*action, Moment::Deactivation(step));
        }
        for event in t.events.get(rows(extra.events)).unwrap_or(&[]) {
            self.add(event.action, Moment::Event(step, event.event));
        }
        for action in t.periodics.get(rows(extra.periodics)).unwrap_or(&[]) {
            self.add(*action, Moment::EachScan(step));
        }
        for c in t.contributions.get(rows(extra.contributions)).unwrap_or(&[]) {
            if let Some(list) = self.inputs.get_mut(c.block as usize) {
                list.push((step, *c));
            }
        }
    }

    fn add(&mut self, action: u32, moment: Moment) {
        if let Some(list) = self.moments.get_mut(action as usize) {
            list.push(moment);
        }
    }

    pub(crate) fn moments(&self, action: u32) -> &[Moment] {
        self.moments.get(action as usize).map_or(&[], Vec::as_slice)
    }

    pub(crate) fn inputs(&self, block: u32) -> &[(StepId, Contribution)] {
        self.inputs.get(block as usize).map_or(&[], Vec::as_slice)
    }
}
