//! Adds steps and transitions after, before and beside others.

use g7_model::{Chart, ChartKind, Span, StepKind, say};

use super::graph::{add, leaving, may_arrive, may_leave, put_step, put_step_before, put_transition};
use super::nodes::{Node, node};
use super::{layout_section, places};
use crate::change::{Refusal, refuse};
use crate::draft::Draft;
use crate::gesture::{Branching, Sort};
use crate::id::ItemId;

/// Adds a step without links. The first step of a chart is initial; the first step of an expansion
/// or task is its entry step.
#[inline(never)]
pub(crate) fn add_step(
    d: &mut Draft<'_>,
    chart: &str,
    at: Option<[f64; 2]>,
    sort: Option<Sort>,
) -> Result<(), Refusal> {
    let home = d.chart(chart)?;
    let name = d.step_name(home);
    let (first, kind) = (home.steps().next().is_none(), home.kind);
    let mut step = d.new_step(&name);
    if first && kind == ChartKind::Chart {
        step.initial = !enclosed(d, chart);
    } else if first {
        step.kind = StepKind::Entry;
    }
    put_step(d, chart, step, None)?;
    if let Some(sort) = sort {
        super::fields::kind(d, &ItemId::step(chart, name.as_str()), sort)?;
        d.select.clear();
    }
    if let Some(at) = at {
        places::place(d, &ItemId::step(chart, name.as_str()), layout_section::point(at)?)?;
    }
    d.select_step(chart, &name);
    Ok(())
}

/// True if the chart is enclosed by a step.
fn enclosed(d: &Draft<'_>, chart: &str) -> bool {
    use g7_model::{ActionKind, Order};
    let actions = |c: &Chart| c.steps().flat_map(|s| s.actions.clone()).collect::<Vec<_>>();
    d.doc.charts().flat_map(actions).any(|a| match a.kind {
        ActionKind::Order(Order::Enclose(name)) => *name.text == *chart,
        _ => false,
    })
}

/// Adds a plain step; in the text it stands after `behind`. Returns its name.
pub(crate) fn fresh_step(d: &mut Draft<'_>, chart: &str, behind: Option<&str>) -> Result<String, Refusal> {
    let name = d.step_name(d.chart(chart)?);
    let step = d.new_step(&name);
    put_step(d, chart, step, behind)?;
    Ok(name)
}

/// Adds a transition and a step after a step.
#[inline(never)]
fn onward(d: &mut Draft<'_>, chart: &str, from: &str) -> Result<(), Refusal> {
    may_leave(d.step(chart, from)?)?;
    let name = d.step_name(d.chart(chart)?);
    let t = d.new_transition(&[from], &[&name]);
    let at = t.at;
    put_transition(d, chart, t, from)?;
    let step = d.new_step(&name);
    put_step(d, chart, step, Some(from))?;
    d.select_step(chart, &name);
    d.begin_transition(chart, at);
    Ok(())
}

#[inline(never)]
pub(crate) fn next(d: &mut Draft<'_>, id: &ItemId) -> Result<(), Refusal> {
    match node(d, id)? {
        Node::Step(step) => onward(d, &id.chart, &step),
        Node::Transition(at) => {
            let there = d.transition(&id.chart, at)?.to.first().map(|n| n.text.to_string());
            match there {
                // The sequence already goes on: select its next step.
                Some(step) => d.select_step(&id.chart, &step),
                None => step_behind(d, &id.chart, at)?,
            }
            Ok(())
        }
    }
}

/// Adds a step after a transition.
fn step_behind(d: &mut Draft<'_>, chart: &str, at: Span) -> Result<(), Refusal> {
    let near = near(d, chart, at)?;
    let name = fresh_step(d, chart, near.as_deref())?;
    add(d, chart, at, &name, true)?;
    d.select_step(chart, &name);
    Ok(())
}

/// The step after which, in the text, a new succeeding step of the transition is written.
fn near(d: &Draft<'_>, chart: &str, at: Span) -> Result<Option<String>, Refusal> {
    let t = d.transition(chart, at)?;
    Ok(t.to.last().or(t.from.last()).map(|n| n.text.to_string()))
}

#[inline(never)]
pub(crate) fn before(d: &mut Draft<'_>, id: &ItemId) -> Result<(), Refusal> {
    let chart = id.chart.as_str();
    match node(d, id)? {
        Node::Step(step) => {
            may_arrive(d.step(chart, &step)?)?;
            let name = d.step_name(d.chart(chart)?);
            let t = d.new_transition(&[&name], &[&step]);
            let at = t.at;
            put_transition(d, chart, t, &step)?;
            let new = d.new_step(&name);
            put_step_before(d, chart, new, &step)?;
            d.select_step(chart, &name);
            d.begin_transition(chart, at);
        }
        Node::Transition(at) => {
            if let Some(there) = d.transition(chart, at)?.from.first().map(|n| n.text.to_string()) {
                d.select_step(chart, &there);
                return Ok(());
            }
            let behind = d.transition(chart, at)?.to.first().map(|n| n.text.to_string());
            let name = d.step_name(d.chart(chart)?);
            let step = d.new_step(&name);
            match behind {
                Some(other) => put_step_before(d, chart, step, &other)?,
                None => put_step(d, chart, step, None)?,
            }
            add(d, chart, at, &name, false)?;
            d.select_step(chart, &name);
        }
    }
    Ok(())
}

/// Adds a branch: a selection begins after a step, simultaneous sequences begin after a transition.
#[inline(never)]
pub(crate) fn branch(d: &mut Draft<'_>, id: &ItemId, how: Branching) -> Result<(), Refusal> {
    let chart = id.chart.as_str();
    match (node(d, id)?, how) {
        (Node::Step(step), Branching::Or) => onward(d, chart, &step),
        (Node::Step(step), Branching::And) => {
            let home = d.chart(chart)?;
            let behind: Vec<Span> = leaving(home, &step).map(|t| t.at.0).collect();
            match behind.as_slice() {
                [one] => step_behind(d, chart, *one),
                _ => refuse(say!(
                    "simultaneous sequences begin behind one transition; choose the transition, not the step"
                )),
            }
        }
        (Node::Transition(at), Branching::And) => step_behind(d, chart, at),
        (Node::Transition(at), Branching::Or) => {
            let from: Vec<String> =
                d.transition(chart, at)?.from.iter().map(|n| n.text.to_string()).collect();
            let Some(last) = from.last().cloned() else {
                return refuse(say!("alternatives begin behind a step; this transition has none before it"));
            };
            let name = d.step_name(d.chart(chart)?);
            let names: Vec<&str> = from.iter().map(String::as_str).collect();
            let t = d.new_transition(&names, &[&name]);
            let new = t.at;
            put_transition(d, chart, t, &last)?;
            let step = d.new_step(&name);
            put_step(d, chart, step, Some(&last))?;
            d.select_step(chart, &name);
            d.begin_transition(chart, new);
            Ok(())
        }
    }
}
