//! Checks steps, transitions and the links between them.

use std::collections::{HashMap, HashSet};

use g7_model::{Problem, codes, say};

use super::tree::Form;
use crate::circles::closing_calls;
use crate::ir::{Chart, ChartId, ChartRole, Step, StepId, StepSort, Transition, Unit};

#[inline(never)]
pub(super) fn check(unit: &Unit, problems: &mut Vec<Problem>) {
    for chart in &unit.charts {
        ends(unit, chart, problems);
        if chart.role == ChartRole::Task {
            task(unit, chart, problems);
        }
    }
    unused(unit, problems);
    starts_empty(unit, problems);
    tasks_in_a_circle(unit, problems);
    for t in &unit.transitions {
        arms(unit, t, problems);
    }
    twice(unit, problems);
}

pub(super) fn steps_of<'u>(unit: &'u Unit, chart: &Chart) -> &'u [Step] {
    unit.steps.get(chart.steps.start as usize..chart.steps.end as usize).unwrap_or(&[])
}

pub(super) fn transitions_of<'u>(unit: &'u Unit, chart: &Chart) -> &'u [Transition] {
    unit.transitions.get(chart.transitions.start as usize..chart.transitions.end as usize).unwrap_or(&[])
}

/// An expansion or task has one entry step and one exit step; a chart has neither.
#[inline(never)]
fn ends(unit: &Unit, chart: &Chart, problems: &mut Vec<Problem>) {
    if chart.role == ChartRole::Chart {
        for (end, word) in [(chart.entry, say!("an entry step")), (chart.exit, say!("an exit step"))] {
            let Some(step) = end.and_then(|s| unit.steps.get(s.index())) else { continue };
            let what = say!("{word} belongs to an expansion or a task, `{}` is a chart", chart.name);
            problems.push(
                Problem::new(&codes::NOT_HERE, step.at, what)
                    .help(say!("leave the word out, or write `macrochart` or `task` for `chart`")),
            );
        }
        return;
    }
    let missing = match (chart.entry, chart.exit) {
        (Some(_), Some(_)) => return,
        (None, Some(_)) => say!("entry step"),
        (Some(_), None) => say!("exit step"),
        (None, None) => say!("entry step and no exit step"),
    };
    let what = if chart.role == ChartRole::Task { say!("task") } else { say!("expansion") };
    problems.push(
        Problem::new(&codes::NO_ENDS, chart.at, say!("{what} `{}` has no {missing}", chart.name))
            .help(say!("write `entry step E` for its first step and `exit step S` for its last one")),
    );
}

/// An expansion without its macro-step and a task that no step calls never run.
#[inline(never)]
fn unused(unit: &Unit, problems: &mut Vec<Problem>) {
    let called: HashSet<ChartId> = unit.steps.iter().flat_map(|s| &s.calls).map(|(c, _)| *c).collect();
    for (k, chart) in unit.charts.iter().enumerate() {
        let (what, help) = match chart.role {
            ChartRole::Unused => {
                let help = say!("name it by a macro-step, `macro M = {}`, or delete it", chart.name);
                (say!("no macro-step has the expansion `{}`", chart.name), help)
            }
            ChartRole::Task if !called.contains(&ChartId(k as u32)) => {
                let help = say!("call it from a step, `call {}`, or delete it", chart.name);
                (say!("no step calls the task `{}`", chart.name), help)
            }
            _ => continue,
        };
        problems.push(Problem::new(&codes::CHART_UNUSED, chart.at, what).help(help));
    }
}

/// Each chart in an initial enclosing step has an initial step itself: activation
/// links do not act at the start.
#[inline(never)]
fn starts_empty(unit: &Unit, problems: &mut Vec<Problem>) {
    for step in unit.steps.iter().filter(|s| s.initial) {
        let StepSort::Enclosing(charts) = &step.sort else { continue };
        for chart in charts.iter().filter_map(|c| unit.charts.get(c.index())) {
            let steps = steps_of(unit, chart);
            if steps.is_empty() || steps.iter().any(|s| s.initial) {
                continue;
            }
            let what = say!(
                "the initial step `{}` encloses `{}`, which has no initial step and starts empty",
                step.name,
                chart.name
            );
            let problem = Problem::new(&codes::STARTS_EMPTY, step.at, what);
            problems.push(match steps.iter().find(|s| s.linked) {
                Some(linked) => problem
                    .related(linked.at, say!("this activation link acts at later activations only"))
                    .help(say!("write `initial step {} *`", linked.name)),
                None => problem.help(say!("mark a step of `{}` `initial`", chart.name)),
            });
        }
    }
}

