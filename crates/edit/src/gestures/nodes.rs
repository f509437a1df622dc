//! The steps, transitions and links that the ids of a gesture name.
//!
//! A gesture begins here: its ids come from the drawing and may be out of date, so an id is never
//! used before the draft has been found to contain its part.

use g7_model::{Span, say};

use crate::change::{Refusal, refuse};
use crate::draft::Draft;
use crate::id::{End, ItemId, Part};

/// The step or transition that an id names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Node {
    Step(String),
    Transition(Span),
}

/// The step (also for an id of one of its actions) or the transition that an id names, if it
/// exists.
#[inline(never)]
pub(crate) fn node(d: &Draft<'_>, id: &ItemId) -> Result<Node, Refusal> {
    match &id.part {
        Part::Step(name) => {
            d.step(&id.chart, name)?;
            Ok(Node::Step(name.clone()))
        }
        Part::Action(name, k) => {
            if d.step(&id.chart, name)?.actions.get(*k).is_none() {
                return refuse(say!("step `{name}` has no action number {k}"));
            }
            Ok(Node::Step(name.clone()))
        }
        Part::Transition(n) => Ok(Node::Transition(d.number(&id.chart, *n)?)),
        Part::Chart | Part::Link(..) | Part::Connector(..) | Part::Note(_) | Part::Other(_) => {
            refuse(say!("this is done with a step or a transition; choose one"))
        }
    }
}

/// The chart of all ids; refuses ids of several charts.
pub(crate) fn one_chart(ids: &[ItemId]) -> Result<&str, Refusal> {
    let Some(first) = ids.first() else { return refuse(say!("nothing is chosen")) };
    if ids.iter().any(|id| id.chart != first.chart) {
        return refuse(say!("the chosen things are of several charts; this is done in one"));
    }
    Ok(&first.chart)
}

/// The chart, step and transition of a link; the flag is true if the link leaves the step.
pub(crate) fn link(
    d: &Draft<'_>,
    chart: &str,
    a: &End,
    b: &End,
) -> Result<(String, String, Span, bool), Refusal> {
    let (step, number, leaving) = match (a, b) {
        (End::Step(s), End::Transition(t)) => (s, *t, true),
        (End::Transition(t), End::Step(s)) => (s, *t, false),
        _ => return refuse(say!("a link joins a step and a transition")),
    };
    Ok((chart.to_owned(), step.clone(), d.number(chart, number)?, leaving))
}
