//! Adds links between existing parts. Steps and transitions alternate, so a missing one is inserted
//! between two of the same kind.

use g7_model::{Chart, Name, Span, say};

use super::build::fresh_step;
use super::graph::{add, has, may_arrive, may_leave, put_transition};
use super::nodes::{Node, node, one_chart};
use crate::change::{Refusal, refuse};
use crate::draft::Draft;
use crate::gesture::Branching;
use crate::id::ItemId;

#[inline(never)]
pub(crate) fn connect(d: &mut Draft<'_>, from: &ItemId, to: &ItemId) -> Result<(), Refusal> {
    if from.chart != to.chart {
        return refuse(say!(
            "a link stays within its chart; charts act on each other by forcing and by X variables"
        ));
    }
    let chart = from.chart.as_str();
    match (node(d, from)?, node(d, to)?) {
        (Node::Step(a), Node::Transition(t)) => {
            may_leave(d.step(chart, &a)?)?;
            add(d, chart, t, &a, false)?;
            d.select(from.clone());
        }
        (Node::Transition(t), Node::Step(b)) => {
            may_arrive(d.step(chart, &b)?)?;
            add(d, chart, t, &b, true)?;
            d.select(to.clone());
        }
        (Node::Step(a), Node::Step(b)) => link_steps(d, chart, &[&a], &b)?,
        (Node::Transition(a), Node::Transition(b)) => {
            if a == b {
                return refuse(say!(
                    "a transition cannot follow itself; a step stands between two transitions"
                ));
            }
            let near = d.transition(chart, a)?.from.last().map(|n| n.text.to_string());
            let name = fresh_step(d, chart, near.as_deref())?;
            add(d, chart, a, &name, true)?;
            add(d, chart, b, &name, false)?;
            d.select_step(chart, &name);
        }
    }
    Ok(())
}

/// Adds a transition from some steps to a step.
#[inline(never)]
fn link_steps(d: &mut Draft<'_>, chart: &str, from: &[&str], to: &str) -> Result<(), Refusal> {
    for step in from {
        may_leave(d.step(chart, step)?)?;
    }
    may_arrive(d.step(chart, to)?)?;
    let t = d.new_transition(from, &[to]);
    let at = t.at;
    put_transition(d, chart, t, from.last().copied().unwrap_or(to))?;
    d.select.push(crate::draft::Mark::Transition(chart.to_owned(), at.0));
    d.begin_transition(chart, at);
    Ok(())
}

/// Adds a link to a step. A transition that leads to exactly one other step leads to this one
/// instead.
#[inline(never)]
pub(crate) fn jump(d: &mut Draft<'_>, id: &ItemId, to: &ItemId) -> Result<(), Refusal> {
    if id.chart != to.chart {
        return refuse(say!("a jump stays within its chart"));
    }
    let chart = id.chart.as_str();
    let Node::Step(target) = node(d, to)? else { return refuse(say!("a jump leads to a step")) };
    match node(d, id)? {
        Node::Step(step) => link_steps(d, chart, &[&step], &target),
        Node::Transition(at) => {
            may_arrive(d.step(chart, &target)?)?;
            let name = d.new_name(&target);
            let t = d.transition_mut(chart, at)?;
            if t.to.len() > 1 {
                return refuse(say!(
                    "this transition begins simultaneous sequences; take the link away that is to go"
                ));
            }
            if has(&t.to, &target) {
                return refuse(say!("this transition leads to step `{target}` already"));
            }
            t.to = vec![name];
            d.select(to.clone());
            Ok(())
        }
    }
}

/// Makes branches converge at a step: each by a transition of its own (or), or all by one
/// transition (and).
#[inline(never)]
pub(crate) fn converge(
    d: &mut Draft<'_>,
    ids: &[ItemId],
    how: Branching,
    to: Option<&ItemId>,
) -> Result<(), Refusal> {
    let chart = one_chart(ids)?.to_owned();
    if to.is_some_and(|t| t.chart != chart) {
        return refuse(say!("branches come together within their chart"));
    }
    let (mut steps, mut transitions) = (Vec::new(), Vec::new());
    for id in ids {
        match node(d, id)? {
            Node::Step(s) if !steps.contains(&s) => steps.push(s),
            Node::Transition(t) if !transitions.contains(&t) => transitions.push(t),
            Node::Step(_) | Node::Transition(_) => {}
        }
    }
    if steps.len() + transitions.len() < 2 {
        return refuse(say!("several branches come together; choose the end of each"));
    }
    for step in &steps {
        may_leave(d.step(&chart, step)?)?;
    }
    match how {
        Branching::Or => alternatives(d, &chart, &steps, &transitions, to),
        Branching::And => simultaneous(d, &chart, &steps, &transitions, to),
    }
}

/// The step at which the branches converge: the given one, or a new one, written after the last of
/// the branches' steps.
#[inline(never)]
fn target(d: &mut Draft<'_>, chart: &str, steps: &[String], to: Option<&ItemId>) -> Result<String, Refusal> {
    let Some(to) = to else {
        let place = |c: &Chart, s: &String| c.steps().position(|x| *x.name.text == **s);
        let home = d.chart(chart)?;
        let last = steps.iter().max_by_key(|s| place(home, s)).cloned();
        return fresh_step(d, chart, last.as_deref());
    };
    match node(d, to)? {
        Node::Step(step) => {
            may_arrive(d.step(chart, &step)?)?;
            Ok(step)
        }
        Node::Transition(_) => refuse(say!("branches lead together to a step")),
    }
}

#[inline(never)]
fn alternatives(
    d: &mut Draft<'_>,
    chart: &str,
    steps: &[String],
    transitions: &[Span],
    to: Option<&ItemId>,
) -> Result<(), Refusal> {
    for t in transitions {
        if !d.transition(chart, *t)?.to.is_empty() {
            return refuse(say!("a chosen transition leads to a step already; choose the end of the branch"));
        }
    }
    let mut known = steps.to_vec();
    for t in transitions {
        known.extend(d.transition(chart, *t)?.from.iter().map(|n| n.text.to_string()));
    }
    let target = target(d, chart, &known, to)?;
    if steps.contains(&target) {
        return refuse(say!("step `{target}` is one of the branches"));
    }
    for step in steps {
        let t = d.new_transition(&[step], &[&target]);
        put_transition(d, chart, t, step)?;
    }
    for t in transitions {
        add(d, chart, *t, &target, true)?;
    }
    d.select_step(chart, &target);
    Ok(())
}

#[inline(never)]
fn simultaneous(
    d: &mut Draft<'_>,
    chart: &str,
    steps: &[String],
    transitions: &[Span],
    to: Option<&ItemId>,
) -> Result<(), Refusal> {
    match transitions {
        [] => {
            let target = target(d, chart, steps, to)?;
            let names: Vec<&str> = steps.iter().map(String::as_str).collect();
            link_steps(d, chart, &names, &target)?;
            if to.is_none() {
                d.select_step(chart, &target);
            }
            Ok(())
        }
        [one] => {
            let there: Vec<Name> = d.transition(chart, *one)?.from.clone();
            for step in steps.iter().filter(|s| !has(&there, s)) {
                add(d, chart, *one, step, false)?;
            }
            Ok(())
        }
        _ => refuse(say!("simultaneous sequences end at one transition; choose their last steps")),
    }
}
