//! Holds the symbols of a chart that is drawn by hand where they are: what a gesture leaves alone gets the place at
//! which it was drawn. Without it the symbols that have no place yet would go where their neighbours are taken, or
//! to the places of the automatic layout.
//!
//! It runs behind the gesture itself, when the numbers of transitions are final.

use std::collections::{BTreeMap, BTreeSet};

use g7_model::{Chart, Layout, PlaceAt, Placed, Span};

use super::layout_section::{layout, with_layout};
use crate::draft::Draft;
use crate::id::ItemId;

/// Gives a place to each symbol that has none, in charts that are drawn by hand, before the gesture or behind it.
#[inline(never)]
pub(crate) fn hold(d: &mut Draft<'_>) {
    let source = d.source.document;
    for then in source.charts() {
        let name = &*then.name.text;
        let Some(now) = d.doc.charts().find(|c| c.name == then.name) else { continue };
        let (old, new) = (layout(source, name), layout(&d.doc, name));
        let Some(new) = new.filter(|l| (now, Some(*l)) != (then, old)) else { continue };
        let placed = Placements::new(now, new);
        let by_hand = placed.by_hand() || old.is_some_and(|l| Placements::new(then, l).by_hand());
        if placed.is_empty() || !by_hand {
            continue;
        }
        let found = placed.missing(then, d);
        let places: Vec<PlaceAt> = found
            .into_iter()
            .map(|(what, (x, y))| PlaceAt { what, x, y, then: Vec::new(), at: d.fresh() })
            .collect();
        if !places.is_empty() {
            with_layout(d, name, |l| l.places.extend(places));
        }
    }
}

/// The symbols of a chart that have a place in its layout section.
struct Placements<'a> {
    chart: &'a Chart,
    steps: BTreeSet<&'a str>,
    transitions: BTreeSet<usize>,
}

impl<'a> Placements<'a> {
    fn new(chart: &'a Chart, layout: &'a Layout) -> Placements<'a> {
        let mut placed = Placements { chart, steps: BTreeSet::new(), transitions: BTreeSet::new() };
        let labels: BTreeMap<&str, usize> =
            (0..).zip(chart.transitions()).filter_map(|(n, t)| Some((&*t.label.as_ref()?.text, n))).collect();
        let steps: BTreeSet<&str> = chart.steps().map(|s| &*s.name.text).collect();
        let count = chart.transitions().count();
        for p in &layout.places {
            match &p.what {
                Placed::Step(name) => placed.steps.extend(steps.get(&*name.text)),
                Placed::Transition(label) => placed.transitions.extend(labels.get(&*label.text)),
                Placed::TransitionNumber(n) => {
                    placed.transitions.extend(Some(*n as usize).filter(|n| *n < count))
                }
                _ => {}
            }
        }
        placed
    }

    fn is_empty(&self) -> bool {
        self.steps.is_empty() && self.transitions.is_empty()
    }

    fn by_hand(&self) -> bool {
        let symbols = self.chart.steps().count() + self.chart.transitions().count();
        Layout::is_by_hand(self.steps.len() + self.transitions.len(), symbols)
    }

    /// The symbols without a place that were drawn before the gesture, with the places at which they stood.
    fn missing(&self, then: &Chart, d: &Draft<'_>) -> Vec<(Placed, (i32, i32))> {
        let name = &*then.name.text;
        let before: BTreeSet<&str> = then.steps().map(|s| &*s.name.text).collect();
        let numbers: BTreeMap<Span, usize> = then.transitions().map(|t| t.at.0).zip(0..).collect();
        let steps = self.chart.steps().filter(|s| before.contains(&*s.name.text));
        let steps = steps.filter(|s| !self.steps.contains(&*s.name.text));
        let steps = steps.filter_map(|s| {
            let at = (d.anchors)(&ItemId::step(name, &*s.name.text))?;
            Some((Placed::Step(s.name.clone()), at))
        });
        let transitions = self.chart.transitions().enumerate().filter(|(n, _)| !self.transitions.contains(n));
        let transitions = transitions.filter_map(|(n, t)| {
            let at = (d.anchors)(&ItemId::transition(name, *numbers.get(&t.at.0)?))?;
            let what = match &t.label {
                Some(label) => Placed::Transition(label.clone()),
                None => Placed::TransitionNumber(u32::try_from(n).unwrap_or(u32::MAX)),
            };
            Some((what, at))
        });
        steps.chain(transitions).collect()
    }
}
