//! Inserts parts into a link or beside a sequence.

use g7_model::{Span, StepKind, say};

use super::build::fresh_step;
use super::chosen::Chosen;
use super::graph::{add, put_beside, put_step, replace};
use super::table::add_expansion;
use crate::change::{Refusal, refuse};
use crate::draft::Draft;
use crate::gesture::What;
use crate::id::{End, ItemId, Part};

/// Inserts a step and a transition into a link.
#[inline(never)]
pub(crate) fn insert(d: &mut Draft<'_>, link: &ItemId, what: What) -> Result<(), Refusal> {
    let chart = link.chart.as_str();
    let (from, to) = match &link.part {
        Part::Link(from, to) | Part::Connector(from, to, _) => (from, to),
        _ => return refuse(say!("something is inserted into a link; choose a link")),
    };
    let (step, at, leaving) = ends(d, chart, from, to)?;
    let mut name = d.step_name(d.chart(chart)?);
    let mut kind = StepKind::Plain;
    match what {
        What::Macro => {
            name = macro_name(d, chart, &name)?;
            let expansion = add_expansion(d, &format!("Expansion{}", name.trim_start_matches('M')))?;
            kind = StepKind::Macro(d.new_name(&expansion));
        }
        What::Enclosing => kind = StepKind::Enclosing,
        What::Step | What::Transition => {}
    }
    let new = [d.new_name(&name)];
    let t = if leaving { d.new_transition(&[&step], &[&name]) } else { d.new_transition(&[&name], &[&step]) };
    let born = t.at;
    let old = d.transition_mut(chart, at)?;
    replace(if leaving { &mut old.from } else { &mut old.to }, &step, &new);
    let near = if leaving { None } else { d.transition(chart, at)?.from.last().map(|n| n.text.to_string()) };
    let near = near.unwrap_or(step.clone());
    put_beside(d, chart, t, at, !leaving)?;
    let mut born_step = d.new_step(&name);
    born_step.kind = kind;
    put_step(d, chart, born_step, Some(&near))?;
    d.select_step(chart, &name);
    if what != What::Macro {
        d.begin_transition(chart, born);
    }
    Ok(())
}

/// The step and the transition of a link; the flag is true if the step comes first.
#[inline(never)]
fn ends(d: &Draft<'_>, chart: &str, from: &End, to: &End) -> Result<(String, Span, bool), Refusal> {
    let (step, number, leaving) = match (from, to) {
        (End::Step(s), End::Transition(t)) => (s, *t, true),
        (End::Transition(t), End::Step(s)) => (s, *t, false),
        _ => return refuse(say!("a link joins a step and a transition")),
    };
    let at = d.number(chart, number)?;
    let t = d.transition(chart, at)?;
    let list = if leaving { &t.from } else { &t.to };
    if !super::graph::has(list, step) {
        return refuse(say!("this link no longer exists"));
    }
    Ok((step.clone(), at, leaving))
}

/// The name `M3` if names of steps are numbers and it is free, otherwise the given name.
pub(crate) fn macro_name(d: &Draft<'_>, chart: &str, name: &str) -> Result<String, Refusal> {
    let number = name.bytes().all(|b| b.is_ascii_digit());
    let wanted = format!("M{name}");
    let taken = d.chart(chart)?.steps().any(|s| *s.name.text == *wanted);
    Ok(if number && !taken { wanted } else { name.to_owned() })
}

/// Adds a step beside a sequence: the transition before the sequence activates it too, and the
/// transition after the sequence waits for it too.
#[inline(never)]
pub(crate) fn parallel(d: &mut Draft<'_>, ids: &[ItemId]) -> Result<(), Refusal> {
    let chosen = Chosen::new(d, ids)?;
    let chart = chosen.chart.clone();
    let home = d.chart(&chart)?;
    let inside = |names: &[g7_model::Name]| names.iter().any(|n| chosen.has_step(&n.text));
    let outside = |at: Span| !chosen.transitions.contains(&at);
    let before: Vec<Span> =
        home.transitions().filter(|t| outside(t.at.0) && inside(&t.to)).map(|t| t.at.0).collect();
    let behind: Vec<Span> =
        home.transitions().filter(|t| outside(t.at.0) && inside(&t.from)).map(|t| t.at.0).collect();
    let within = |t: &Span| before.contains(t) && behind.contains(t);
    let (before, behind): (Vec<Span>, Vec<Span>) = if chosen.steps.len() > 1 {
        // A transition between two chosen steps belongs to the sequence.
        (
            before.iter().filter(|t| !within(t)).copied().collect(),
            behind.iter().filter(|t| !within(t)).copied().collect(),
        )
    } else {
        (before.clone(), behind.clone())
    };
    let ([first], [last]) = (before.as_slice(), behind.as_slice()) else {
        return refuse(say!(
            "simultaneous sequences begin and end at one transition each: choose a sequence with one \
             transition before it and one behind it"
        ));
    };
    let name = fresh_step(d, &chart, chosen.steps.last().map(String::as_str))?;
    add(d, &chart, *first, &name, true)?;
    add(d, &chart, *last, &name, false)?;
    d.select_step(&chart, &name);
    Ok(())
}
