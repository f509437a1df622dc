//! Points and boxes of a drawing, in integer hundredths of the drawing unit u.
//!
//! The layout section of a file uses the same unit: a step is 5 u wide. Integers make a drawing
//! identical on every machine.

/// One drawing unit u.
pub const U: i32 = 100;

/// A point: x grows to the right, y grows downward.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Point {
    /// Distance to the right of the origin.
    pub x: i32,
    /// Distance below the origin.
    pub y: i32,
}

impl From<(i32, i32)> for Point {
    fn from((x, y): (i32, i32)) -> Point {
        Point { x, y }
    }
}

impl Point {
    /// The vector that leads here from another point.
    #[must_use]
    pub fn minus(self, other: Point) -> Point {
        Point { x: self.x - other.x, y: self.y - other.y }
    }
}

/// An axis-parallel box.
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

/// How far a symbol with its texts reaches from its anchor; no field is negative. The anchor of a
/// step is the middle of the upper edge of its square, the anchor of a transition is the middle of
/// its bar.
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
    /// The box that an extent covers round an anchor.
    pub fn around(at: Point, e: Extent) -> Rect {
        Rect { x: at.x - e.left, y: at.y - e.up, w: e.left + e.right, h: e.up + e.down }
    }

    /// True if this box is another one moved by a vector.
    pub fn is_moved_from(&self, other: &Rect, by: Point) -> bool {
        (self.x - other.x, self.y - other.y, self.w, self.h) == (by.x, by.y, other.w, other.h)
    }

    /// True if the interiors of the two boxes have a point in common.
    pub fn overlaps(&self, o: &Rect) -> bool {
        self.x < o.x + o.w && o.x < self.x + self.w && self.y < o.y + o.h && o.y < self.y + self.h
    }

    /// The smallest box that holds both boxes.
    #[must_use]
    pub fn union(&self, o: &Rect) -> Rect {
        let (x, y) = (self.x.min(o.x), self.y.min(o.y));
        let (right, low) = ((self.x + self.w).max(o.x + o.w), (self.y + self.h).max(o.y + o.h));
        Rect { x, y, w: right - x, h: low - y }
    }
}
