//! A way from one place to another round the symbols between: a few simple
//! shapes are tried, the shortest that runs through nothing is taken.

use std::collections::HashMap;

use crate::layout::rooms::LINK;
use crate::layout::tree::NONE;
use crate::{Point, Rect};

/// Side of a cell of the map.
const CELL: i32 = 2000;
/// A line over more cells is compared with all symbols.
const MOST_CELLS: i64 = 400;
/// How often a column is pushed aside by a symbol in its way.
const PUSHES: usize = 24;
/// Between a line and the symbol it passes.
const BESIDE: i32 = 100;

/// The symbols in the way.
#[derive(Debug)]
pub(crate) struct Ways {
    boxes: Vec<(u32, Rect)>,
    cells: HashMap<(i32, i32), Vec<u32>>,
}

fn line(a: Point, b: Point) -> Rect {
    Rect { x: a.x.min(b.x), y: a.y.min(b.y), w: (a.x - b.x).abs().max(1), h: (a.y - b.y).abs().max(1) }
}

fn cells(r: &Rect) -> (std::ops::RangeInclusive<i32>, std::ops::RangeInclusive<i32>) {
    let span = |from: i32, size: i32| from.div_euclid(CELL)..=(from + size).div_euclid(CELL);
    (span(r.x, r.w), span(r.y, r.h))
}

impl Ways {
    /// A map of boxes with the node each belongs to; those of the nodes themselves
    /// come first and in their order.
    pub(crate) fn new(boxes: Vec<(u32, Rect)>) -> Ways {
        let mut map: HashMap<(i32, i32), Vec<u32>> = HashMap::new();
        for (n, (_, r)) in (0..).zip(&boxes) {
            let (xs, ys) = cells(r);
            for x in xs {
                ys.clone().for_each(|y| map.entry((x, y)).or_default().push(n));
            }
        }
        Ways { boxes, cells: map }
    }

    /// The symbols that a piece runs through, but for the two it belongs to.
    fn hits(&self, a: Point, b: Point, ends: [u32; 2], mut f: impl FnMut(u32)) {
        let piece = line(a, b);
        let (xs, ys) = cells(&piece);
        let count = (i64::from(*xs.end()) - i64::from(*xs.start()) + 1)
            * (i64::from(*ys.end()) - i64::from(*ys.start()) + 1);
        let mut look = |n: u32| {
            let (owner, r) = &self.boxes[n as usize];
            if !ends.contains(owner) && r.overlaps(&piece) {
                f(n);
            }
        };
        if count > MOST_CELLS {
            (0..self.boxes.len() as u32).for_each(look);
            return;
        }
        for x in xs {
            for y in ys.clone() {
                self.cells.get(&(x, y)).into_iter().flatten().copied().for_each(&mut look);
            }
        }
    }

    /// Whether a line runs through a symbol.
    pub(crate) fn blocked(&self, points: &[Point], from: u32, to: u32) -> bool {
        self.count(points, [from, to]) > 0
    }

    fn count(&self, points: &[Point], ends: [u32; 2]) -> usize {
        let mut count = 0;
        for (k, w) in points.windows(2).enumerate() {
            // Near its ends a link passes the texts of its own symbols.
            let own = if k > 1 && k + 3 < points.len() { [NONE; 2] } else { ends };
            self.hits(w[0], w[1], own, |_| count += 1);
        }
        count
    }

    /// The corners from `a`, left downward, to `b`, come to from above. `rows` are
    /// the heights at which other links part below `a` and meet above `b`.
    pub(crate) fn find(&self, a: Point, b: Point, rows: [Option<i32>; 2], from: u32, to: u32) -> Vec<Point> {
        let ends = [from, to];
        let mut tried: Vec<Vec<Point>> = Vec::new();
        if b.y > a.y {
            if a.x == b.x {
                tried.push(vec![a, b]);
            }
            let middle = (a.y + b.y) / 2;
            let between = |y: &i32| a.y <= *y && *y <= b.y;
            for y in rows.into_iter().flatten().filter(between).chain([middle]) {
                tried.push(vec![a, Point { x: a.x, y }, Point { x: b.x, y }, b]);
            }
            if let Some(free) = tried.iter().find(|p| self.count(p, ends) == 0) {
                return free.clone();
            }
        }
        let gap = if b.y > a.y { ((b.y - a.y) / 3).min(LINK) } else { LINK - 50 };
        let (y0, y1) = (rows[0].unwrap_or(a.y + gap), rows[1].unwrap_or(b.y - gap));
        for x in self.columns(y0, y1, ends) {
            let corner = |x, y| Point { x, y };
            tried.push(vec![a, corner(a.x, y0), corner(x, y0), corner(x, y1), corner(b.x, y1), b]);
        }
        let cost = |p: &Vec<Point>| {
            let length: i64 =
                p.windows(2).map(|w| i64::from((w[0].x - w[1].x).abs() + (w[0].y - w[1].y).abs())).sum();
            // What goes up does so at the left.
            let right = b.y <= a.y && p.get(2).is_some_and(|c| c.x > a.x.min(b.x));
            (self.count(p, ends), length + if right { 600 } else { 0 })
        };
        tried.into_iter().min_by_key(cost).unwrap_or_else(|| vec![a, b])
    }

    /// Columns beside the two ends, pushed aside by what stands in them.
    fn columns(&self, y0: i32, y1: i32, ends: [u32; 2]) -> Vec<i32> {
        let mut found = Vec::new();
        let boxes = ends.map(|n| self.boxes[n as usize].1);
        let left = boxes.iter().map(|r| r.x).min().unwrap_or(0) - LINK;
        let right = boxes.iter().map(|r| r.x + r.w).max().unwrap_or(0) + LINK;
        let starts = boxes.iter().flat_map(|r| [(r.x - LINK, -1), (r.x + r.w + LINK, 1)]);
        for (start, way) in starts.chain([(left, -1), (right, 1)]) {
            let mut x = start;
            for _ in 0..PUSHES {
                let mut next = x;
                self.hits(Point { x, y: y0 }, Point { x, y: y1 }, [NONE; 2], |n| {
                    let r = self.boxes[n as usize].1;
                    next = if way < 0 { next.min(r.x - BESIDE) } else { next.max(r.x + r.w + BESIDE) };
                });
                if next == x {
                    break;
                }
                x = next;
            }
            if !found.contains(&x) {
                found.push(x);
            }
        }
        found
    }
}
