//! Facts about a unit that later checks rely on: the charts in which at most one step is active at
//! a time, and the values that cannot change between taking the edges and evaluating the
//! receptivities.

use g7_model::Type;

use super::tree::{statements, within, written};
use crate::ir::{
    ActionKind, Chart, ChartId, ChartRole, Expr, ExprKind, Service, Situation, StepId, StmtKind, Unit,
    VarClass, VarId,
};

pub(super) struct Facts<'u> {
    pub(super) unit: &'u Unit,
    /// By chart: true if two of its steps are never active at once.
    pub(super) single: Vec<bool>,
    /// By variable: true if preliminary processing writes it.
    moved: Vec<bool>,
    /// True if services or system bits can change the situation before the evolution.
    serviced: bool,
    /// By step: the transitions that follow it.
    branches: Vec<Vec<u32>>,
}

impl<'u> Facts<'u> {
    /// The facts that hold by the form of the charts alone; `settle` looks at the receptivities too.
    #[inline(never)]
    pub(super) fn by_form(unit: &'u Unit) -> Facts<'u> {
        let mut branches = vec![Vec::new(); unit.steps.len()];
        for (i, t) in unit.transitions.iter().enumerate() {
            for from in &t.from {
                // A step that is written twice on one side counts once.
                if let Some(list) = branches.get_mut(from.index())
                    && list.last() != Some(&(i as u32))
                {
                    list.push(i as u32);
                }
            }
        }
        let mut moved = vec![false; unit.vars.len()];
        for v in within(unit.pre.iter().flat_map(|b| &b.statements)).into_iter().flat_map(written) {
            if let Some(m) = moved.get_mut(v.index()) {
                *m = true;
            }
        }
        let mut facts = Facts { unit, single: Vec::new(), moved, serviced: serviced(unit), branches };
        facts.single = facts.shapes();
        facts
    }

    /// The transitions that follow a step, in text order.
    pub(super) fn branches(&self, step: StepId) -> &[u32] {
        self.branches.get(step.index()).map_or(&[], Vec::as_slice)
    }

    /// The chart of a step, if only one of the chart's steps is active at a time.
    pub(super) fn group(&self, step: StepId) -> Option<ChartId> {
        let s = self.unit.steps.get(step.index())?;
        self.single.get(s.chart.index()).copied().unwrap_or(false).then_some(s.chart)
    }

    /// True if two steps are never active at the same time.
    pub(super) fn exclude(&self, a: StepId, b: StepId) -> bool {
        let (way, other) = (self.way(a), self.way(b));
        way.iter().any(|(chart, step)| {
            self.single.get(chart.index()) == Some(&true)
                && other.iter().any(|(c, s)| c == chart && s != step)
        })
    }

    /// A step and the macro-steps around it, each with its chart.
    #[inline(never)]
    fn way(&self, step: StepId) -> Vec<(ChartId, StepId)> {
        let mut way = Vec::new();
        let mut at = Some(step);
        // Charts do not nest in circles; the bound only guards against an error here.
        while let Some(s) = at.filter(|_| way.len() <= self.unit.charts.len())
            && let Some(row) = self.unit.steps.get(s.index())
        {
            way.push((row.chart, s));
            at = match self.unit.charts.get(row.chart.index()).map(|c| &c.role) {
                Some(ChartRole::Expansion(m)) => Some(*m),
                _ => None,
            };
        }
        way
    }

    fn stays(&self, v: VarId) -> bool {
        !self.moved.get(v.index()).copied().unwrap_or(true)
    }

    /// True if an expression keeps its value from the moment when edges are taken until the
    /// receptivities have been evaluated.
    #[inline(never)]
    pub(super) fn steady(&self, e: &Expr) -> bool {
        let fine = match &e.kind {
            ExprKind::Var(v) | ExprKind::Member(v, _) => self.stays(*v),
            ExprKind::Element(all, _) => all.iter().all(|v| self.stays(v)),
            ExprKind::StepActive(_)
            | ExprKind::StepTime(_)
            | ExprKind::StepTenths(_)
            | ExprKind::StepScans(_)
            | ExprKind::StepSeconds(_) => !self.serviced,
            ExprKind::Section(_) | ExprKind::Call(..) | ExprKind::ScanTime | ExprKind::Random => false,
            _ => true,
        };
        fine && e.operands().all(|e| self.steady(e))
    }

    /// Finds the charts whose transitions each have one preceding step and at most one succeeding
    /// step, and that nothing else puts a second token into.
    #[inline(never)]
    fn shapes(&self) -> Vec<bool> {
        let mut single: Vec<bool> = self.unit.charts.iter().map(|c| self.shape(c)).collect();
        let mut lose = |c: ChartId| {
            if let Some(s) = single.get_mut(c.index()) {
                *s = false;
            }
        };
        for action in self.unit.steps.iter().flat_map(|s| &s.actions) {
            if let ActionKind::Force(chart, situation) = &action.kind {
                let many = matches!(situation, Situation::Steps(list) if list.len() > 1);
                let nested = self
                    .unit
                    .charts
                    .get(chart.index())
                    .is_none_or(|c| c.enclosed_by.is_some() || c.role != ChartRole::Chart);
                if many || nested {
                    lose(*chart);
                }
            }
        }
        for s in statements(self.unit) {
            if let StmtKind::Service(Service::SetStep(step)) = &s.kind
                && let Some(step) = self.unit.steps.get(step.index())
            {
                lose(step.chart);
            }
        }
        single
    }

    #[inline(never)]
    fn shape(&self, chart: &Chart) -> bool {
        let transitions = super::structure::transitions_of(self.unit, chart);
        let steps = super::structure::steps_of(self.unit, chart);
        let starts = steps.iter().filter(|s| s.initial || s.linked).count();
        let room = match chart.role {
            ChartRole::Chart => 1,
            // The token enters at the entry step.
            ChartRole::Task | ChartRole::Expansion(_) => 0,
            ChartRole::Unused => return false,
        };
        // A token that leaves by an exit step continues outside of the chart.
        let ends = chart.role == ChartRole::Chart
            || chart.exit.is_some_and(|x| self.branches(x).is_empty()) && chart.entry.is_some();
        starts <= room && ends && transitions.iter().all(|t| t.from.len() == 1 && t.to.len() <= 1)
    }
}

/// True if something between reading the inputs and the evolution changes the situation.
fn serviced(unit: &Unit) -> bool {
    let system = |v: crate::ir::VarId| {
        unit.vars.get(v.index()).is_some_and(|v| v.class == VarClass::System && v.ty == Type::Bool)
    };
    statements(unit)
        .into_iter()
        .any(|s| matches!(s.kind, StmtKind::Service(_)) || written(s).into_iter().any(system))
}
