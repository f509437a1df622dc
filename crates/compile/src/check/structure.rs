//! Steps, transitions and how they hang together.

use std::collections::HashMap;

use g7_model::{Problem, codes};

use super::tree::key;
use crate::ir::{
    ActionKind, Chart, ChartRole, ExprKind, Service, Situation, Step, StepId, StepSort, Stmt, StmtKind,
    Transition, Unit, Value,
};

pub(super) fn check(unit: &Unit, problems: &mut Vec<Problem>) {
    for chart in &unit.charts {
        ends(chart, problems);
        if chart.role == ChartRole::Task {
            task(unit, chart, problems);
        }
    }
    for t in &unit.transitions {
        arms(unit, t, problems);
    }
    twice(unit, problems);
    reach(unit, problems);
}

pub(super) fn steps_of<'u>(unit: &'u Unit, chart: &Chart) -> &'u [Step] {
    unit.steps.get(chart.steps.start as usize..chart.steps.end as usize).unwrap_or(&[])
}

pub(super) fn transitions_of<'u>(unit: &'u Unit, chart: &Chart) -> &'u [Transition] {
    unit.transitions.get(chart.transitions.start as usize..chart.transitions.end as usize).unwrap_or(&[])
}

/// An expansion and a task have one entry step and one exit step.
fn ends(chart: &Chart, problems: &mut Vec<Problem>) {
    if chart.role == ChartRole::Chart {
        return;
    }
    let missing = match (chart.entry, chart.exit) {
        (Some(_), Some(_)) => return,
        (None, Some(_)) => "entry step",
        (Some(_), None) => "exit step",
        (None, None) => "entry step and no exit step",
    };
    let what = if chart.role == ChartRole::Task { "task" } else { "expansion" };
    problems.push(
        Problem::new(&codes::NO_ENDS, chart.at, format!("{what} `{}` has no {missing}", chart.name))
            .help("write `entry step E` for its first step and `exit step S` for its last one"),
    );
}

/// The input and the output step of a task have no action.
fn task(unit: &Unit, chart: &Chart, problems: &mut Vec<Problem>) {
    for id in [chart.entry, chart.exit].into_iter().flatten() {
        let Some(step) = unit.steps.get(id.index()) else { continue };
        if let Some(action) = step.actions.first() {
            let what = format!("step `{}` is an end of task `{}` and has an action", step.name, chart.name);
            problems.push(
                Problem::new(&codes::TASK_END_ACTS, action.at, what)
                    .related(step.at, "this step waits between two calls")
                    .help("put the action into a step between the two ends"),
            );
        }
    }
}

/// A transition by itself.
fn arms(unit: &Unit, t: &Transition, problems: &mut Vec<Problem>) {
    if t.from.is_empty() && t.to.is_empty() {
        problems.push(
            Problem::new(
                &codes::NO_STEPS,
                t.at,
                "this transition has neither a preceding nor a succeeding step",
            )
            .help("a source has a succeeding step, `() -> 1`; a sink a preceding one, `1 -> ()`"),
        );
    }
    for list in [&t.from, &t.to] {
        for (k, id) in list.iter().enumerate() {
            if list.get(..k).unwrap_or(&[]).contains(id)
                && let Some(step) = unit.steps.get(id.index())
            {
                let what = format!("step `{}` stands twice on one side of the transition", step.name);
                problems.push(Problem::new(&codes::STEP_TWICE, t.at, what));
            }
        }
    }
    if matches!(t.receptivity.kind, ExprKind::Const(Value::Bool(false))) {
        problems.push(Problem::new(&codes::NEVER_CLEARS, t.receptivity.at, "this receptivity is never true"));
    }
}

/// Two transitions that are the same in all.
fn twice(unit: &Unit, problems: &mut Vec<Problem>) {
    let mut seen = HashMap::new();
    for t in &unit.transitions {
        let row = (t.chart, t.from.clone(), t.to.clone(), key(&t.receptivity));
        if let Some(first) = seen.insert(row, t.at) {
            problems.push(
                Problem::new(&codes::SAME_TRANSITION, t.at, "this transition stands in the chart already")
                    .related(first, "the same steps and the same receptivity"),
            );
        }
    }
}

