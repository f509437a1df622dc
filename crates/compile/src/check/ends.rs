//! Finds steps without a way out, and branches that begin together and never come together again.
//!
//! Both are facts of the drawing: receptivities are taken as if they could all be true. A chart that
//! is forced, enclosed or set from elsewhere is left in other ways, and is not looked at.

use g7_model::{Problem, codes};

use super::facts::Facts;
use super::structure::{steps_of, transitions_of};
use super::tree::statements;
use crate::ir::{ActionKind, Chart, ChartRole, Service, StepId, StepSort, StmtKind, Transition, Unit};

pub(super) fn check(facts: &Facts<'_>, problems: &mut Vec<Problem>) {
    let unit = facts.unit;
    for (i, chart) in unit.charts.iter().enumerate() {
        if chart.role == ChartRole::Unused || chart.enclosed_by.is_some() || driven(unit, i) {
            continue;
        }
        dead_ends(facts, chart, problems);
        for fork in transitions_of(unit, chart).iter().filter(|t| forks(t)) {
            if !joins(facts, fork) {
                let what = "no transition joins the branches that begin here";
                problems.push(Problem::new(&codes::NEVER_JOINS, fork.at, what).help(
                    "end them together by `(a, b) -> c when …`; if each is to run on, give them charts of their own",
                ));
            }
        }
    }
}

/// True if a forcing order or a statement sets steps of a chart.
fn driven(unit: &Unit, chart: usize) -> bool {
    let forced = unit.steps.iter().flat_map(|s| &s.actions).any(|a| {
        matches!(&a.kind, ActionKind::Force(c, _) | ActionKind::Enable(c) | ActionKind::MaskChart(c) if c.index() == chart)
    });
    forced
        || statements(unit).into_iter().any(|s| match &s.kind {
            StmtKind::Service(Service::SetStep(step)) => {
                unit.steps.get(step.index()).is_some_and(|s| s.chart.index() == chart)
            }
            StmtKind::Service(_) => true,
            _ => false,
        })
}

/// Steps that no transition follows, in a chart that otherwise goes round: some step of it comes
/// back to itself.
fn dead_ends(facts: &Facts<'_>, chart: &Chart, problems: &mut Vec<Problem>) {
    let steps = steps_of(facts.unit, chart);
    let starts = (chart.steps.start..chart.steps.end).map(StepId);
    let round = starts.clone().any(|s| reach(facts, s, None).contains(&s));
    if !round {
        return;
    }
    for (id, step) in starts.zip(steps) {
        let left = !facts.branches(id).is_empty() || chart.exit == Some(id);
        if left || !matches!(step.sort, StepSort::Plain) && !step.initial && steps.len() == 1 {
            continue;
        }
        let what = format!("no transition leads out of step `{}`", step.name);
        problems.push(
            Problem::new(&codes::DEAD_END, step.at, what)
                .help(format!("write a transition `{} -> … when …`", step.name)),
        );
    }
}

/// True if a transition activates two different steps.
fn forks(t: &Transition) -> bool {
    t.to.iter().any(|s| t.to.first() != Some(s))
}

/// True if some transition waits for two of the branches of a fork, or if none of them comes back to
/// it: branches that go round for themselves are started together on purpose.
fn joins(facts: &Facts<'_>, fork: &Transition) -> bool {
    let arms: Vec<Vec<StepId>> = fork.to.iter().map(|s| reach(facts, *s, Some(fork))).collect();
    let ends = |t: &Transition| {
        let on: Vec<usize> = arms
            .iter()
            .enumerate()
            .filter(|(_, a)| t.from.iter().any(|s| a.contains(s)))
            .map(|(i, _)| i)
            .collect();
        t.from.len() > 1 && on.len() > 1
    };
    // A branch that ends in a sink gives its token away.
    let sink = |t: &Transition| t.to.is_empty() && t.from.iter().any(|s| arms.iter().any(|a| a.contains(s)));
    let back = arms.iter().any(|a| fork.from.iter().any(|s| a.contains(s)));
    !back || facts.unit.transitions.iter().any(|t| ends(t) || sink(t))
}

/// The steps that a token can come to from a step, by transitions other than `except`; the step
/// itself only if it comes back to it.
fn reach(facts: &Facts<'_>, from: StepId, except: Option<&Transition>) -> Vec<StepId> {
    let mut found: Vec<StepId> = if except.is_some() { vec![from] } else { Vec::new() };
    let mut pending = vec![from];
    while let Some(step) = pending.pop() {
        for t in facts.branches(step).iter().filter_map(|t| facts.unit.transitions.get(*t as usize)) {
            if except.is_some_and(|e| std::ptr::eq(e, t)) {
                continue;
            }
            for to in &t.to {
                if !found.contains(to) {
                    found.push(*to);
                    pending.push(*to);
                }
            }
        }
    }
    found
}
