//! Access to the layout section of a chart, and its unit of length.

use g7_model::{Document, Item, Layout, PlaceAt, Placed, say};

use crate::change::{Refusal, refuse};
use crate::draft::Draft;

/// Greatest coordinate, in hundredths of a unit.
pub(crate) const FARTHEST: i64 = 100_000_000;

/// Converts pixels to hundredths of a unit.
pub(crate) fn point([x, y]: [f64; 2]) -> Result<(i32, i32), Refusal> {
    Ok((hundredths(x)?, hundredths(y)?))
}

fn hundredths(px: f64) -> Result<i32, Refusal> {
    let n = (px * 10.0).round();
    if n.is_nan() || n.abs() > FARTHEST as f64 {
        return refuse(say!("this place is too far away"));
    }
    #[allow(clippy::cast_possible_truncation, reason = "bounded just above")]
    let n = n as i64;
    i32::try_from(n).or_else(|_| refuse(say!("this place is too far away")))
}

/// The layout section of a chart; the first one if there are several, as in the drawing.
pub(crate) fn layout<'d>(doc: &'d Document, chart: &str) -> Option<&'d Layout> {
    doc.items.iter().find_map(|i| match i {
        Item::Layout(l) if *l.chart.text == *chart => Some(l),
        _ => None,
    })
}

/// Deletes layout sections of a chart that place nothing.
pub(crate) fn without_empty_layout(d: &mut Draft<'_>, chart: &str) {
    let empty = |l: &Layout| *l.chart.text == *chart && l.places.is_empty();
    d.doc.items.retain(|i| !matches!(i, Item::Layout(l) if empty(l)));
}

/// Puts an entry with its points in the place of those of its kind, or takes these out. `own` tells which are of its kind.
pub(crate) fn set(
    d: &mut Draft<'_>,
    chart: &str,
    own: impl Fn(&Placed) -> bool,
    entry: Option<(Placed, Vec<(i32, i32)>)>,
) {
    let at = d.fresh();
    let there = layout(&d.doc, chart).is_some_and(|l| l.places.iter().any(|p| own(&p.what)));
    let first = |(what, points): (Placed, Vec<(i32, i32)>)| {
        let (&(x, y), then) = points.split_first()?;
        Some(PlaceAt { what, x, y, then: then.to_vec(), at })
    };
    let entry = entry.and_then(first);
    if entry.is_none() && !there {
        return;
    }
    with_layout(d, chart, |layout| {
        let Some(entry) = entry else {
            layout.places.retain(|p| !own(&p.what));
            return;
        };
        match layout.places.iter_mut().find(|p| own(&p.what)) {
            Some(there) => *there = PlaceAt { at: there.at, ..entry },
            None => layout.places.push(entry),
        }
    });
    without_empty_layout(d, chart);
}

/// Changes the layout section of a chart; if there is none, adds one at the end of the file.
pub(crate) fn with_layout(d: &mut Draft<'_>, chart: &str, change: impl FnOnce(&mut Layout)) {
    let own = |i: &Item| matches!(i, Item::Layout(l) if *l.chart.text == *chart);
    if !d.doc.items.iter().any(own) {
        let layout = Layout { chart: d.new_name(chart), places: Vec::new(), at: d.fresh() };
        d.doc.items.push(Item::Layout(layout));
    }
    if let Some(Item::Layout(layout)) = d.doc.items.iter_mut().find(|i| own(i)) {
        change(layout);
    }
}
