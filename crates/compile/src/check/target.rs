//! Checks the limits of a PLC (GRAFCET course, implementation in the TSX 37 and 57).
//!
//! The number of active steps and of valid transitions at one time is known only in the run: there
//! the table overflows (`%S25`).

use std::collections::BTreeMap;

use g7_model::{Document, Problem, Qualifier, Said, Span, TargetPlc, codes, say};

use super::pages;
use crate::ir::{ActionKind, Chart, ChartRole, StepId, StepSort, Unit};

/// Most transitions, on every PLC.
const TRANSITIONS: usize = 1024;
/// Most branches of a divergence or convergence.
const BRANCHES: usize = 11;

/// The limits of a PLC.
struct Limits {
    name: Said,
    steps: usize,
    macros: usize,
    macro_steps: usize,
    total: usize,
}

#[inline(never)]
fn limits(plc: TargetPlc) -> Limits {
    match plc {
        TargetPlc::Tsx3710 => {
            Limits { name: Said::foreign("TSX 37-10"), steps: 96, macros: 0, macro_steps: 0, total: 96 }
        }
        TargetPlc::Tsx3720 => {
            Limits { name: Said::foreign("TSX 37-20"), steps: 128, macros: 0, macro_steps: 0, total: 128 }
        }
        TargetPlc::Tsx57 => {
            Limits { name: Said::foreign("TSX 57"), steps: 250, macros: 64, macro_steps: 250, total: 1024 }
        }
    }
}

pub(super) fn check(doc: &Document, unit: &Unit, plc: TargetPlc, problems: &mut Vec<Problem>) {
    let most = limits(plc);
    sizes(unit, &most, problems);
    branches(unit, problems);
    words(unit, &most, problems);
    numbers(unit, &most, problems);
    pages::check(doc, &most.name, problems);
}

/// Compares the counts with the limits. A problem is reported at the first element that exceeds
/// one.
#[inline(never)]
fn sizes(unit: &Unit, most: &Limits, problems: &mut Vec<Problem>) {
    let (mut main, mut inner, mut macros) = (Vec::new(), Vec::new(), Vec::new());
    for step in &unit.steps {
        match (&step.sort, unit.charts.get(step.chart.index()).map(|c| &c.role)) {
            (_, None | Some(ChartRole::Unused)) => {}
            (StepSort::Macro(_), _) => macros.push(step.at),
            (_, Some(ChartRole::Expansion(_))) => inner.push(step.at),
            (_, Some(ChartRole::Chart | ChartRole::Task)) => main.push(step.at),
        }
    }
    let mut over = |code, places: &[Span], limit: usize, what: Said| {
        if let Some(first) = places.get(limit) {
            let text = say!("{} {what}; a {} has room for {limit}", places.len(), most.name);
            problems.push(Problem::new(code, *first, text));
        }
    };
    over(&codes::TARGET_STEPS, &main, most.steps, say!("steps"));
    over(&codes::TARGET_MACROS, &macros, most.macros, say!("macro-steps"));
    if most.macros > 0 {
        let all: Vec<Span> = main.iter().chain(&inner).copied().collect();
        over(&codes::TARGET_STEPS, &all, most.total, say!("steps with those of macro-steps"));
        for chart in unit.charts.iter().filter(|c| matches!(c.role, ChartRole::Expansion(_))) {
            let steps = super::structure::steps_of(unit, chart).iter();
            let own: Vec<Span> =
                steps.filter(|s| !matches!(s.sort, StepSort::Macro(_))).map(|s| s.at).collect();
            over(&codes::TARGET_STEPS, &own, most.macro_steps, say!("steps of one macro-step"));
        }
    }
    let transitions: Vec<Span> = unit.transitions.iter().map(|t| t.at).collect();
    over(&codes::TARGET_TRANSITIONS, &transitions, TRANSITIONS, say!("transitions"));
}

/// Finds divergences and convergences with too many branches.
#[inline(never)]
fn branches(unit: &Unit, problems: &mut Vec<Problem>) {
    let mut wide = |n: usize, what: Said, at: Span| {
        if n > BRANCHES {
            let text = say!("{what} with {n} branches; {BRANCHES} are possible");
            problems.push(Problem::new(&codes::TARGET_BRANCHES, at, text));
        }
    };
    let mut out: BTreeMap<StepId, usize> = BTreeMap::new();
    let mut into: BTreeMap<StepId, usize> = BTreeMap::new();
    for t in &unit.transitions {
        wide(t.to.len(), say!("an AND divergence"), t.at);
        wide(t.from.len(), say!("an AND convergence"), t.at);
        t.from.iter().for_each(|s| *out.entry(*s).or_default() += 1);
        t.to.iter().for_each(|s| *into.entry(*s).or_default() += 1);
    }
    for (list, what) in [(out, say!("an OR divergence")), (into, say!("an OR convergence"))] {
        for (step, n) in list {
            if let Some(s) = unit.steps.get(step.index()) {
                wide(n, what.clone(), s.at);
            }
        }
    }
}

