//! Finds steps that no path leads to, and charts that never start.
//!
//! A token may move everywhere, as if all receptivities were true. A step that it does not reach is
//! not reached in any run.

use g7_model::{Problem, codes, say};

use super::facts::Facts;
use super::structure::steps_of;
use super::tree::statements;
use crate::ir::{
    ActionKind, Chart, ChartId, ChartRole, Service, Situation, StepId, StepSort, StmtKind, Unit,
};

#[inline(never)]
pub(super) fn check(facts: &Facts<'_>, problems: &mut Vec<Problem>) {
    let unit = facts.unit;
    let mut reached = vec![false; unit.steps.len()];
    let mut pending: Vec<StepId> = Vec::new();
    let mut outside = vec![false; unit.charts.len()];
    starts(unit, &mut pending, &mut outside);
    // A transition with several preceding steps is passed after all of them have been reached.
    let mut missing = vec![0usize; unit.transitions.len()];
    for t in (0..unit.steps.len() as u32).flat_map(|s| facts.branches(StepId(s))) {
        missing.get_mut(*t as usize).into_iter().for_each(|n| *n += 1);
    }
    pending.extend(unit.transitions.iter().filter(|t| t.from.is_empty()).flat_map(|t| &t.to));
    while let Some(id) = pending.pop() {
        let Some(r) = reached.get_mut(id.index()) else { continue };
        if std::mem::replace(r, true) {
            continue;
        }
        follow(unit, id, &mut pending);
        for t in facts.branches(id) {
            let Some(n) = missing.get_mut(*t as usize) else { continue };
            *n = n.saturating_sub(1);
            if *n == 0 {
                pending.extend(unit.transitions.get(*t as usize).into_iter().flat_map(|t| &t.to));
            }
        }
    }
    for (chart, outside) in unit.charts.iter().zip(outside) {
        tell(unit, chart, outside, &reached, problems);
    }
}

/// The steps that are active at the start or are set from elsewhere.
#[inline(never)]
fn starts(unit: &Unit, pending: &mut Vec<StepId>, outside: &mut [bool]) {
    for (i, step) in unit.steps.iter().enumerate() {
        let chart = unit.charts.get(step.chart.index());
        let entry = chart.is_some_and(|c| c.role == ChartRole::Task && c.entry == Some(StepId(i as u32)));
        if step.initial || entry {
            pending.push(StepId(i as u32));
        }
    }
    let mut mark = |c: ChartId| {
        if let Some(o) = outside.get_mut(c.index()) {
            *o = true;
        }
    };
    for action in unit.steps.iter().flat_map(|s| &s.actions) {
        match &action.kind {
            ActionKind::Force(chart, Situation::Steps(list)) => {
                pending.extend(list);
                mark(*chart);
            }
            ActionKind::Force(chart, Situation::Init) => mark(*chart),
            _ => {}
        }
    }
    for s in statements(unit) {
        if let StmtKind::Service(Service::SetStep(step)) = &s.kind {
            pending.push(*step);
            if let Some(step) = unit.steps.get(step.index()) {
                mark(step.chart);
            }
        }
    }
}

/// Adds the steps that become active together with a step.
#[inline(never)]
fn follow(unit: &Unit, id: StepId, pending: &mut Vec<StepId>) {
    match unit.steps.get(id.index()).map(|s| &s.sort) {
        Some(StepSort::Macro(chart)) => {
            pending.extend(unit.charts.get(chart.index()).and_then(|c| c.entry));
        }
        Some(StepSort::Enclosing(charts)) => {
            for chart in charts.iter().filter_map(|c| unit.charts.get(c.index())) {
                let linked = (chart.steps.start..chart.steps.end).map(StepId);
                pending.extend(linked.filter(|s| unit.steps.get(s.index()).is_some_and(|s| s.linked)));
            }
        }
        Some(StepSort::Plain) | None => {}
    }
    // A macro-step counts as reached with any step of its expansion.
    let chart = unit.steps.get(id.index()).and_then(|s| unit.charts.get(s.chart.index()));
    if let Some(ChartRole::Expansion(m)) = chart.map(|c| &c.role) {
        pending.push(*m);
    }
}

#[inline(never)]
fn tell(unit: &Unit, chart: &Chart, outside: bool, reached: &[bool], problems: &mut Vec<Problem>) {
    // Steps in another chart are not reported again if the step around that chart cannot be
    // reached.
    let around = match chart.role {
        ChartRole::Unused => return,
        ChartRole::Expansion(m) => Some(m),
        ChartRole::Chart | ChartRole::Task => chart.enclosed_by,
    };
    let lost = around.is_some_and(|s| !reached.get(s.index()).copied().unwrap_or(true));
    let range = chart.steps.start as usize..chart.steps.end as usize;
    let of_chart = reached.get(range).unwrap_or(&[]);
    if lost || of_chart.is_empty() {
        return;
    }
    if !of_chart.contains(&true) {
        if !outside {
            problems.push(
                Problem::new(&codes::NEVER_STARTS, chart.at, say!("chart `{}` never starts", chart.name))
                    .help(say!("mark its first step `initial`, or link (`*`), force or set a step of it")),
            );
        }
        return;
    }
    for (step, _) in steps_of(unit, chart).iter().zip(of_chart).filter(|(_, r)| !**r) {
        problems.push(Problem::new(
            &codes::UNREACHABLE,
            step.at,
            say!("no way leads to step `{}`", step.name),
        ));
    }
}
