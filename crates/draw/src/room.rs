//! Places from a drawing program with other symbols than ours, given room.
//!
//! ```text
//! importer -> model::Document with layouts -> here -> text
//! ```
//!
//! What must hold afterwards: no symbol or text stands on another because of a layout.

use g7_model::{Chart, Document, Item, PlaceAt};

use crate::{Options, Rect, Sizes, layout, measure};

/// By how much places are drawn apart, in percent, in the order of trial.
const APART: [i32; 4] = [100, 125, 150, 200];

/// Draws the places of each layout apart until all symbols stand clear; a
/// layout that does not come clear is left out, so the chart is laid out anew.
pub fn make_room(document: &mut Document) {
    let roomy: Vec<Option<Vec<PlaceAt>>> = document
        .items
        .iter()
        .map(|item| match item {
            Item::Layout(l) => {
                let chart = document.charts().find(|c| c.name == l.chart)?;
                with_room(document, chart, &l.places)
            }
            _ => None,
        })
        .collect();
    let mut roomy = roomy.into_iter();
    document.items.retain_mut(|item| {
        let places = roomy.next().flatten();
        match (item, places) {
            (Item::Layout(l), Some(places)) => {
                l.places = places;
                true
            }
            (Item::Layout(_), None) => false,
            _ => true,
        }
    });
}

fn with_room(document: &Document, chart: &Chart, places: &[PlaceAt]) -> Option<Vec<PlaceAt>> {
    let sizes = measure(document, chart, &Options::default());
    APART.iter().find_map(|percent| {
        let mut apart = places.to_vec();
        for p in &mut apart {
            p.x = scaled(p.x, *percent);
            p.y = scaled(p.y, *percent);
        }
        is_clear(chart, &sizes, &apart).then_some(apart)
    })
}

fn scaled(at: i32, percent: i32) -> i32 {
    i32::try_from(i64::from(at) * i64::from(percent) / 100).unwrap_or(at)
}

/// Whether no symbol with its texts touches another.
fn is_clear(chart: &Chart, sizes: &Sizes, places: &[PlaceAt]) -> bool {
    let placed = layout(chart, sizes, places);
    let steps = placed.steps.iter().zip(&sizes.steps);
    let transitions = placed.transitions.iter().zip(&sizes.transitions);
    let mut boxes: Vec<Rect> = steps.chain(transitions).map(|(at, e)| Rect::around(*at, *e)).collect();
    boxes.sort_by_key(|r| r.y);
    boxes
        .iter()
        .enumerate()
        .all(|(n, r)| boxes.iter().skip(n + 1).take_while(|o| o.y < r.y + r.h).all(|o| !r.overlaps(o)))
}

#[cfg(test)]
mod tests {
    use g7_model::{Document, FileId, Item};

    use super::make_room;

    fn document(places: &str) -> Document {
        let text = format!(
            "input a : BOOL\nchart G {{ initial step 0 step 1 0 -> 1 when a }}\nlayout G {{ {places} }}\n"
        );
        let (document, problems) = g7_syntax::parse(&text, FileId(0));
        assert!(problems.is_empty(), "{problems:?}");
        document
    }

    fn places(document: &Document) -> Option<Vec<(i32, i32)>> {
        document.items.iter().find_map(|i| match i {
            Item::Layout(l) => Some(l.places.iter().map(|p| (p.x, p.y)).collect()),
            _ => None,
        })
    }

    #[test]
    fn places_with_room_stay() {
        let mut roomy = document("step 0 at (10, 10) transition #0 at (10, 20) step 1 at (10, 30)");
        make_room(&mut roomy);
        assert_eq!(places(&roomy), Some(vec![(1000, 1000), (1000, 2000), (1000, 3000)]));
    }

    #[test]
    fn places_too_near_are_drawn_apart() {
        let mut near = document("step 0 at (10, 4) transition #0 at (30, 4) step 1 at (10, 8)");
        make_room(&mut near);
        let found = places(&near).expect("they come clear");
        assert!(found[2].1 - found[0].1 > 400, "{found:?}");
    }

    #[test]
    fn places_on_one_another_are_left_out() {
        let mut same = document("step 0 at (10, 10) transition #0 at (10, 30) step 1 at (10, 10)");
        make_room(&mut same);
        assert_eq!(places(&same), None);
    }
}
