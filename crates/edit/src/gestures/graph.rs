//! The neighbours of steps and transitions, and where new ones are written in the text.
//!
//! In most charts the steps are written first and the transitions after them: a new step is written
//! after the step that it follows, a new transition after those that leave the same step. If steps
//! and transitions alternate in the text, the new ones alternate too.

use g7_model::{Chart, ChartItem, Name, Span, Step, StepKind, Transition, say};

use crate::change::{Refusal, refuse};
use crate::draft::Draft;

/// True if the names contain this step.
pub(crate) fn has(names: &[Name], step: &str) -> bool {
    names.iter().any(|n| *n.text == *step)
}

/// The transitions after a step.
pub(crate) fn leaving<'c>(chart: &'c Chart, step: &'c str) -> impl Iterator<Item = &'c Transition> {
    chart.transitions().filter(move |t| has(&t.from, step))
}

/// The transitions before a step.
pub(crate) fn arriving<'c>(chart: &'c Chart, step: &'c str) -> impl Iterator<Item = &'c Transition> {
    chart.transitions().filter(move |t| has(&t.to, step))
}

/// Refuses a link that leaves an exit step: the transitions after its macro-step or caller take
/// that role.
pub(crate) fn may_leave(step: &Step) -> Result<(), Refusal> {
    if step.kind == StepKind::Exit {
        return refuse(say!(
            "nothing follows the exit step `{}`: the transition behind the macro-step or the calling step does",
            step.name.text
        ));
    }
    Ok(())
}

/// Refuses a link to an entry step: its macro-step or caller activates it.
pub(crate) fn may_arrive(step: &Step) -> Result<(), Refusal> {
    if step.kind == StepKind::Entry {
        return refuse(say!(
            "nothing leads to the entry step `{}`: the macro-step or the calling step activates it",
            step.name.text
        ));
    }
    Ok(())
}

/// Adds a step to the preceding (or succeeding) steps of a transition, unless it is among them.
#[inline(never)]
pub(crate) fn add(d: &mut Draft<'_>, chart: &str, at: Span, step: &str, to: bool) -> Result<(), Refusal> {
    vacant(d.transition(chart, at)?, step, to)?;
    let name = d.new_name(step);
    let t = d.transition_mut(chart, at)?;
    let list = if to { &mut t.to } else { &mut t.from };
    list.push(name);
    Ok(())
}

/// Refuses a step that stands on this side of a transition already.
pub(crate) fn vacant(t: &Transition, step: &str, to: bool) -> Result<(), Refusal> {
    match (has(if to { &t.to } else { &t.from }, step), to) {
        (false, _) => Ok(()),
        (true, true) => refuse(say!("step `{step}` stands behind this transition already")),
        (true, false) => refuse(say!("step `{step}` stands before this transition already")),
    }
}

/// Replaces a step in a list by other names; no name is listed twice.
pub(crate) fn replace(list: &mut Vec<Name>, step: &str, by: &[Name]) {
    let Some(k) = list.iter().position(|n| *n.text == *step) else { return };
    list.remove(k);
    let new: Vec<Name> = by.iter().filter(|n| !has(list, &n.text)).cloned().collect();
    for (i, name) in new.into_iter().enumerate() {
        list.insert(k + i, name);
    }
}

/// True if steps and transitions alternate in the text.
fn alternating(chart: &Chart) -> bool {
    let first = chart.items.iter().position(|i| matches!(i, ChartItem::Transition(_)));
    let last = chart.items.iter().rposition(|i| matches!(i, ChartItem::Step(_)));
    matches!((first, last), (Some(t), Some(s)) if t < s)
}

/// The index after the end of the chain that contains item `k`.
fn chain_end(chart: &Chart, k: usize) -> usize {
    let rest = chart.items.iter().skip(k + 1);
    k + 1 + rest.take_while(|i| matches!(i, ChartItem::Transition(t) if t.chained)).count()
}

fn item_of_step(chart: &Chart, step: &str) -> Option<usize> {
    chart.items.iter().position(|i| matches!(i, ChartItem::Step(s) if *s.name.text == *step))
}

/// Writes a new step after another step, or after the last one.
#[inline(never)]
pub(crate) fn put_step(
    d: &mut Draft<'_>,
    chart: &str,
    step: Step,
    behind: Option<&str>,
) -> Result<(), Refusal> {
    let chart = d.chart_mut(chart)?;
    let last = |c: &Chart| {
        let step = c.items.iter().rposition(|i| matches!(i, ChartItem::Step(_)));
        step.or_else(|| c.items.iter().rposition(|i| matches!(i, ChartItem::Var(_))))
    };
    let place = behind.and_then(|s| item_of_step(chart, s));
    let k = match place {
        Some(k) if alternating(chart) => {
            let own = |i: &ChartItem| match (i, behind) {
                (ChartItem::Transition(t), Some(s)) => has(&t.from, s),
                _ => false,
            };
            let t = chart.items.iter().rposition(own).filter(|t| *t > k);
            t.map_or(k + 1, |t| chain_end(chart, t))
        }
        Some(k) => k + 1,
        None => last(chart).map_or(0, |k| chain_end(chart, k)),
    };
    chart.items.insert(k.min(chart.items.len()), ChartItem::Step(step));
    Ok(())
}

/// Writes a new step before another one.
pub(crate) fn put_step_before(
    d: &mut Draft<'_>,
    chart: &str,
    step: Step,
    other: &str,
) -> Result<(), Refusal> {
    let chart = d.chart_mut(chart)?;
    let k = item_of_step(chart, other).unwrap_or(chart.items.len());
    chart.items.insert(k, ChartItem::Step(step));
    Ok(())
}

/// Writes a new transition after those that leave a step, otherwise after those that lead to it,
/// otherwise at the end.
#[inline(never)]
pub(crate) fn put_transition(
    d: &mut Draft<'_>,
    chart: &str,
    t: Transition,
    step: &str,
) -> Result<(), Refusal> {
    let chart = d.chart_mut(chart)?;
    let find = |test: &dyn Fn(&Transition) -> bool| {
        chart.items.iter().rposition(|i| matches!(i, ChartItem::Transition(t) if test(t)))
    };
    let near = find(&|t| has(&t.from, step)).or_else(|| find(&|t| has(&t.to, step)));
    let own = if alternating(chart) { item_of_step(chart, step) } else { None };
    let place = near.max(own).or_else(|| find(&|_| true));
    let k = place.map_or_else(
        || {
            chart
                .items
                .iter()
                .rposition(|i| matches!(i, ChartItem::Step(_)))
                .map_or(chart.items.len(), |k| k + 1)
        },
        |k| chain_end(chart, k),
    );
    chart.items.insert(k.min(chart.items.len()), ChartItem::Transition(t));
    Ok(())
}

/// Writes a new transition directly before or after another, so that the branches of a selection
/// keep their order.
#[inline(never)]
pub(crate) fn put_beside(
    d: &mut Draft<'_>,
    chart: &str,
    t: Transition,
    other: Span,
    behind: bool,
) -> Result<(), Refusal> {
    let chart = d.chart_mut(chart)?;
    let same = |i: &ChartItem| matches!(i, ChartItem::Transition(x) if x.at.0 == other);
    let k = chart.items.iter().position(same).unwrap_or(chart.items.len());
    let k = if behind { chain_end(chart, k) } else { k };
    chart.items.insert(k.min(chart.items.len()), ChartItem::Transition(t));
    Ok(())
}