/// Finds actions that PL7 does not have: it knows actions on activation, on deactivation and
/// continuous ones.
#[inline(never)]
fn words(unit: &Unit, most: &Limits, problems: &mut Vec<Problem>) {
    let mut cannot = |what: Said, at: Span| {
        let text = say!("a {} has no {what}", most.name);
        problems.push(Problem::new(&codes::TARGET_WORDS, at, text));
    };
    for step in &unit.steps {
        if matches!(step.sort, StepSort::Enclosing(_)) {
            cannot(say!("enclosing steps"), step.at);
        }
        for (_, at) in &step.calls {
            cannot(say!("tasks"), *at);
        }
        for action in &step.actions {
            match &action.kind {
                ActionKind::Variable { qualifier, .. }
                | ActionKind::Named { qualifier, .. }
                | ActionKind::Work { qualifier, .. } => {
                    if qualifier.timed() || *qualifier == Qualifier::P {
                        cannot(say!("qualifier `{}`", qualifier.name()), action.at);
                    }
                }
                ActionKind::OnEvent { .. } => cannot(say!("actions on an event"), action.at),
                ActionKind::Force(..) => cannot(say!("forcing orders"), action.at),
                ActionKind::Enable(_) | ActionKind::MaskChart(_) | ActionKind::MaskVar(_) => {
                    cannot(say!("orders to enable or mask"), action.at);
                }
                ActionKind::EachScan { .. } => {}
            }
        }
    }
    for t in &unit.transitions {
        if let (Some(first), Some(last)) = (t.on_clearing.first(), t.on_clearing.last()) {
            cannot(say!("actions on clearing"), first.at.to(last.at));
        }
        if t.from.is_empty() || t.to.is_empty() {
            cannot(say!("source and sink transitions"), t.at);
        }
    }
}

/// Checks that step names are numbers, each used once in the main charts and once in each
/// expansion. The ends of an expansion are IN and OUT; macro-steps are `M0` and so on.
#[inline(never)]
fn numbers(unit: &Unit, most: &Limits, problems: &mut Vec<Problem>) {
    let mut main: BTreeMap<usize, Span> = BTreeMap::new();
    for chart in &unit.charts {
        match chart.role {
            ChartRole::Chart => numbers_of(unit, chart, most.steps, most, &mut main, problems),
            ChartRole::Expansion(_) => {
                numbers_of(unit, chart, most.macro_steps, most, &mut BTreeMap::new(), problems);
            }
            ChartRole::Task | ChartRole::Unused => {}
        }
    }
}

#[inline(never)]
fn numbers_of(
    unit: &Unit,
    chart: &Chart,
    limit: usize,
    most: &Limits,
    taken: &mut BTreeMap<usize, Span>,
    problems: &mut Vec<Problem>,
) {
    let steps = super::structure::steps_of(unit, chart);
    let crowded = steps.len() > limit;
    for (id, step) in (chart.steps.start..).map(StepId).zip(steps) {
        let an_end =
            matches!(chart.role, ChartRole::Expansion(_)) && [chart.entry, chart.exit].contains(&Some(id));
        let is_macro = matches!(step.sort, StepSort::Macro(_));
        let digits = if is_macro { step.name.strip_prefix('M').unwrap_or("") } else { &step.name };
        let number = digits.parse::<usize>().ok().filter(|n| *n < if is_macro { most.macros } else { limit });
        match number {
            _ if an_end || is_macro && most.macros == 0 || limit == 0 => {}
            Some(_) if is_macro => {}
            Some(n) => {
                if let Some(first) = taken.insert(n, step.at) {
                    let text = say!("two steps have the number {n}: in PL7 all charts share one numbering");
                    problems.push(
                        Problem::new(&codes::TARGET_WORDS, step.at, text)
                            .related(first, say!("the other one")),
                    );
                }
            }
            // An excess of steps has been reported before.
            None if crowded && step.name.parse::<usize>().is_ok() => {}
            None => {
                let text = if is_macro {
                    say!("macro-step `{}` is none of M0 to M{}", step.name, most.macros - 1)
                } else {
                    let last = limit - 1;
                    say!("step `{}` has no number from 0 to {last}, as a {} wants", step.name, most.name)
                };
                problems.push(Problem::new(&codes::TARGET_WORDS, step.at, text));
            }
        }
    }
}
