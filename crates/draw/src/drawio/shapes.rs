//! A library of symbols for draw.io, made of the same strokes as every drawing.

use std::fmt::Write as _;

use g7_model::Document;

use super::cells::Cells;
use crate::draw::{Inked, inked};
use crate::ink::escape;
use crate::{Options, Part, Point};

/// The symbols of charts as a library for draw.io: each step with its actions, and each transition, is an entry whose
/// title is its comment, or else its name or receptivity.
pub fn shapes(document: &Document, options: &Options) -> String {
    let mut entries = Vec::new();
    for chart in document.charts() {
        let (placement, all) = inked(document, chart, options);
        let mut steps: Vec<Vec<Inked>> = chart.steps().map(|_| Vec::new()).collect();
        let mut transitions: Vec<Vec<Inked>> = chart.transitions().map(|_| Vec::new()).collect();
        // A step is painted behind its actions, which are parts of it.
        for symbol in all {
            let (list, first) = match symbol.part {
                Part::Step { step, .. } => (steps.get_mut(step as usize), true),
                Part::Action { step, .. } => (steps.get_mut(step as usize), false),
                Part::Transition { transition, .. } => (transitions.get_mut(transition as usize), false),
                Part::Link { .. } | Part::Connector { .. } | Part::Comment { .. } | Part::Text => {
                    (None, false)
                }
            };
            match list {
                Some(list) if first => list.insert(0, symbol),
                Some(list) => list.push(symbol),
                None => {}
            }
        }
        let steps = chart.steps().map(|s| s.comment.as_deref().unwrap_or(&s.name.text)).zip(steps);
        let titles = chart.transitions().map(|t| t.comment.as_deref().unwrap_or("transition"));
        for (title, list) in steps.chain(titles.zip(transitions)) {
            let areas = list.iter().filter_map(|i| i.picture.area());
            let area = areas.reduce(|a, b| a.union(&b)).unwrap_or_default();
            let mut cells = Cells::new(options.dark);
            list.into_iter().for_each(|s| cells.add(s, &placement, Point { x: -area.x, y: -area.y }));
            entries.push(entry(title, &cells, [area.w, area.h]));
        }
    }
    format!("<mxlibrary>{}</mxlibrary>\n", escape(&format!("[{}]", entries.join(","))))
}

/// An entry, as JSON.
fn entry(title: &str, cells: &Cells, size: [i32; 2]) -> String {
    let xml = cells.model(size);
    let [w, h] = size.map(|n| n / 10 + 1);
    format!("{{\"xml\":{},\"w\":{w},\"h\":{h},\"aspect\":\"fixed\",\"title\":{}}}", json(&xml), json(title))
}

fn json(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.trim_end().chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            c if c.is_control() => {
                let _ = write!(out, "\\u{:04x}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}
