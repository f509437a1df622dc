//! Checks forcing orders and enclosures: which chart controls which.

use std::collections::{BTreeMap, BTreeSet};

use g7_model::{Problem, Said, codes, say};

use super::facts::Facts;
use crate::ir::{ActionKind, ChartId, ChartRole, Situation, StepId, Unit};

pub(super) fn check(facts: &Facts<'_>, problems: &mut Vec<Problem>) {
    let orders = orders(facts.unit);
    circles(facts.unit, &orders, problems);
    both(facts, &orders, problems);
    disagree(facts.unit, &orders, problems);
}

/// A forcing order: the chart that gives it, the chart forced, the step and the place.
struct Order<'u> {
    by: ChartId,
    on: ChartId,
    step: StepId,
    situation: (ChartId, &'u Situation),
    at: g7_model::Span,
}

/// The chart, outside of all expansions, that this chart belongs to.
#[inline(never)]
fn outermost(unit: &Unit, mut chart: ChartId) -> ChartId {
    // `resolve` has checked that nesting is finite; the bound only guards against an error here.
    for _ in 0..unit.charts.len() {
        match unit.charts.get(chart.index()).map(|c| &c.role) {
            Some(ChartRole::Expansion(m)) => match unit.steps.get(m.index()) {
                Some(step) => chart = step.chart,
                None => return chart,
            },
            _ => return chart,
        }
    }
    chart
}

#[inline(never)]
fn orders(unit: &Unit) -> Vec<Order<'_>> {
    let mut list = Vec::new();
    for (i, step) in unit.steps.iter().enumerate() {
        for action in &step.actions {
            if let ActionKind::Force(on, situation) = &action.kind {
                list.push(Order {
                    by: outermost(unit, step.chart),
                    on: outermost(unit, *on),
                    step: StepId(i as u32),
                    situation: (*on, situation),
                    at: action.at,
                });
            }
        }
    }
    list
}

/// Finds charts that force themselves or a chart that encloses them, directly or through others.
/// For this an enclosing step controls its charts as a forcing order does.
#[inline(never)]
fn circles(unit: &Unit, orders: &[Order<'_>], problems: &mut Vec<Problem>) {
    let mut rules: BTreeMap<ChartId, BTreeSet<ChartId>> = BTreeMap::new();
    for order in orders {
        rules.entry(order.by).or_default().insert(order.on);
    }
    for (i, chart) in unit.charts.iter().enumerate() {
        if let Some(step) = chart.enclosed_by.and_then(|e| unit.steps.get(e.index())) {
            rules.entry(outermost(unit, step.chart)).or_default().insert(ChartId(i as u32));
        }
    }
    let mut within: BTreeMap<ChartId, BTreeSet<ChartId>> = BTreeMap::new();
    for order in orders {
        let seen = within.entry(order.on).or_insert_with(|| {
            let mut seen = BTreeSet::new();
            let mut pending = vec![order.on];
            while let Some(chart) = pending.pop() {
                if seen.insert(chart) {
                    pending.extend(rules.get(&chart).into_iter().flatten());
                }
            }
            seen
        });
        if seen.contains(&order.by) {
            let name = |c: ChartId| unit.charts.get(c.index()).map_or("", |c| &*c.name);
            let what = if order.by == order.on {
                say!("chart `{}` forces itself", name(order.by))
            } else {
                say!(
                    "chart `{}` forces `{}`, which forces or encloses it in turn",
                    name(order.by),
                    name(order.on)
                )
            };
            problems.push(
                Problem::new(&codes::FORCING_CIRCLE, order.at, what)
                    .help(say!("forcing goes down a hierarchy: let one chart above force the others")),
            );
        }
    }
}

/// A chart that is both forced and enclosed.
#[inline(never)]
fn both(facts: &Facts<'_>, orders: &[Order<'_>], problems: &mut Vec<Problem>) {
    let unit = facts.unit;
    for order in orders {
        let Some(chart) = unit.charts.get(order.on.index()) else { continue };
        let together = chart.enclosed_by.filter(|e| !facts.exclude(*e, order.step));
        let Some(encloser) = together else { continue };
        let at = unit.steps.get(encloser.index()).map_or(chart.at, |s| s.at);
        let what = say!("chart `{}` is forced and enclosed at once", chart.name);
        problems.push(
            Problem::new(&codes::FORCED_AND_ENCLOSED, order.at, what)
                .related(at, say!("this step encloses it"))
                .help(say!(
                    "force it from steps that are never active with the enclosing step, or use one of the two"
                )),
        );
    }
}

/// Finds two orders at one moment, from one step or from steps that one transition activates
/// together, that demand different situations of one chart.
#[inline(never)]
fn disagree(unit: &Unit, orders: &[Order<'_>], problems: &mut Vec<Problem>) {
    let mut by_step: BTreeMap<StepId, Vec<usize>> = BTreeMap::new();
    for (i, order) in orders.iter().enumerate() {
        by_step.entry(order.step).or_default().push(i);
    }
    let of = |steps: &[StepId]| {
        let all: BTreeSet<usize> = steps.iter().filter_map(|s| by_step.get(s)).flatten().copied().collect();
        all.into_iter().filter_map(|i| orders.get(i)).collect::<Vec<_>>()
    };
    let mut told = BTreeSet::new();
    let single = by_step.keys().map(|s| of(&[*s]));
    let forked = unit.transitions.iter().filter(|t| t.to.len() > 1).map(|t| of(&t.to));
    for group in single.chain(forked).filter(|g| g.len() > 1) {
        let mut first: BTreeMap<ChartId, &Order<'_>> = BTreeMap::new();
        for order in group {
            let before = *first.entry(order.situation.0).or_insert(order);
            let (ones, others) = (wanted(unit, before), wanted(unit, order));
            if ones != others && told.insert(order.at) {
                let name = unit.charts.get(order.on.index()).map_or("", |c| &*c.name);
                // The present situation may be the one that the other order names.
                let (is, but) = if ones.is_some() && others.is_some() {
                    (say!("is"), Said::default())
                } else {
                    (say!("can be"), say!(" unless the chart is in the named situation"))
                };
                let what = say!("chart `{name}` {is} forced into two situations at one moment");
                problems.push(
                    Problem::new(&codes::ORDERS_DISAGREE, order.at, what)
                        .related(before.at, say!("another situation is ordered here"))
                        .help(say!("a run stops with a fault there{but}; keep one of the two orders")),
                );
            }
        }
    }
}

/// The situation that an order demands; `None` for `{*}`, which keeps the present one.
#[inline(never)]
fn wanted(unit: &Unit, order: &Order<'_>) -> Option<BTreeSet<StepId>> {
    let (chart, situation) = order.situation;
    match situation {
        Situation::Current => None,
        Situation::Steps(list) => Some(list.iter().copied().collect()),
        Situation::Init => {
            let range = unit.charts.get(chart.index()).map_or(0..0, |c| c.steps.clone());
            let initial = |s: &StepId| unit.steps.get(s.index()).is_some_and(|s| s.initial);
            Some(range.map(StepId).filter(initial).collect())
        }
    }
}
