//! Ids of items, shared by the page and this crate: `Chart/s/Step`, `Chart/a/Step/0`, `Chart/t/3`;
//! and the item at a place of the text.

use g7_edit::ItemId;
use g7_model::{Chart, Document, Span, Step};

/// The id of a step.
pub fn step(chart: &str, name: &str) -> String {
    ItemId::step(chart, name).to_string()
}

/// The id of an action.
pub fn action(chart: &str, step: &str, index: usize) -> String {
    ItemId::action(chart, step, index).to_string()
}

/// The id of a transition.
pub fn transition(chart: &str, number: usize) -> String {
    ItemId::transition(chart, number).to_string()
}

/// A part of a chart that has an id.
#[derive(Clone, Copy, Debug)]
pub enum Thing<'d> {
    /// A step of a chart.
    Step(&'d Chart, &'d Step),
    /// An action: its chart, its step, its number.
    Action(&'d Chart, &'d Step, usize),
    /// A transition: its chart, its number.
    Transition(&'d Chart, usize),
}

impl Thing<'_> {
    /// Its id.
    pub fn id(self) -> String {
        match self {
            Thing::Step(c, s) => step(&c.name.text, &s.name.text),
            Thing::Action(c, s, i) => action(&c.name.text, &s.name.text, i),
            Thing::Transition(c, n) => transition(&c.name.text, n),
        }
    }
}

/// All parts of charts that have ids, in the order of the text, with their places.
pub fn things(document: &Document) -> impl Iterator<Item = (Span, Thing<'_>)> {
    document.charts().flat_map(|c| {
        let steps = c.steps().flat_map(move |s| {
            let own = std::iter::once((s.at.0, Thing::Step(c, s)));
            own.chain(s.actions.iter().enumerate().map(move |(i, a)| (a.at.0, Thing::Action(c, s, i))))
        });
        let transitions = c.transitions().enumerate().map(move |(n, t)| (t.at.0, Thing::Transition(c, n)));
        steps.chain(transitions)
    })
}

/// The innermost part that contains a place.
pub fn at(document: &Document, place: Span) -> Option<Thing<'_>> {
    let chart = document.charts().find(|c| holds(c.at.0, place))?;
    let only = |c: &Chart| std::ptr::eq(c, chart);
    things(document)
        .filter(|(at, thing)| {
            let mine = match thing {
                Thing::Step(c, _) | Thing::Action(c, ..) | Thing::Transition(c, _) => only(c),
            };
            mine && holds(*at, place)
        })
        .min_by_key(|(at, _)| at.end - at.start)
        .map(|(_, thing)| thing)
}

/// True if a place lies inside another.
pub fn holds(outer: Span, inner: Span) -> bool {
    outer.file == inner.file && outer.start <= inner.start && inner.end <= outer.end
}
