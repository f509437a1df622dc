//! The pages of a PL7 drawing: eight, each of 14 lines and 11 columns.
//!
//! One column of the layout is as wide as the distance of two branches. Two lines (a step and the
//! transition under it) are as high as the distance of two steps. Pages follow one another
//! downward.

use g7_model::{Document, Item, Problem, Said, codes, say};

/// Distance of two branches and of two steps, in hundredths of the drawing's unit.
const PITCH: i32 = 1300;
/// Columns of a page.
const COLUMNS: i32 = 11;
/// Number of pages, and of lines with steps on each. The first and the last of the 14 lines hold
/// connectors, the others hold steps and transitions in turn.
const PAGES: i32 = 8;
const STEP_LINES: i32 = 6;

/// Reports the first symbol of each layout that stands beyond the last page; `plc` is the name of the
/// target.
#[inline(never)]
pub(super) fn check(doc: &Document, plc: &Said, problems: &mut Vec<Problem>) {
    for item in &doc.items {
        let Item::Layout(layout) = item else { continue };
        let placed = layout.places.iter().filter(|p| p.what.is_symbol());
        let places: Vec<_> = placed.collect();
        let (Some(left), Some(top)) = (places.iter().map(|p| p.x).min(), places.iter().map(|p| p.y).min())
        else {
            continue;
        };
        let beyond = places.iter().find(|p| {
            let column = i64::from(p.x) - i64::from(left);
            let line = i64::from(p.y) - i64::from(top);
            column >= i64::from(PITCH * COLUMNS) || line >= i64::from(PITCH * STEP_LINES * PAGES)
        });
        if let Some(first) = beyond {
            let what = say!(
                "the drawing of `{}` does not fit: a {plc} has {PAGES} pages of 14 lines and {COLUMNS} columns",
                layout.chart.text
            );
            problems
                .push(Problem::new(&codes::TARGET_PAGES, first.at.0, what).help(say!(
                    "move it nearer, or leave the layout out: the chart is then drawn by itself"
                )));
        }
    }
}
