//! Which step of the unit becomes which step of the program.
//!
//! A chart's own steps come first, then those of its expansions, each chart and
//! each expansion contiguous, so that both are groups. A macro-step is no step
//! of its own: an arc into it goes to the entry step of its expansion, an arc
//! out of it comes from the exit step. Where it has actions, a pseudo-step
//! carries them: it goes on with the entry step and off with the transition
//! behind the macro-step.

use g7_engine::NONE;

use super::distinct::Distinct;
use super::uses::Uses;
use crate::ir::{Chart, ChartId, ChartRole, StepId, StepSort, Unit};

/// Macro-steps within macro-steps, at most.
pub(super) const NESTING: u32 = 200;

/// The numbering.
pub(super) struct Plan {
    /// By step: its number; `NONE` for a macro-step and for what is left out.
    step: Vec<u32>,
    /// By step: the pseudo-step of a macro-step, or `NONE`.
    pseudo: Vec<u32>,
    /// By chart: its group, `NONE` for what is left out.
    group: Vec<u32>,
    /// By chart: the row of the outermost chart.
    chart: Vec<u32>,
    /// By chart: 0 for an outermost chart, 1 for the expansion of a macro-step in it, …
    level: Vec<u32>,
    /// By number: the step it comes from.
    pub(super) source: Vec<StepId>,
    /// By group: its chart and its steps `start..end`.
    pub(super) groups: Vec<(ChartId, u32, u32)>,
    /// The outermost charts.
    pub(super) outer: Vec<ChartId>,
    /// The first macro-step nested too deeply.
    pub(super) too_deep: Option<StepId>,
}

enum Visit {
    Enter(ChartId, u32),
    Leave(u32),
}

impl Plan {
    pub(super) fn new(unit: &Unit, uses: &Uses) -> Plan {
        let mut plan = Plan {
            step: vec![NONE; unit.steps.len()],
            pseudo: vec![NONE; unit.steps.len()],
            group: vec![NONE; unit.charts.len()],
            chart: vec![NONE; unit.charts.len()],
            level: vec![0; unit.charts.len()],
            source: Vec::with_capacity(unit.steps.len()),
            groups: Vec::new(),
            outer: Vec::new(),
            too_deep: None,
        };
        for (i, chart) in unit.charts.iter().enumerate() {
            if matches!(chart.role, ChartRole::Chart | ChartRole::Task) {
                plan.outermost(unit, uses, ChartId(i as u32));
            }
        }
        plan
    }

    /// Numbers a chart and all that is nested in it.
    fn outermost(&mut self, unit: &Unit, uses: &Uses, chart: ChartId) {
        let row = self.outer.len() as u32;
        self.outer.push(chart);
        let mut todo = vec![Visit::Enter(chart, 0)];
        while let Some(visit) = todo.pop() {
            match visit {
                Visit::Leave(group) => {
                    let end = self.source.len() as u32;
                    if let Some(g) = self.groups.get_mut(group as usize) {
                        g.2 = end;
                    }
                }
                Visit::Enter(chart, level) => {
                    let group = self.groups.len() as u32;
                    let start = self.source.len() as u32;
                    self.groups.push((chart, start, start));
                    let i = chart.index();
                    for (table, v) in
                        [(&mut self.group, group), (&mut self.chart, row), (&mut self.level, level)]
                    {
                        if let Some(slot) = table.get_mut(i) {
                            *slot = v;
                        }
                    }
                    todo.push(Visit::Leave(group));
                    let from = todo.len();
                    self.own_steps(unit, uses, chart, level, &mut todo);
                    // The first macro-step's expansion comes first.
                    todo.get_mut(from..).unwrap_or_default().reverse();
                }
            }
        }
    }

    fn own_steps(&mut self, unit: &Unit, uses: &Uses, chart: ChartId, level: u32, todo: &mut Vec<Visit>) {
        let Some(c) = unit.charts.get(chart.index()) else { return };
        for i in c.steps.clone() {
            let Some(step) = unit.steps.get(i as usize) else { continue };
            let id = StepId(i);
            let StepSort::Macro(expansion) = step.sort else {
                self.number(id, false);
                continue;
            };
            let ours = unit.charts.get(expansion.index()).map(|e| &e.role) == Some(&ChartRole::Expansion(id));
            if !ours || self.group.get(expansion.index()) != Some(&NONE) {
                continue;
            }
            if level >= NESTING {
                self.too_deep.get_or_insert(id);
                continue;
            }
            let has = |table: &[bool]| table.get(i as usize).copied().unwrap_or(false);
            if has(&uses.acts) {
                self.number(id, true);
            }
            todo.push(Visit::Enter(expansion, level + 1));
        }
    }

