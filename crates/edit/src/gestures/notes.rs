//! Comments of the layout section: texts that belong to no symbol.

use std::collections::BTreeSet;

use g7_model::{Item, Layout, PlaceAt, Placed, say};

use super::layout_section::{self, point};
use crate::change::{Refusal, refuse};
use crate::draft::Draft;
use crate::id::ItemId;

/// Adds a comment at a place.
pub(crate) fn add(d: &mut Draft<'_>, chart: &str, text: &str, at: [f64; 2]) -> Result<(), Refusal> {
    d.chart(chart)?;
    let (x, y) = point(at)?;
    let text = text.trim();
    if text.is_empty() {
        return refuse(say!("a comment says something"));
    }
    put(d, chart, text, (x, y));
    Ok(())
}

/// The same, for a place given in hundredths of a unit.
pub(crate) fn put(d: &mut Draft<'_>, chart: &str, text: &str, (x, y): (i32, i32)) {
    let place = PlaceAt { what: Placed::Comment(text.into()), x, y, then: Vec::new(), at: d.fresh() };
    let mut number = 0;
    layout_section::with_layout(d, chart, |layout| {
        number = comments(layout).count();
        layout.places.push(place);
    });
    d.select(ItemId::note(chart, number));
}

/// Changes the text of a comment; no text deletes it.
pub(crate) fn change(d: &mut Draft<'_>, chart: &str, n: usize, text: Option<&str>) -> Result<(), Refusal> {
    let Some(text) = text else { return delete(d, chart, &BTreeSet::from([n])) };
    note_mut(d, chart, n)?.what = Placed::Comment(text.into());
    d.select(ItemId::note(chart, n));
    Ok(())
}

/// Moves a comment.
pub(crate) fn shift(d: &mut Draft<'_>, chart: &str, n: usize, (x, y): (i32, i32)) -> Result<(), Refusal> {
    let place = note_mut(d, chart, n)?;
    (place.x, place.y) = (x, y);
    Ok(())
}

/// The place of a comment.
pub(crate) fn at(d: &Draft<'_>, chart: &str, n: usize) -> Result<(i32, i32), Refusal> {
    let found = layout_section::layout(&d.doc, chart).and_then(|l| comments(l).nth(n));
    found.map(|p| (p.x, p.y)).ok_or_else(|| none(chart))
}

/// Deletes comments; an empty layout section is deleted too.
#[inline(never)]
pub(crate) fn delete(d: &mut Draft<'_>, chart: &str, gone: &BTreeSet<usize>) -> Result<(), Refusal> {
    let count = layout_section::layout(&d.doc, chart).map_or(0, |l| comments(l).count());
    if gone.last().is_some_and(|n| *n >= count) {
        return Err(none(chart));
    }
    layout_section::with_layout(d, chart, |layout| {
        let mut number = 0;
        layout.places.retain(|p| {
            let comment = matches!(p.what, Placed::Comment(_));
            let goes = comment && gone.contains(&number);
            number += usize::from(comment);
            !goes
        });
    });
    layout_section::without_empty_layout(d, chart);
    Ok(())
}

/// The comments of a layout section, in the order of the text; the drawing numbers them in this
/// order.
pub(crate) fn comments(layout: &Layout) -> impl Iterator<Item = &PlaceAt> {
    layout.places.iter().filter(|p| matches!(p.what, Placed::Comment(_)))
}

fn note_mut<'d>(d: &'d mut Draft<'_>, chart: &str, n: usize) -> Result<&'d mut PlaceAt, Refusal> {
    let mut layouts = d.doc.items.iter_mut().filter_map(|i| match i {
        Item::Layout(l) if *l.chart.text == *chart => Some(l),
        _ => None,
    });
    let found = layouts
        .next()
        .and_then(|l| l.places.iter_mut().filter(|p| matches!(p.what, Placed::Comment(_))).nth(n));
    found.ok_or_else(|| none(chart))
}

fn none(chart: &str) -> Refusal {
    Refusal::new(say!("the layout of chart `{chart}` does not have this comment"))
}
