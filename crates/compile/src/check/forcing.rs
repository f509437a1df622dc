//! Forcing orders and enclosures: who rules whom; and loops that never rest.

use std::collections::BTreeSet;

use g7_model::{Problem, codes};

use super::structure::transitions_of;
use crate::ir::{ActionKind, ChartId, ChartRole, ExprKind, StepId, StepSort, Unit, Value};

pub(super) fn check(unit: &Unit, problems: &mut Vec<Problem>) {
    let orders = orders(unit);
    circles(unit, &orders, problems);
    both(unit, &orders, problems);
    if unit.rules.stable {
        restless(unit, problems);
    }
}

/// A forcing order: the chart that gives it, the chart forced, the step and the place.
struct Order {
    by: ChartId,
    on: ChartId,
    step: StepId,
    at: g7_model::Span,
}

/// The chart that an expansion belongs to at last.
fn outermost(unit: &Unit, mut chart: ChartId) -> ChartId {
    // Nesting is finite (checked by resolve); the bound is a seat belt.
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

fn orders(unit: &Unit) -> Vec<Order> {
    let mut list = Vec::new();
    for (i, step) in unit.steps.iter().enumerate() {
        for action in &step.actions {
            if let ActionKind::Force(on, _) = &action.kind {
                let by = outermost(unit, step.chart);
                list.push(Order { by, on: outermost(unit, *on), step: StepId(i as u32), at: action.at });
            }
        }
    }
    list
}

/// A chart that forces itself, directly or through others.
fn circles(unit: &Unit, orders: &[Order], problems: &mut Vec<Problem>) {
    for order in orders {
        let mut seen = BTreeSet::new();
        let mut pending = vec![order.on];
        while let Some(chart) = pending.pop() {
            if seen.insert(chart) {
                pending.extend(orders.iter().filter(|o| o.by == chart).map(|o| o.on));
            }
        }
        if seen.contains(&order.by) {
            let name = |c: ChartId| unit.charts.get(c.index()).map_or("", |c| &*c.name);
            let what = if order.by == order.on {
                format!("chart `{}` forces itself", name(order.by))
            } else {
                format!("chart `{}` forces `{}`, which forces it in turn", name(order.by), name(order.on))
            };
            problems.push(
                Problem::new(&codes::FORCING_CIRCLE, order.at, what)
                    .help("forcing goes down a hierarchy: let one chart above force the others"),
            );
        }
    }
}

/// A chart that is both forced and enclosed.
fn both(unit: &Unit, orders: &[Order], problems: &mut Vec<Problem>) {
    for order in orders {
        let Some(chart) = unit.charts.get(order.on.index()) else { continue };
        if let Some(encloser) = chart.enclosed_by.filter(|e| together(unit, *e, order.step)) {
            let at = unit.steps.get(encloser.index()).map_or(chart.at, |s| s.at);
            let what = format!("chart `{}` is forced and enclosed at once", chart.name);
            problems.push(
                Problem::new(&codes::FORCED_AND_ENCLOSED, order.at, what)
                    .related(at, "this step encloses it")
                    .help("force it from steps that are never active with the enclosing step, or use one of the two"),
            );
        }
    }
}

/// Whether two steps may be active together, as far as a look at one chart tells:
/// in one chart without AND divergence and with one initial step they may not.
fn together(unit: &Unit, a: StepId, b: StepId) -> bool {
    let (Some(x), Some(y)) = (unit.steps.get(a.index()), unit.steps.get(b.index())) else { return false };
    if a == b || x.chart != y.chart {
        return true;
    }
    let Some(chart) = unit.charts.get(x.chart.index()) else { return true };
    let one_token = transitions_of(unit, chart).iter().all(|t| t.from.len() == 1 && t.to.len() <= 1);
    let starts = super::structure::steps_of(unit, chart).iter().filter(|s| s.initial || s.linked).count();
    !(one_token && starts <= 1 && !unit.rules.multi_token)
        && !(one_token && starts <= 1 && single_exits(unit, chart))
}

/// No step of the chart has two ways out, so even multi-token keeps one token.
fn single_exits(unit: &Unit, chart: &crate::ir::Chart) -> bool {
    let mut seen = BTreeSet::new();
    transitions_of(unit, chart).iter().flat_map(|t| &t.from).all(|f| seen.insert(*f))
}

/// Loops in which every receptivity is always true: once reached they never rest.
fn restless(unit: &Unit, problems: &mut Vec<Problem>) {
    let always = |t: &crate::ir::Transition| {
        matches!(t.receptivity.kind, ExprKind::Const(Value::Bool(true)))
            && t.from.len() == 1
            && t.to.len() == 1
    };
    let plain = |s: StepId| unit.steps.get(s.index()).is_some_and(|s| matches!(s.sort, StepSort::Plain));
    let mut next: Vec<Option<usize>> = vec![None; unit.steps.len()];
    for (i, t) in unit.transitions.iter().enumerate().filter(|(_, t)| always(t)) {
        if let (Some(from), Some(to)) = (t.from.first(), t.to.first())
            && plain(*from)
            && plain(*to)
            && from != to
            && let Some(n) = next.get_mut(from.index())
        {
            n.get_or_insert(i);
        }
    }
    // Each step leads to at most one other: walk, and colour what was seen.
    let mut colour = vec![0usize; unit.steps.len()];
    for start in 0..unit.steps.len() {
        let mut at = start;
        while colour.get(at) == Some(&0) {
            if let Some(c) = colour.get_mut(at) {
                *c = start + 1;
            }
            match next
                .get(at)
                .copied()
                .flatten()
                .and_then(|t| unit.transitions.get(t))
                .and_then(|t| t.to.first())
            {
                Some(to) => at = to.index(),
                None => break,
            }
            if colour.get(at) == Some(&(start + 1)) {
                tell(unit, &next, at, problems);
            }
        }
    }
}

fn tell(unit: &Unit, next: &[Option<usize>], start: usize, problems: &mut Vec<Problem>) {
    let mut names = Vec::new();
    let mut at = start;
    let mut place = None;
    loop {
        let (Some(step), Some(t)) =
            (unit.steps.get(at), next.get(at).copied().flatten().and_then(|t| unit.transitions.get(t)))
        else {
            return;
        };
        names.push(format!("`{}`", step.name));
        place.get_or_insert(t.at);
        at = t.to.first().map_or(start, |s| s.index());
        if at == start {
            break;
        }
    }
    let Some(place) = place else { return };
    let what =
        format!("the loop {} never rests: each of its receptivities is always true", names.join(" → "));
    problems.push(
        Problem::new(&codes::RESTLESS_LOOP, place, what)
            .help("give at least one of its transitions a receptivity that can be false"),
    );
}