    fn number(&mut self, id: StepId, pseudo: bool) {
        let table = if pseudo { &mut self.pseudo } else { &mut self.step };
        if let Some(slot) = table.get_mut(id.index()) {
            *slot = self.source.len() as u32;
            self.source.push(id);
        }
    }

    /// The number of a plain step, or that of a macro-step's pseudo-step: the one
    /// whose time and actions are the step's.
    pub(super) fn own(&self, id: StepId) -> Option<g7_engine::StepId> {
        let get = |t: &[u32]| t.get(id.index()).copied().filter(|n| *n != NONE);
        get(&self.step).or_else(|| get(&self.pseudo)).map(g7_engine::StepId)
    }

    /// The pseudo-step of a macro-step.
    pub(super) fn pseudo(&self, id: StepId) -> Option<g7_engine::StepId> {
        self.pseudo.get(id.index()).copied().filter(|n| *n != NONE).map(g7_engine::StepId)
    }

    /// The group of a chart.
    pub(super) fn group(&self, id: ChartId) -> Option<g7_engine::GroupId> {
        self.group.get(id.index()).copied().filter(|n| *n != NONE).map(g7_engine::GroupId)
    }

    /// The row of the outermost chart round a chart.
    pub(super) fn chart(&self, id: ChartId) -> Option<u32> {
        self.chart.get(id.index()).copied().filter(|n| *n != NONE)
    }

    /// How many macro-steps lie round a chart.
    pub(super) fn level(&self, id: ChartId) -> u32 {
        self.level.get(id.index()).copied().unwrap_or(0)
    }

    /// The expansion of a macro-step that runs.
    pub(super) fn expansion(&self, unit: &Unit, id: StepId) -> Option<ChartId> {
        match unit.steps.get(id.index())?.sort {
            StepSort::Macro(chart) => self.group(chart).map(|_| chart),
            StepSort::Plain | StepSort::Enclosing(_) => None,
        }
    }

    /// The steps that go on when a step does: those of a macro-step are its
    /// pseudo-step and the entry step of its expansion.
    pub(super) fn entering(&self, unit: &Unit, id: StepId, to: &mut Distinct) {
        let (end, pseudos) = self.end(unit, id, |c| c.entry);
        pseudos.into_iter().chain(end).for_each(|s| to.add(s));
    }

    /// The step that must be active for a step to be left, and goes off with it:
    /// of a macro-step the exit step of its expansion. Its pseudo-step only goes
    /// off, added to `drops`.
    pub(super) fn leaving(&self, unit: &Unit, id: StepId, to: &mut Distinct, drops: &mut Distinct) {
        let (end, pseudos) = self.end(unit, id, |c| c.exit);
        end.into_iter().for_each(|s| to.add(s));
        pseudos.into_iter().rev().for_each(|s| drops.add(s));
    }

    /// The entry or exit step behind a macro-step, and the pseudo-steps on the way.
    fn end(
        &self,
        unit: &Unit,
        id: StepId,
        which: impl Fn(&Chart) -> Option<StepId>,
    ) -> (Option<g7_engine::StepId>, Vec<g7_engine::StepId>) {
        let mut pseudos = Vec::new();
        let mut at = id;
        for _ in 0..=NESTING {
            let Some(chart) = self.expansion(unit, at) else { break };
            pseudos.extend(self.pseudo(at));
            let Some(end) = unit.charts.get(chart.index()).and_then(&which) else { break };
            at = end;
        }
        let end = self.step.get(at.index()).copied().filter(|n| *n != NONE);
        (end.map(g7_engine::StepId), pseudos)
    }

    /// The pseudo-steps of the macro-steps round a step.
    pub(super) fn around(&self, unit: &Unit, id: StepId, to: &mut Distinct) {
        let mut chart = unit.steps.get(id.index()).map(|s| s.chart);
        for _ in 0..=NESTING {
            let Some(outer) = chart.and_then(|c| parent(unit, c)) else { break };
            if let Some(p) = self.pseudo(outer) {
                to.add(p);
            }
            chart = unit.steps.get(outer.index()).map(|s| s.chart);
        }
    }
}

/// The macro-step whose expansion a chart is.
pub(super) fn parent(unit: &Unit, chart: ChartId) -> Option<StepId> {
    match unit.charts.get(chart.index())?.role {
        ChartRole::Expansion(step) => Some(step),
        ChartRole::Chart | ChartRole::Unused | ChartRole::Task => None,
    }
}
