//! Finds steps without a way out, and branches that begin together and never come together again.
//!
//! Both are facts of the drawing: receptivities are taken as if they could all be true. A chart that
//! is forced, enclosed or set from elsewhere is left in other ways, and is not looked at.

use g7_model::{Problem, codes, say};

use super::facts::Facts;
use super::structure::{steps_of, transitions_of};
use super::tree::statements;
use crate::circles::closing_calls;
use crate::ir::{ActionKind, Chart, ChartRole, Service, StepId, StepSort, StmtKind, Transition, Unit};

#[inline(never)]
pub(super) fn check(facts: &Facts<'_>, problems: &mut Vec<Problem>) {
    let unit = facts.unit;
    for (chart, driven) in unit.charts.iter().zip(driven(unit)) {
        if chart.role == ChartRole::Unused || chart.enclosed_by.is_some() || driven {
            continue;
        }
        dead_ends(facts, chart, problems);
        for fork in transitions_of(unit, chart).iter().filter(|t| forks(t)) {
            if !joins(facts, fork) {
                let what = say!("no transition joins the branches that begin here");
                problems.push(Problem::new(&codes::NEVER_JOINS, fork.at, what).help(
                    say!("end them together by `(a, b) -> c when …`; if each is to run on, give them charts of their own"),
                ));
            }
        }
    }
}

/// The charts that are not moved by their transitions alone: an order forces, enables or masks them, or a statement
/// sets their steps.
#[inline(never)]
fn driven(unit: &Unit) -> Vec<bool> {
    let mut driven = vec![false; unit.charts.len()];
    for action in unit.steps.iter().flat_map(|s| &s.actions) {
        if let ActionKind::Force(c, _) | ActionKind::Enable(c) | ActionKind::MaskChart(c) = &action.kind {
            driven.get_mut(c.index()).into_iter().for_each(|d| *d = true);
        }
    }
    for s in statements(unit) {
        match &s.kind {
            StmtKind::Service(Service::SetStep(step)) => {
                let chart = unit.steps.get(step.index()).map_or(usize::MAX, |s| s.chart.index());
                driven.get_mut(chart).into_iter().for_each(|d| *d = true);
            }
            StmtKind::Service(_) => driven.fill(true),
            _ => {}
        }
    }
    driven
}

/// Steps that no transition follows, in a chart that otherwise goes round: some step of it comes
/// back to itself.
#[inline(never)]
fn dead_ends(facts: &Facts<'_>, chart: &Chart, problems: &mut Vec<Problem>) {
    let steps = steps_of(facts.unit, chart);
    if !goes_round(facts, chart) {
        return;
    }
    for (id, step) in (chart.steps.start..chart.steps.end).map(StepId).zip(steps) {
        let left = !facts.branches(id).is_empty() || chart.exit == Some(id);
        if left || !matches!(step.sort, StepSort::Plain) && !step.initial && steps.len() == 1 {
            continue;
        }
        let what = say!("no transition leads out of step `{}`", step.name);
        problems.push(
            Problem::new(&codes::DEAD_END, step.at, what)
                .help(say!("write a transition `{} -> … when …`", step.name)),
        );
    }
}

/// True if some step of a chart can be reached from itself.
fn goes_round(facts: &Facts<'_>, chart: &Chart) -> bool {
    let own = |step: StepId| step.index().checked_sub(chart.steps.start as usize);
    let followers = |step: StepId| {
        let after = leaving(facts, step).flat_map(|t| t.to.iter().map(move |to| (*to, t.at)));
        after.filter_map(|(to, at)| Some((own(to)?, at))).collect()
    };
    let all: Vec<_> = (chart.steps.start..chart.steps.end).map(|s| followers(StepId(s))).collect();
    !closing_calls(&all).is_empty()
}

/// The transitions that follow a step.
fn leaving<'f>(facts: &'f Facts<'_>, step: StepId) -> impl Iterator<Item = &'f Transition> {
    facts.branches(step).iter().filter_map(|t| facts.unit.transitions.get(*t as usize))
}

/// True if a transition activates two different steps.
fn forks(t: &Transition) -> bool {
    t.to.iter().any(|s| t.to.first() != Some(s))
}

/// True if some transition waits for two of the branches of a fork, or if none of them comes back to
/// it: branches that go round for themselves are started together on purpose.
fn joins(facts: &Facts<'_>, fork: &Transition) -> bool {
    let arms: Vec<Vec<bool>> = fork.to.iter().map(|s| reach(facts, *s, fork)).collect();
    let on = |arm: &[bool], steps: &[StepId]| steps.iter().any(|s| arm.get(s.index()) == Some(&true));
    let ends = |t: &Transition| t.from.len() > 1 && arms.iter().filter(|a| on(a, &t.from)).nth(1).is_some();
    // A branch that ends in a sink gives its token away.
    let sink = |t: &Transition| t.to.is_empty() && arms.iter().any(|a| on(a, &t.from));
    let back = arms.iter().any(|a| on(a, &fork.from));
    !back || facts.unit.transitions.iter().any(|t| ends(t) || sink(t))
}

/// By step: true if a token can come there from a step, by transitions other than `except`. The step
/// itself counts.
#[inline(never)]
fn reach(facts: &Facts<'_>, from: StepId, except: &Transition) -> Vec<bool> {
    let mut found = vec![false; facts.unit.steps.len()];
    let mut pending = vec![from];
    while let Some(step) = pending.pop() {
        if found.get_mut(step.index()).is_none_or(|f| std::mem::replace(f, true)) {
            continue;
        }
        let others = leaving(facts, step).filter(|t| !std::ptr::eq(*t, except));
        pending.extend(others.flat_map(|t| &t.to));
    }
    found
}
