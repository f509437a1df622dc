//! Ids of items, shared by the page and this crate: `Chart/s/Step`, `Chart/a/Step/0`, `Chart/t/3`;
//! and the item at a place of the text.

use g7_edit::ItemId;
use g7_model::{Chart, ChartItem, Document, Span, Step};

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

/// The innermost part that contains a place. The page calls this for each problem of a chart, so it is a binary
/// search: the parts stand in the order of the text.
pub fn at(document: &Document, place: Span) -> Option<Thing<'_>> {
    let chart = document.charts().find(|c| c.at.0.holds(place))?;
    let behind = chart.items.partition_point(|item| item.at().start <= place.start);
    let found = chart.items.get(..behind)?.last().filter(|item| item.at().holds(place))?;
    match found {
        ChartItem::Step(s) => {
            let action = s.actions.iter().position(|a| a.at.0.holds(place));
            Some(action.map_or(Thing::Step(chart, s), |i| Thing::Action(chart, s, i)))
        }
        ChartItem::Transition(t) => {
            Some(Thing::Transition(chart, chart.transitions().position(|other| std::ptr::eq(other, t))?))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Charts with chains, transitions on one line, actions, and what has no id between them.
    const TEXT: &str = "input a, b : BOOL\noutput V : BOOL\n\
        chart A {\n  var n : INT\n  initial step 0 { N V  P1 n := n + 1 }\n  0 -> 1 when a -> 2 when b -> 0 when a\n\
        \x20 step 1  step 2 { S V }  1 -> 2 when b  2 -> (1, 3) when 1\n  action again := { n := 0; }\n  step 3 { again }\n}\n\
        chart B { initial step 0  0 -> 0 when not a }\n";

    #[test]
    fn the_innermost_part_is_found_at_each_place() {
        let document = g7_syntax::parse(TEXT, g7_model::FileId(0)).0;
        assert!(document.charts().count() == 2);
        let mut found = std::collections::BTreeSet::new();
        for start in 0..TEXT.len() as u32 {
            for end in [start, start + 1, start + 6] {
                let place = Span { file: g7_model::FileId(0), start, end };
                let inside = things(&document).filter(|(at, _)| at.holds(place));
                let want = inside.min_by_key(|(at, _)| at.end - at.start).map(|(_, thing)| thing.id());
                let got = at(&document, place).map(Thing::id);
                assert_eq!(got, want, "{:?}", TEXT.get(start as usize..end as usize));
                found.extend(got);
            }
        }
        assert_eq!(found.len(), things(&document).count(), "{found:?}");
    }
}
