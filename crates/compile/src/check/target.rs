//! The limits of a PLC (GRAFCET course, implementation in the TSX 37 and 57).

use std::collections::BTreeMap;

use g7_model::{Problem, Span, TargetPlc, codes};

use crate::ir::{ActionKind, Chart, ChartRole, StepId, StepSort, Unit};

/// Most transitions of a chart, on every PLC.
const TRANSITIONS: usize = 1024;
/// Most branches of a divergence or convergence.
const BRANCHES: usize = 11;
/// Pages, rows of steps on a page (even rows of 14), columns.
const CELLS: usize = 8 * 6 * 11;

struct Limits {
    name: &'static str,
    steps: usize,
    macros: usize,
    macro_steps: usize,
    total: usize,
}

fn limits(plc: TargetPlc) -> Limits {
    match plc {
        TargetPlc::Tsx3710 => Limits { name: "TSX 37-10", steps: 96, macros: 0, macro_steps: 0, total: 96 },
        TargetPlc::Tsx3720 => Limits { name: "TSX 37-20", steps: 128, macros: 0, macro_steps: 0, total: 128 },
        TargetPlc::Tsx57 => Limits { name: "TSX 57", steps: 250, macros: 64, macro_steps: 250, total: 1024 },
    }
}

pub(super) fn check(unit: &Unit, plc: TargetPlc, problems: &mut Vec<Problem>) {
    let most = limits(plc);
    let place = unit.charts.first().map_or_else(Span::default, |c| c.at);
    let mut main = 0;
    let mut macros = Vec::new();
    for step in &unit.steps {
        let Some(chart) = unit.charts.get(step.chart.index()) else { continue };
        if matches!(step.sort, StepSort::Macro(_)) {
            macros.push(step.at);
        }
        if matches!(chart.role, ChartRole::Chart | ChartRole::Task) {
            main += 1;
        }
    }
    let mut over = |code, n: usize, limit: usize, what: &str, at: Span| {
        if n > limit {
            let text = format!("{n} {what}; a {} has room for {limit}", most.name);
            problems.push(Problem::new(code, at, text));
        }
    };
    over(&codes::TARGET_STEPS, main, most.steps.min(CELLS), "steps", place);
    over(&codes::TARGET_STEPS, unit.steps.len(), most.total, "steps with those of macro-steps", place);
    over(
        &codes::TARGET_MACROS,
        macros.len(),
        most.macros,
        "macro-steps",
        macros.first().copied().unwrap_or(place),
    );
    over(&codes::TARGET_TRANSITIONS, unit.transitions.len(), TRANSITIONS, "transitions", place);
    for chart in unit.charts.iter().filter(|c| matches!(c.role, ChartRole::Expansion(_))) {
        let n = (chart.steps.end - chart.steps.start) as usize;
        over(&codes::TARGET_STEPS, n, most.macro_steps, "steps of a macro-step", chart.at);
    }
    branches(unit, problems);
    words(unit, &most, problems);
}

/// Divergences and convergences that are too wide.
fn branches(unit: &Unit, problems: &mut Vec<Problem>) {
    let mut wide = |n: usize, what: &str, at: Span| {
        if n > BRANCHES {
            let text = format!("{what} with {n} branches; {BRANCHES} are possible");
            problems.push(Problem::new(&codes::TARGET_BRANCHES, at, text));
        }
    };
    let mut out: BTreeMap<StepId, usize> = BTreeMap::new();
    let mut into: BTreeMap<StepId, usize> = BTreeMap::new();
    for t in &unit.transitions {
        wide(t.to.len(), "an AND divergence", t.at);
        wide(t.from.len(), "an AND convergence", t.at);
        t.from.iter().for_each(|s| *out.entry(*s).or_default() += 1);
        t.to.iter().for_each(|s| *into.entry(*s).or_default() += 1);
    }
    for (list, what) in [(out, "an OR divergence"), (into, "an OR convergence")] {
        for (step, n) in list {
            if let Some(s) = unit.steps.get(step.index()) {
                wide(n, what, s.at);
            }
        }
    }
}

/// What PL7 has no word for, and how it numbers steps.
fn words(unit: &Unit, most: &Limits, problems: &mut Vec<Problem>) {
    let mut cannot = |what: &str, at: Span| {
        let text = format!("{} has no {what}", most.name);
        problems.push(Problem::new(&codes::TARGET_WORDS, at, text));
    };
    for step in &unit.steps {
        if matches!(step.sort, StepSort::Enclosing(_)) {
            cannot("enclosing steps", step.at);
        }
        if !step.calls.is_empty() {
            cannot("tasks", step.at);
        }
        for action in &step.actions {
            if let ActionKind::Variable { qualifier, .. } | ActionKind::Named { qualifier, .. } = &action.kind
                && qualifier.timed()
            {
                cannot("timed qualifiers", action.at);
            }
        }
    }
    for chart in unit.charts.iter().filter(|c| c.role == ChartRole::Chart) {
        numbers(unit, chart, most, problems);
    }
}

fn numbers(unit: &Unit, chart: &Chart, most: &Limits, problems: &mut Vec<Problem>) {
    for step in super::structure::steps_of(unit, chart) {
        if matches!(step.sort, StepSort::Macro(_)) {
            continue;
        }
        let number = step.name.parse::<usize>().ok();
        if number.is_none_or(|n| n >= most.steps) {
            let text = format!(
                "step `{}` has no number from 0 to {}, as a {} wants",
                step.name,
                most.steps - 1,
                most.name
            );
            problems.push(Problem::new(&codes::TARGET_WORDS, step.at, text));
        }
    }
}
