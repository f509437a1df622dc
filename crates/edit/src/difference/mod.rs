//! Finds the least change of the text that makes it say what the draft says.
//!
//! Parts that stay keep their text to the byte; new ones are printed by the printer of `g7-syntax`, the
//! only one there is.

mod chart;
mod file;
mod item;
mod lines;
mod list;
mod plant;

use std::collections::{BTreeMap, HashMap};

use g7_model::{Chart, ChartItem, Document, Item, Name, PlaceAt, Placed, Transition};

use crate::draft::{Draft, is_fresh};
use crate::splice::{Splice, tidied};
pub(crate) use lines::reindent;

use lines::Sheet;

/// The splices that turn the source text into the text of the draft.
pub(crate) fn difference(draft: &Draft<'_>) -> Vec<Splice> {
    let source = draft.source;
    let mut sheet = Sheet::new(source.text, &source.document.notes);
    file::write(&mut sheet, draft);
    tidied(source.text, sheet.splices)
}

/// Adapts what depends on other changes: chains whose parts were separated, places of deleted
/// parts, numbers of transitions.
pub(crate) fn settle(draft: &mut Draft<'_>) {
    let before = predecessors(draft.source.document);
    for item in &mut draft.doc.items {
        if let Item::Chart(chart) = item
            && !(is_fresh(chart.at) && draft.raw.contains_key(&chart.at.0.start))
        {
            unchain(chart, &before);
        }
    }
    settle_layouts(draft);
}

/// For each chained transition, the place of the transition that it continues.
#[inline(never)]
fn predecessors(doc: &Document) -> HashMap<u32, u32> {
    let mut before = HashMap::new();
    for chart in doc.charts() {
        for (a, b) in chart.items.iter().zip(chart.items.iter().skip(1)) {
            if let (ChartItem::Transition(a), ChartItem::Transition(b)) = (a, b)
                && b.chained
            {
                before.insert(b.at.0.start, a.at.0.start);
            }
        }
    }
    before
}

#[inline(never)]
fn unchain(chart: &mut Chart, before: &HashMap<u32, u32>) {
    let mut last: Option<(Vec<Name>, u32, bool)> = None;
    for item in &mut chart.items {
        let ChartItem::Transition(t) = item else {
            last = None;
            continue;
        };
        if t.chained {
            let goes_on = last.as_ref().is_some_and(|(to, start, fresh)| {
                !fresh && before.get(&t.at.0.start) == Some(start) && *to == t.from && t.label.is_none()
            });
            t.chained = goes_on && !is_fresh(t.at);
        }
        last = Some((t.to.clone(), t.at.0.start, is_fresh(t.at)));
    }
}

/// Deletes the places of deleted parts and renumbers transitions.
#[inline(never)]
fn settle_layouts(draft: &mut Draft<'_>) {
    let settled: Vec<Option<Vec<PlaceAt>>> =
        draft.doc.items.iter().map(|item| settled(draft, item)).collect();
    for (item, places) in draft.doc.items.iter_mut().zip(settled) {
        if let (Item::Layout(layout), Some(places)) = (item, places) {
            layout.places = places;
        }
    }
}

/// The places that a layout has after a gesture; `None` for what stays as it is.
#[inline(never)]
fn settled(draft: &Draft<'_>, item: &Item) -> Option<Vec<PlaceAt>> {
    let Item::Layout(layout) = item else { return None };
    if is_fresh(layout.at) {
        return None;
    }
    let now = draft.doc.charts().find(|c| c.name.text == layout.chart.text)?;
    let then = draft.source.document.charts().find(|c| c.name.text == layout.chart.text)?;
    let numbers: BTreeMap<(u32, u32), usize> =
        now.transitions().enumerate().map(|(n, t)| (key(t), n)).collect();
    let number = |t: Option<&Transition>| t.and_then(|t| numbers.get(&key(t)).copied());
    let stays = |symbol: &mut Placed, fresh: bool| match symbol {
        Placed::Step(name) => now.steps().any(|s| s.name == *name) || !then.steps().any(|s| s.name == *name),
        Placed::TransitionNumber(n) if !fresh => {
            let t = then.transitions().nth(*n as usize);
            match (t, number(t)) {
                (None, _) => true,
                (Some(_), None) => false,
                (Some(_), Some(k)) => {
                    *n = u32::try_from(k).unwrap_or(u32::MAX);
                    true
                }
            }
        }
        Placed::Transition(label) => {
            let has = |c: &Chart| c.transitions().any(|t| t.label.as_ref() == Some(label));
            has(now) || !has(then)
        }
        _ => true,
    };
    let mut places = layout.places.clone();
    places.retain_mut(|p| {
        let fresh = is_fresh(p.at);
        let was = joined(then, &p.what);
        // Both ends take their new numbers, even where one is gone.
        let gone = p.what.symbols_mut().map(|symbol| stays(symbol, fresh)).filter(|stays| !stays).count();
        gone == 0 && (!was || joined(now, &p.what))
    });
    Some(places)
}

/// True if an entry of a layout names a link that the chart has.
fn joined(chart: &Chart, entry: &Placed) -> bool {
    let (Placed::Link(ends) | Placed::LinkForm(ends, _)) = entry else { return false };
    let (step, symbol, leaving) = match &**ends {
        (Placed::Step(step), transition) => (step, transition, true),
        (transition, Placed::Step(step)) => (step, transition, false),
        _ => return false,
    };
    let transition = match symbol {
        Placed::Transition(label) => chart.transitions().find(|t| t.label.as_ref() == Some(label)),
        Placed::TransitionNumber(n) => chart.transitions().nth(*n as usize),
        _ => None,
    };
    transition.is_some_and(|t| if leaving { t.from.contains(step) } else { t.to.contains(step) })
}

fn key(t: &Transition) -> (u32, u32) {
    (t.at.0.file.0, t.at.0.start)
}
