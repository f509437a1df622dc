//! Where the links lie that are drawn already, so that a link to another target does not lie on one of them.
//!
//! `way.rs` asks for each way that it tries. A long sequence has all its links in one column: pieces are kept by the
//! part of their column or row, so that a question looks at those nearby.

use std::collections::HashMap;

use crate::Point;

/// Length of a part of a column or row.
const PART: i32 = 2000;
/// A piece of a link with more parts than this is kept by its column or row alone.
const MOST_PARTS: i32 = 400;

/// A piece of a link: from where to where, and the ends of the link.
#[derive(Debug, Clone, Copy)]
struct Piece {
    low: i32,
    high: i32,
    ends: [u32; 2],
}

/// A column (`true`) or row, and its place.
type Line = (bool, i32);

impl Piece {
    /// The piece between two corners, with its column or row.
    fn of(a: Point, b: Point, ends: [u32; 2]) -> (Line, Piece) {
        let upright = a.x == b.x;
        let (at, a, b) = if upright { (a.x, a.y, b.y) } else { (a.y, a.x, b.x) };
        ((upright, at), Piece { low: a.min(b), high: a.max(b), ends })
    }

    fn parts(&self) -> std::ops::RangeInclusive<i32> {
        self.low.div_euclid(PART)..=self.high.div_euclid(PART)
    }

    /// True if links that have no end in common lie on one another.
    fn lies_on(&self, other: &Piece) -> bool {
        let apart = self.ends[0] != other.ends[0] && self.ends[1] != other.ends[1];
        apart && self.low.max(other.low) < self.high.min(other.high)
    }
}

/// The links that are drawn.
#[derive(Debug, Default)]
pub(crate) struct Lines {
    parts: HashMap<(Line, i32), Vec<Piece>>,
    long: HashMap<Line, Vec<Piece>>,
}

impl Lines {
    /// Draws a link.
    pub(crate) fn draw(&mut self, points: &[Point], ends: [u32; 2]) {
        for w in points.windows(2) {
            let (line, piece) = Piece::of(w[0], w[1], ends);
            let parts = piece.parts();
            if parts.end() - parts.start() > MOST_PARTS {
                self.long.entry(line).or_default().push(piece);
            } else {
                parts.for_each(|part| self.parts.entry((line, part)).or_default().push(piece));
            }
        }
    }

    /// The number of pieces of a way that lie on another link.
    pub(crate) fn shared(&self, points: &[Point], ends: [u32; 2]) -> usize {
        let is_shared = |w: &&[Point]| {
            let (line, piece) = Piece::of(w[0], w[1], ends);
            let lies =
                |on: Option<&Vec<Piece>>| on.is_some_and(|p| p.iter().any(|other| piece.lies_on(other)));
            lies(self.long.get(&line)) || piece.parts().any(|part| lies(self.parts.get(&(line, part))))
        };
        points.windows(2).filter(is_shared).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(x: i32, low: i32, high: i32) -> [Point; 2] {
        [Point { x, y: low }, Point { x, y: high }]
    }

    #[test]
    fn pieces_of_any_length_are_found() {
        for (low, high) in [(0, 10), (1990, 2010), (-5000, 9000), (-9_000_000, 9_000_000)] {
            let mut lines = Lines::default();
            lines.draw(&column(7, low, high), [1, 2]);
            assert_eq!(lines.shared(&column(7, high - 5, high + 5), [3, 4]), 1, "{low} to {high}");
            assert_eq!(lines.shared(&column(7, low - 20_000_000, high), [3, 4]), 1, "{low} to {high}");
            assert_eq!(lines.shared(&column(7, high, high + 5), [3, 4]), 0, "they only touch");
            assert_eq!(lines.shared(&column(8, low, high), [3, 4]), 0, "it is another column");
            assert_eq!(lines.shared(&column(7, low, high), [1, 4]), 0, "they have the same source");
        }
    }
}
