//! Finds a way from one place to another round the symbols between them: tries a few simple shapes
//! and takes the shortest that crosses nothing.

use std::collections::HashMap;

use crate::layout::lines::Lines;
use crate::layout::rooms::LINK;
use crate::{Point, Rect};

/// Side of a cell of the search grid.
const CELL: i32 = 2000;
/// A line over more cells than this is compared with all symbols.
const MOST_CELLS: i64 = 400;
/// How often a column is moved aside by a symbol in its way.
const PUSHES: usize = 24;
/// Distance between a line and the symbol that it passes.
const BESIDE: i32 = 100;
/// How far rows and columns are moved aside that would lie on another link.
const ROWS: [i32; 6] = [50, -50, 100, -100, 25, -25];
const COLUMNS: [i32; 4] = [100, -100, 200, -200];

/// The symbols that links must avoid, and the links that are drawn already.
#[derive(Debug)]
pub(crate) struct Ways {
    boxes: Vec<(u32, Rect)>,
    cells: HashMap<(i32, i32), Vec<u32>>,
    lines: Lines,
}

fn line(a: Point, b: Point) -> Rect {
    Rect { x: a.x.min(b.x), y: a.y.min(b.y), w: (a.x - b.x).abs().max(1), h: (a.y - b.y).abs().max(1) }
}

fn cells(r: &Rect) -> (std::ops::RangeInclusive<i32>, std::ops::RangeInclusive<i32>) {
    let span = |from: i32, size: i32| from.div_euclid(CELL)..=(from + size).div_euclid(CELL);
    (span(r.x, r.w), span(r.y, r.h))
}

impl Ways {
    /// A grid of boxes with the node that each belongs to; the boxes of the nodes themselves come
    /// first, in the order of the nodes.
    pub(crate) fn new(boxes: Vec<(u32, Rect)>) -> Ways {
        let mut map: HashMap<(i32, i32), Vec<u32>> = HashMap::new();
        for (n, (_, r)) in (0..).zip(&boxes) {
            let (xs, ys) = cells(r);
            for x in xs {
                ys.clone().for_each(|y| map.entry((x, y)).or_default().push(n));
            }
        }
        Ways { boxes, cells: map, lines: Lines::default() }
    }

    /// Links that are drawn later do not lie on this one.
    pub(crate) fn draw(&mut self, points: &[Point], from: u32, to: u32) {
        self.lines.draw(points, [from, to]);
    }

    /// Calls `f` for each symbol that a segment crosses, except the two symbols in `ends`.
    #[inline(never)]
    fn hits(&self, a: Point, b: Point, ends: Option<[u32; 2]>, mut f: impl FnMut(u32)) {
        let piece = line(a, b);
        let (xs, ys) = cells(&piece);
        let count = (i64::from(*xs.end()) - i64::from(*xs.start()) + 1)
            * (i64::from(*ys.end()) - i64::from(*ys.start()) + 1);
        let mut look = |n: u32| {
            let (owner, r) = &self.boxes[n as usize];
            if !ends.is_some_and(|ends| ends.contains(owner)) && r.overlaps(&piece) {
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

    /// True if a line crosses a symbol.
    pub(crate) fn blocked(&self, points: &[Point], from: u32, to: u32) -> bool {
        self.count(points, [from, to]) > 0
    }

    /// How often a line crosses a symbol, and lies on a link that has another start and another end.
    pub(crate) fn faults(&self, points: &[Point], from: u32, to: u32) -> usize {
        self.count(points, [from, to]) + self.lines.shared(points, [from, to])
    }

    fn count(&self, points: &[Point], ends: [u32; 2]) -> usize {
        let mut count = 0;
        for (k, w) in points.windows(2).enumerate() {
            // Only near its ends may a link pass the texts of its own symbols.
            let own = if k > 1 && k + 3 < points.len() { None } else { Some(ends) };
            self.hits(w[0], w[1], own, |_| count += 1);
        }
        count
    }

    /// The corners of a line from `a`, which it leaves downward, to `b`, which it enters from
    /// above. `rows` are the heights at which other links part below `a` and meet above `b`.
    #[inline(never)]
    pub(crate) fn find(&self, a: Point, b: Point, rows: [Option<i32>; 2], from: u32, to: u32) -> Vec<Point> {
        let ends = [from, to];
        let mut tried: Vec<Vec<Point>> = Vec::new();
        if b.y > a.y {
            if a.x == b.x {
                tried.push(vec![a, b]);
            }
            let middle = (a.y + b.y) / 2;
            let between = |y: &i32| a.y <= *y && *y <= b.y;
            let usual = rows.into_iter().flatten().chain([middle]);
            // Close under the end as well, where texts fill the rest.
            let aside =
                ROWS.map(|d| middle + d).into_iter().chain([6, 12].map(|part| a.y + (b.y - a.y) / part));
            for y in usual.chain(aside).filter(between) {
                tried.push(vec![a, Point { x: a.x, y }, Point { x: b.x, y }, b]);
            }
            if let Some(free) = tried.iter().find(|p| self.count(p, ends) + self.lines.shared(p, ends) == 0) {
                return free.clone();
            }
        }
        let gap = if b.y > a.y { ((b.y - a.y) / 3).min(LINK) } else { LINK - 50 };
        let (y0, y1) = (rows[0].unwrap_or(a.y + gap), rows[1].unwrap_or(b.y - gap));
        let around = |x: i32, y0: i32, y1: i32| {
            let corner = |x, y| Point { x, y };
            vec![a, corner(a.x, y0), corner(x, y0), corner(x, y1), corner(b.x, y1), b]
        };
        for x in self.columns(y0, y1, ends) {
            let usual = around(x, y0, y1);
            let is_shared = self.lines.shared(&usual, ends) > 0;
            tried.push(usual);
            if is_shared {
                // Rows where other links part or meet stay, since this link parts or meets there too.
                let row = |y: i32, fixed: Option<i32>, d: i32| if fixed.is_some() { y } else { y + d };
                for d in COLUMNS {
                    tried.push(around(x + d, y0, y1));
                    tried.push(around(x + d, row(y0, rows[0], d / 2), row(y1, rows[1], d / 2)));
                }
            }
        }
        let cost = |p: &Vec<Point>| {
            let length: i64 =
                p.windows(2).map(|w| i64::from((w[0].x - w[1].x).abs() + (w[0].y - w[1].y).abs())).sum();
            // A line that goes up does so at the left.
            let right = b.y <= a.y && p.get(2).is_some_and(|c| c.x > a.x.min(b.x));
            (self.count(p, ends) + self.lines.shared(p, ends), length + if right { 600 } else { 0 })
        };
        tried.into_iter().min_by_key(cost).unwrap_or_else(|| vec![a, b])
    }

    /// Columns beside the two ends, moved aside by the symbols that stand in them.
    #[inline(never)]
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
                self.hits(Point { x, y: y0 }, Point { x, y: y1 }, None, |n| {
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
