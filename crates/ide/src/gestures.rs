//! Gestures on a file: what they would change, and what they copy. They need the places of symbols,
//! which only the drawing knows.

use std::cell::RefCell;
use std::collections::HashMap;

use g7_draw::{Bends, Options};
use g7_edit::{Edit, Gesture, ItemId, Joined, Part, spliced};
use g7_model::{Document, LinkForm, Said, Span, say};
use g7_rig::Source;

use crate::file::{File, OWN};
use crate::ids;
use crate::undeclared::{Undeclared, undeclared};

/// The change that a gesture would make.
pub fn draft(file: &File, gesture: &Gesture) -> Result<Edit, Said> {
    let stand = standing(&file.source.document);
    let edit = g7_edit::apply_placed(&file.as_edited(), gesture, &stand)?;
    match gesture {
        Gesture::Bend { link, points } if !points.is_empty() => {
            let drawn = drawn(file, &edit, link)?;
            if drawn != Some(Bends::Followed) {
                return Err(say!("the link has no room there"));
            }
        }
        Gesture::LinkForm { link, form: Some(form) } => {
            let drawn = drawn(file, &edit, link)?.map_or(LinkForm::Jump, |_| LinkForm::Line);
            if drawn != form.form() {
                return Err(say!("no way is free for this link as a line"));
            }
        }
        _ => {}
    }
    Ok(edit)
}

/// How a link takes its bends as it is drawn after an edit; `None` if it is broken off.
fn drawn(file: &File, edit: &Edit, link: &ItemId) -> Result<Option<Bends>, Said> {
    let source;
    let document = match &edit.read {
        Some(read) => &read.document,
        None => {
            source = after(file, edit)?;
            &source.document
        }
    };
    let (Part::Link(from, to) | Part::Connector(from, to, _)) = &link.part else { return Ok(None) };
    let Some(chart) = document.charts().find(|c| *c.name.text == *link.chart) else { return Ok(None) };
    let end = |end: g7_draw::End| match end {
        g7_draw::End::Step(n) => {
            g7_edit::End::Step(chart.steps().nth(n as usize).map_or("", |s| &s.name.text).to_owned())
        }
        g7_draw::End::Transition(n) => g7_edit::End::Transition(n as usize),
    };
    let links = g7_draw::placed(document, chart, &Options::default()).links;
    Ok(links.into_iter().find(|l| (end(l.from), end(l.to)) == (from.clone(), to.clone())).map(|l| l.bends))
}

/// The steps that a deletion would join if it heals.
pub fn joins(file: &File, ids: &[ItemId]) -> Result<Vec<Joined>, Said> {
    Ok(g7_edit::joins(&file.as_edited(), ids)?)
}

/// A file as a gesture would leave it.
#[derive(Debug)]
pub struct After {
    /// The document.
    pub document: Document,
    /// The names that nothing declares, as far as the symbol of the gesture uses them.
    pub undeclared: Vec<Undeclared>,
}

/// The effect of a gesture; the file stays as it is.
pub fn foresee(file: &File, gesture: &Gesture) -> Result<After, Said> {
    let edit = draft(file, gesture)?;
    let source = after(file, &edit)?;
    let problems = g7_rig::testing::problems(&source, None).unwrap_or_default();
    let selected: Vec<String> = edit.select.iter().map(ItemId::to_string).collect();
    let mut undeclared = undeclared(&source.text, &source.document, &problems);
    let here = |at: &Span| ids::at(&source.document, *at).is_some_and(|t| selected.contains(&t.id()));
    undeclared.retain(|u| u.uses.iter().any(here));
    Ok(After { document: source.document, undeclared })
}

/// The file with a change.
fn after(file: &File, edit: &Edit) -> Result<Source, Said> {
    let text = spliced(file.text(), &edit.splices).ok_or_else(|| say!("the change does not fit the text"))?;
    Ok(Source::native(&file.source.name, text.into_bytes(), OWN.0).linked_like(&file.source))
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
