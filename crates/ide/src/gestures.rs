//! Gestures on a file: what they would change, and what they copy. They need the places of symbols,
//! which only the drawing knows.

use std::cell::RefCell;
use std::collections::HashMap;

use g7_draw::{Options, Part};
use g7_edit::{Edit, Gesture, ItemId};
use g7_model::Document;

use crate::file::File;

/// The change that a gesture would make.
pub fn draft(file: &File, gesture: &Gesture) -> Result<Edit, String> {
    let stand = standing(&file.source.document);
    g7_edit::apply_placed(&file.as_edited(), gesture, &stand).map_err(|e| e.to_string())
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
    let names: Vec<&str> = chart.steps().map(|s| &*s.name.text).collect();
    let name = &*chart.name.text;
    let drawing = g7_draw::draw(document, chart, &Options::default());
    let anchor = |item: &g7_draw::Item| match item.part {
        Part::Step { step, square } => {
            let id = ItemId::step(name, *names.get(step as usize)?);
            Some((id, (square.x + square.w / 2, square.y)))
        }
        Part::Transition { transition, bar, .. } => {
            let id = ItemId::transition(name, transition as usize);
            Some((id, (bar.x + bar.w / 2, bar.y + bar.h / 2)))
        }
        Part::Comment { comment, place } => Some((ItemId::note(name, comment as usize), (place.x, place.y))),
        Part::Action { .. } | Part::Link { .. } | Part::Connector { .. } | Part::Text => None,
    };
    drawing.items.iter().filter_map(anchor).collect()
}
