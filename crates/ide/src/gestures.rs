//! Gestures on a file: what they would change, and what they copy. They need the places of symbols,
//! which only the drawing knows.

use std::cell::RefCell;
use std::collections::HashMap;

use g7_draw::Options;
use g7_edit::{Edit, Gesture, ItemId, Joined};
use g7_model::{Document, Said};

use crate::file::File;

/// The change that a gesture would make.
pub fn draft(file: &File, gesture: &Gesture) -> Result<Edit, Said> {
    let stand = standing(&file.source.document);
    Ok(g7_edit::apply_placed(&file.as_edited(), gesture, &stand)?)
}

/// The steps that a deletion would join if it heals.
pub fn joins(file: &File, ids: &[ItemId]) -> Result<Vec<Joined>, Said> {
    Ok(g7_edit::joins(&file.as_edited(), ids)?)
}

/// A part of a chart as text, with the places of its symbols.
pub fn copy(file: &File, ids: &[ItemId]) -> String {
    g7_edit::copy_placed(&file.as_edited(), ids, &standing(&file.source.document))
}

/// The places of symbols. A chart is drawn when the place of one of its symbols is asked for first.
fn standing(document: &Document) -> impl Fn(&ItemId) -> Option<(i32, i32)> {
    let placed = RefCell::new(HashMap::new());
    move |id: &ItemId| {
        let mut placed = placed.borrow_mut();
        let chart = placed.entry(id.chart.clone()).or_insert_with(|| anchors(document, &id.chart));
        chart.get(id).copied()
    }
}

/// The anchors of the symbols of a chart, in hundredths of u, by id.
fn anchors(document: &Document, chart: &str) -> HashMap<ItemId, (i32, i32)> {
    let Some(chart) = document.charts().find(|c| *c.name.text == *chart) else { return HashMap::new() };
    let name = &*chart.name.text;
    let placement = g7_draw::placed(document, chart, &Options::default());
    let steps = chart.steps().map(|s| ItemId::step(name, &*s.name.text)).zip(placement.steps);
    let transitions = (0..).map(|n| ItemId::transition(name, n)).zip(placement.transitions);
    let notes = g7_draw::comments(document, chart).map(|(_, at)| at);
    let notes = (0..).map(|n| ItemId::note(name, n)).zip(notes);
    // The anchor of a symbol is the point round which it is built.
    steps.chain(transitions).chain(notes).map(|(id, at)| (id, (at.x, at.y))).collect()
}
