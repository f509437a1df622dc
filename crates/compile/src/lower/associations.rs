//! Who drives what: the actions that name one variable or one body, looked at
//! together before any of them is lowered.

use g7_model::{Qualifier, Type};

use super::words::word_of;
use super::work::Lower;
use crate::ir::{ActionKind, BodyId, StepId, VarClass, VarId};

/// All associations of one variable or named action.
#[derive(Clone, Copy, Default)]
pub(super) struct Association {
    /// How many.
    pub(super) count: u32,
    /// The period of their charts; `None` before the first.
    period: Option<u32>,
    /// Their charts differ in period.
    mixed: bool,
    /// One of P P1 P0 SD DS SL (and N D L where they are no continuous actions),
    /// which only a control block can do.
    block_only: bool,
    /// An input other than N comes into its control block.
    full: bool,
    /// Only pulses on activation.
    others_than_p1: bool,
    /// Only pulses on deactivation.
    others_than_p0: bool,
}

impl Association {
    /// The period of its control block: that of its charts, else each scan.
    pub(super) fn period(&self) -> u32 {
        if self.mixed { 0 } else { self.period.unwrap_or(0) }
    }

    /// The pulse it consists of, where it is nothing else.
    pub(super) fn pulse(&self) -> Option<Qualifier> {
        match (self.others_than_p1, self.others_than_p0) {
            (false, true) => Some(Qualifier::P1),
            (true, false) => Some(Qualifier::P0),
            (true, true) | (false, false) => None,
        }
    }

    /// True if a variable's control block is no more than "some N is true".
    pub(super) fn is_plain(&self) -> bool {
        !self.full
    }

    /// `continuous`: N, D and L are continuous actions of their own, not inputs
    /// of a control block.
    fn add(&mut self, qualifier: Qualifier, period: u32, continuous: bool) {
        use Qualifier::{D, DS, L, N, P, P0, P1, SD, SL};
        self.count += 1;
        self.mixed |= self.period.is_some_and(|p| p != period);
        self.period = Some(period);
        self.block_only |= match qualifier {
            P | P0 | P1 | SD | DS | SL => true,
            N | D | L => !continuous,
            Qualifier::S | Qualifier::R => false,
        };
        self.others_than_p1 |= qualifier != P1;
        self.others_than_p0 |= qualifier != P0;
    }
}

/// The lowering of a qualifier on a Boolean variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    /// Stored action on activation that writes this value.
    Store(bool),
    /// Input of the control block.
    Block,
    /// Input N of the control block, from the time on (D) or until it (L).
    Delayed,
    Limited,
}

/// The associations of a unit.
#[derive(Default)]
pub(super) struct Associations {
    vars: Vec<Association>,
    bodies: Vec<Association>,
}

impl Associations {
    pub(super) fn var(&self, id: VarId) -> Association {
        self.vars.get(id.index()).copied().unwrap_or_default()
    }

    pub(super) fn body(&self, id: BodyId) -> Association {
        self.bodies.get(id.index()).copied().unwrap_or_default()
    }
}

impl Lower<'_> {
    /// Looks at all actions of the steps that run.
    pub(super) fn associations(&self) -> Associations {
        let continuous = self.unit.rules.continuous;
        let mut a = Associations {
            vars: vec![Association::default(); self.unit.vars.len()],
            bodies: vec![Association::default(); self.unit.bodies.len()],
        };
        for (step, period) in self.acting_steps() {
            for action in self.unit.steps.get(step.index()).map_or(&[][..], |s| &s.actions) {
                match action.kind {
                    ActionKind::Variable { qualifier, var, .. } => {
                        if let Some(v) = a.vars.get_mut(var.index()) {
                            v.add(qualifier, period, continuous);
                        }
                    }
                    ActionKind::Named { qualifier, body, .. } => {
                        if let Some(b) = a.bodies.get_mut(body.index()) {
                            b.add(qualifier, period, continuous);
                        }
                    }
                    ActionKind::Work { .. }
                    | ActionKind::OnEvent { .. }
                    | ActionKind::EachScan { .. }
                    | ActionKind::Force(..)
                    | ActionKind::Enable(_)
                    | ActionKind::MaskChart(_)
                    | ActionKind::MaskVar(_) => {}
                }
            }
        }
        // Which inputs a block has depends on all of them.
        for (step, _) in self.acting_steps() {
            for action in self.unit.steps.get(step.index()).map_or(&[][..], |s| &s.actions) {
                if let ActionKind::Variable { qualifier, var, .. } = action.kind
                    && qualifier != Qualifier::N
                    && self.way(qualifier, a.var(var)) == Way::Block
                    && let Some(v) = a.vars.get_mut(var.index())
                {
                    v.full = true;
                }
            }
        }
        a
    }

    /// The steps with actions that run, in text order, with their periods.
    pub(super) fn acting_steps(&self) -> impl Iterator<Item = (StepId, u32)> + '_ {
        self.unit.steps.iter().enumerate().filter(|(_, s)| !s.actions.is_empty()).filter_map(|(i, s)| {
            let id = StepId(i as u32);
            self.plan.own(id).map(|_| (id, self.period(s.chart)))
        })
    }

    /// The lowering of a qualifier on a variable with these associations.
    pub(super) fn way(&self, qualifier: Qualifier, all: Association) -> Way {
        let rules = &self.unit.rules;
        let continuous = rules.continuous && !all.block_only;
        match qualifier {
            Qualifier::S if rules.stored_set_reset && !all.block_only => Way::Store(true),
            Qualifier::R if rules.stored_set_reset && !all.block_only => Way::Store(false),
            Qualifier::D if continuous => Way::Delayed,
            Qualifier::L if continuous => Way::Limited,
            Qualifier::N
            | Qualifier::S
            | Qualifier::R
            | Qualifier::L
            | Qualifier::D
            | Qualifier::P
            | Qualifier::P0
            | Qualifier::P1
            | Qualifier::SD
            | Qualifier::DS
            | Qualifier::SL => Way::Block,
        }
    }

    /// True if an unconditional N may write its variable together with the
    /// step's activity: nothing else drives the variable, and nothing looks at
    /// it before the end of the scan, so that nobody sees it between two passes.
    pub(super) fn may_be_direct(&self, step: StepId, var: VarId, all: Association) -> bool {
        let Some(v) = self.unit.vars.get(var.index()) else { return false };
        let Some(s) = self.unit.steps.get(step.index()) else { return false };
        let seen = |table: &[bool]| table.get(var.index()).copied().unwrap_or(true);
        all.count == 1
            && matches!(v.class, VarClass::Output | VarClass::Internal)
            && v.ty == Type::Bool
            && v.elements == 1
            && !v.retain
            && word_of(v.ty, &v.init) == 0
            && !seen(&self.uses.early)
            && !seen(&self.uses.written)
            && self.masking(var).is_empty()
            && self.masking_chart(s.chart).is_empty()
            // Steps can change by force in scans in which the outputs must stay.
            && self.period(s.chart) == 0
    }
}
