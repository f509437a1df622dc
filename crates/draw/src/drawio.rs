//! Charts as draw.io files: each symbol a shape with its text, each link tied to the symbols at its ends, so that a
//! document can be edited where its other pictures are.
//!
//! ```text
//! draw (strokes at their places) -> cells (boxes, texts, lines) -> a page for each chart
//!                                                               -> a library of the standard's symbols
//! ```
//!
//! # Invariants
//!
//! - Sizes, places and colours are those of the picture: the colours are read in its style sheet.
//! - Each cell has a parent; what belongs to a step or a transition moves with it.
//!
//! The form is that of draw.io's `mxGraphModel` (uncompressed), and of its libraries, `mxlibrary`.

mod cells;
mod shapes;

use std::fmt::Write as _;

use g7_model::{Chart, Document};

use crate::draw::{Inked, inked};
use crate::ink::escape;
use crate::{Options, Part, Point};
use cells::Cells;

pub use shapes::shapes;

/// Margin round a chart, in hundredths of u.
const MARGIN: i32 = 400;

/// Several charts as one draw.io file, with a page for each.
pub fn drawio<'a>(
    document: &Document,
    charts: impl IntoIterator<Item = &'a Chart>,
    options: &Options,
) -> String {
    let mut out = String::from("<mxfile host=\"g7\">\n");
    for (number, chart) in charts.into_iter().enumerate() {
        let (placement, all) = inked(document, chart, options);
        let areas = all.iter().filter_map(|i| i.picture.area());
        let area = areas.fold(placement.area, |a, b| a.union(&b));
        let shift = Point { x: MARGIN - area.x, y: MARGIN - area.y };
        let mut cells = Cells::new(options.dark);
        // Actions are parts of their steps, which are painted behind them in a picture.
        let (actions, others): (Vec<Inked>, Vec<Inked>) =
            all.into_iter().partition(|i| matches!(i.part, Part::Action { .. }));
        for symbol in others.into_iter().chain(actions) {
            cells.add(symbol, &placement, shift);
        }
        let name = escape(&chart.name.text);
        let _ = writeln!(out, "  <diagram id=\"chart{number}\" name=\"{name}\">");
        out.push_str(&cells.model([area.w + 2 * MARGIN, area.h + 2 * MARGIN]));
        out.push_str("  </diagram>\n");
    }
    out.push_str("</mxfile>\n");
    out
}
