//! Connectors of broken links (an arrow and the name of the other end), and arrows on links.

use crate::ink::Picture;
use crate::symbols::parts::SMALL;
use crate::text::{clean, shortened, width};
use crate::{Point, Rect};

/// Greatest width of a name in a connector.
const WIDEST: i32 = 1600;

/// The text of a connector that names a step, with its page if there are several.
pub(crate) fn connector_label(name: &str, page: Option<u32>) -> String {
    let (name, _) = shortened(&clean(name), SMALL, WIDEST);
    match page {
        Some(page) => format!("{name} (p. {page})"),
        None => name,
    }
}

/// The width of a connector with this label.
pub(crate) fn connector_width(label: &str) -> i32 {
    width(label, SMALL)
}

/// Draws the text of a connector in its box.
pub(crate) fn connector(p: &mut Picture, text: Rect, label: &str) {
    let y = text.y + text.h / 2 + SMALL * 35 / 100;
    p.text("g7-ref", text.x, y, SMALL, label);
}

/// Draws an arrow head with its tip at a point.
pub(crate) fn arrow(p: &mut Picture, tip: Point, (dx, dy): (i8, i8)) {
    let (dx, dy) = (i32::from(dx), i32::from(dy));
    let (bx, by) = (tip.x - 120 * dx, tip.y - 120 * dy);
    let (sx, sy) = (-dy * 44, dx * 44);
    p.shape("g7-mark", &[(tip.x, tip.y), (bx + sx, by + sy), (bx - sx, by - sy)]);
}