/// Steps that no way leads to, and charts that never start.
fn reach(unit: &Unit, problems: &mut Vec<Problem>) {
    let mut reached = vec![false; unit.steps.len()];
    let mut pending: Vec<StepId> = Vec::new();
    let mut outside = vec![false; unit.charts.len()];
    starts(unit, &mut pending, &mut outside);
    let mut by_step: HashMap<StepId, Vec<&Transition>> = HashMap::new();
    let mut waiting: Vec<&Transition> = Vec::new();
    for t in &unit.transitions {
        for from in &t.from {
            by_step.entry(*from).or_default().push(t);
        }
        if t.from.is_empty() {
            waiting.push(t);
        }
    }
    loop {
        while let Some(id) = pending.pop() {
            let Some(r) = reached.get_mut(id.index()) else { continue };
            if std::mem::replace(r, true) {
                continue;
            }
            follow(unit, id, &mut pending);
            waiting.extend(by_step.get(&id).into_iter().flatten());
        }
        // A join is passed once all its steps can be reached.
        let done = |t: &Transition| t.from.iter().all(|f| reached.get(f.index()).copied().unwrap_or(true));
        let before = waiting.len();
        for t in waiting.iter().filter(|t| done(t)) {
            pending.extend(&t.to);
        }
        waiting.retain(|t| !done(t));
        if waiting.len() == before {
            break;
        }
    }
    for (chart, outside) in unit.charts.iter().zip(outside) {
        tell(unit, chart, outside, &reached, problems);
    }
}

/// Steps that are active at the start or set from elsewhere.
fn starts(unit: &Unit, pending: &mut Vec<StepId>, outside: &mut [bool]) {
    for (i, step) in unit.steps.iter().enumerate() {
        let chart = unit.charts.get(step.chart.index());
        let entry = chart.is_some_and(|c| c.role == ChartRole::Task && c.entry == Some(StepId(i as u32)));
        if step.initial || entry {
            pending.push(StepId(i as u32));
        }
    }
    let mut mark = |c: crate::ir::ChartId| {
        if let Some(o) = outside.get_mut(c.index()) {
            *o = true;
        }
    };
    let bodies = unit.pre.iter().chain(&unit.post).chain(&unit.bodies);
    let mut stmts: Vec<&Stmt> = bodies.flat_map(|b| &b.statements).collect();
    for action in unit.steps.iter().flat_map(|s| &s.actions) {
        match &action.kind {
            ActionKind::Force(chart, Situation::Steps(list)) => {
                pending.extend(list);
                mark(*chart);
            }
            ActionKind::Force(chart, Situation::Init) => mark(*chart),
            ActionKind::Work { work, .. }
            | ActionKind::OnEvent { work, .. }
            | ActionKind::EachScan { work, .. } => {
                stmts.extend(work);
            }
            _ => {}
        }
    }
    while let Some(s) = stmts.pop() {
        match &s.kind {
            StmtKind::Service(Service::SetStep(step)) => {
                pending.push(*step);
                if let Some(step) = unit.steps.get(step.index()) {
                    mark(step.chart);
                }
            }
            StmtKind::If(arms, rest) => {
                stmts.extend(arms.iter().flat_map(|(_, b)| b));
                stmts.extend(rest);
            }
            StmtKind::Case(_, arms, rest) => {
                stmts.extend(arms.iter().flat_map(|(_, b)| b));
                stmts.extend(rest);
            }
            StmtKind::For { body, .. } | StmtKind::While(_, body) | StmtKind::Repeat(body, _) => {
                stmts.extend(body)
            }
            _ => {}
        }
    }
}

/// What becomes active with a step.
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
}

fn tell(unit: &Unit, chart: &Chart, outside: bool, reached: &[bool], problems: &mut Vec<Problem>) {
    // What lies in an expansion is said where its macro-step cannot be reached.
    let lost = match chart.role {
        ChartRole::Unused => return,
        ChartRole::Expansion(m) => !reached.get(m.index()).copied().unwrap_or(true),
        ChartRole::Chart | ChartRole::Task => false,
    };
    let range = chart.steps.start as usize..chart.steps.end as usize;
    let of_chart = reached.get(range).unwrap_or(&[]);
    if lost || of_chart.is_empty() {
        return;
    }
    if !of_chart.contains(&true) {
        if !outside {
            problems.push(
                Problem::new(&codes::NEVER_STARTS, chart.at, format!("chart `{}` never starts", chart.name))
                    .help("mark its first step `initial`, or link (`*`), force or set a step of it"),
            );
        }
        return;
    }
    for (step, _) in steps_of(unit, chart).iter().zip(of_chart).filter(|(_, r)| !**r) {
        problems.push(Problem::new(
            &codes::UNREACHABLE,
            step.at,
            format!("no way leads to step `{}`", step.name),
        ));
    }
}
