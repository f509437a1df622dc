//! The measures that several symbols share, and how each quotes a comment and tells the room it needs.
//!
//! The files of the symbols use this one; it uses none of them. All lengths are in hundredths of u.

use crate::text::{Line, wrap_words};
use crate::{Extent, Rect};

/// Side of a step's square.
pub(crate) const SQUARE: i32 = 500;
/// Half the length of a transition's bar.
pub(crate) const HALF_BAR: i32 = 220;
/// Distance between the two lines of a double line.
pub(crate) const DOUBLE_GAP: i32 = 50;
/// Text size of receptivities and names.
pub(crate) const TEXT: i32 = 140;
/// Text size of actions.
pub(crate) const ACTION_TEXT: i32 = 130;
/// Text size of comments, conditions and labels.
pub(crate) const SMALL: i32 = 120;

/// A comment in quotes, on at most `lines` lines; the flag says that nothing was left out.
pub(crate) fn quoted(comment: &str, most: i32, lines: usize) -> (Vec<Line>, bool) {
    let (lines, whole) = wrap_words(&format!("“{comment}”"), SMALL, most, lines);
    let closed = |l: String| if l.ends_with('…') { format!("{l}”") } else { l };
    (lines.into_iter().map(closed).map(Line::plain).collect(), whole)
}

/// How far the boxes reach from the anchor.
pub(crate) fn extent(areas: impl IntoIterator<Item = Rect>) -> Extent {
    let all = areas.into_iter().fold(Rect::default(), |a, b| a.union(&b));
    Extent { left: -all.x, right: all.x + all.w, up: -all.y, down: all.y + all.h }
}
