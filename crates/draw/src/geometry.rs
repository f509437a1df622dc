//! Points and boxes of a drawing, in whole hundredths of the drawing's unit u.
//!
//! The grid is that of the layout section of a file: a step is 5 u wide. Whole
//! numbers make a drawing the same on every machine.

/// One unit u of the drawing.
pub const U: i32 = 100;

/// A place: x to the right, y downward.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Point {
    /// To the right.
    pub x: i32,
    /// Downward.
    pub y: i32,
}

/// A box.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Rect {
    /// Left edge.
    pub x: i32,
    /// Upper edge.
    pub y: i32,
    /// Width, not negative.
    pub w: i32,
    /// Height, not negative.
    pub h: i32,
}

/// How far a symbol with its texts reaches from its anchor. The anchor of a step
/// is the middle of the upper edge of its square, that of a transition the
/// middle of its bar. None is negative.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Extent {
    /// To the left.
    pub left: i32,
    /// To the right.
    pub right: i32,
    /// Upward.
    pub up: i32,
    /// Downward.
    pub down: i32,
}

impl Rect {
    /// The box of an extent round its anchor.
    pub fn around(at: Point, e: Extent) -> Rect {
        Rect { x: at.x - e.left, y: at.y - e.up, w: e.left + e.right, h: e.up + e.down }
    }

    /// Whether the insides of two boxes have a point in common.
    pub fn overlaps(&self, o: &Rect) -> bool {
        self.x < o.x + o.w && o.x < self.x + self.w && self.y < o.y + o.h && o.y < self.y + self.h
    }

    /// The smallest box with both in it.
    #[must_use]
    pub fn union(&self, o: &Rect) -> Rect {
        let (x, y) = (self.x.min(o.x), self.y.min(o.y));
        let (right, low) = ((self.x + self.w).max(o.x + o.w), (self.y + self.h).max(o.y + o.h));
        Rect { x, y, w: right - x, h: low - y }
    }
}