/// A task that calls itself, by a step of its own, of an expansion or of an enclosed
/// chart in it, or through other tasks: the calling step would wait for the exit step of
/// the task that it is part of.
#[inline(never)]
fn tasks_in_a_circle(unit: &Unit, problems: &mut Vec<Problem>) {
    let mut callees = vec![Vec::new(); unit.charts.len()];
    for step in unit.steps.iter().filter(|s| !s.calls.is_empty()) {
        let Some(home) = task_round(unit, step.chart) else { continue };
        let calls = step.calls.iter().map(|(task, at)| (task.index(), *at));
        callees.get_mut(home.index()).into_iter().for_each(|list| list.extend(calls.clone()));
    }
    for (task, at) in closing_calls(&callees) {
        let Some(task) = unit.charts.get(task) else { continue };
        let what = say!("the task `{}` is called while it runs", task.name);
        problems.push(
            Problem::new(&codes::RECURSION, at, what).related(task.at, say!("this task")).help(say!(
                "a task cannot call itself, nor one that calls it; lead a transition back instead"
            )),
        );
    }
}

/// The task that a chart is part of: itself, or the one round it.
#[inline(never)]
fn task_round(unit: &Unit, chart: ChartId) -> Option<ChartId> {
    let mut at = chart;
    // Charts nested in themselves are reported elsewhere; the way up ends here for them.
    for _ in 0..=unit.charts.len() {
        let row = unit.charts.get(at.index())?;
        let round = match row.role {
            ChartRole::Task => return Some(at),
            ChartRole::Expansion(step) => Some(step),
            ChartRole::Chart | ChartRole::Unused => row.enclosed_by,
        };
        at = unit.steps.get(round?.index())?.chart;
    }
    None
}

/// The input and the output step of a task have no action.
#[inline(never)]
fn task(unit: &Unit, chart: &Chart, problems: &mut Vec<Problem>) {
    for id in [chart.entry, chart.exit].into_iter().flatten() {
        let Some(step) = unit.steps.get(id.index()) else { continue };
        if let Some(action) = step.actions.first() {
            let what = say!("step `{}` is an end of task `{}` and has an action", step.name, chart.name);
            problems.push(
                Problem::new(&codes::TASK_END_ACTS, action.at, what)
                    .related(step.at, say!("this step waits between two calls"))
                    .help(say!("put the action into a step between the two ends")),
            );
        }
    }
}

/// A transition by itself.
#[inline(never)]
fn arms(unit: &Unit, t: &Transition, problems: &mut Vec<Problem>) {
    if t.from.is_empty() && t.to.is_empty() {
        problems.push(
            Problem::new(
                &codes::NO_STEPS,
                t.at,
                say!("this transition has neither a preceding nor a succeeding step"),
            )
            .help(say!("a source has a succeeding step, `() -> 1`; a sink a preceding one, `1 -> ()`")),
        );
    }
    for list in [&t.from, &t.to].into_iter().filter(|list| list.len() > 1) {
        let mut seen = HashSet::new();
        for id in list {
            if !seen.insert(id)
                && let Some(step) = unit.steps.get(id.index())
            {
                let what = say!("step `{}` stands twice on one side of the transition", step.name);
                problems.push(Problem::new(&codes::STEP_TWICE, t.at, what));
            }
        }
    }
}

/// Finds two transitions with the same steps and the same receptivity.
#[inline(never)]
fn twice(unit: &Unit, problems: &mut Vec<Problem>) {
    let mut all: Vec<&Transition> = unit.transitions.iter().collect();
    all.sort_by_key(|t| sides(t));
    // Most transitions are the only ones between their steps, and need no look at receptivities.
    for between in all.chunk_by(|a, b| sides(a) == sides(b)).filter(|same| same.len() > 1) {
        let mut seen = HashMap::new();
        for t in between {
            if let Some(first) = seen.insert(Form(&t.receptivity), t.at) {
                problems.push(
                    Problem::new(
                        &codes::SAME_TRANSITION,
                        t.at,
                        say!("this transition stands in the chart already"),
                    )
                    .related(first, say!("the same steps and the same receptivity")),
                );
            }
        }
    }
}

fn sides(t: &Transition) -> (ChartId, &[StepId], &[StepId]) {
    (t.chart, &t.from, &t.to)
}
