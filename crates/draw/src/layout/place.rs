//! Turns sizes into places, from the outside in.

use crate::Point;
use crate::layout::rooms::{LINE, from_above, only_arrivals};
use crate::layout::shape::{Block, Shapes};
use crate::layout::tree::Item;

/// Distance between parts of the chart that no link connects.
const APART: i32 = 600;
/// If there are more parts than this, they stand in several rows.
const IN_A_ROW: usize = 8;

/// The places of all symbols and of the corners of links.
#[derive(Debug, Default)]
pub(crate) struct Places {
    /// The anchors of all nodes.
    pub(crate) at: Vec<Point>,
    /// The height of the line below and above each node.
    pub(crate) below_line: Vec<Option<i32>>,
    pub(crate) above_line: Vec<Option<i32>>,
    /// The column of each link where it differs from that of its upper end: the column of the
    /// sequence it begins, and of the sequence it ends.
    pub(crate) column: Vec<Option<i32>>,
    pub(crate) landing: Vec<Option<i32>>,
    /// The row in which each return leaves, and the column in which it goes up.
    pub(crate) row: Vec<i32>,
    pub(crate) lane: Vec<i32>,
    /// Broken ends: link, true at its start, where its line begins, its tip.
    pub(crate) broken: Vec<(u32, bool, Point, Point)>,
    /// Width and height of the whole placement.
    pub(crate) size: Point,
}

/// Computes the places of everything in the shapes.
#[inline(never)]
pub(crate) fn places(s: &Shapes) -> Places {
    let nodes = s.graph.nodes;
    let mut p = Places {
        at: vec![Point::default(); nodes],
        below_line: vec![None; nodes],
        above_line: vec![None; nodes],
        column: vec![None; s.graph.links.len()],
        landing: vec![None; s.graph.links.len()],
        row: vec![0; s.tree.returns.len()],
        lane: vec![0; s.tree.returns.len()],
        ..Places::default()
    };
    let mut stack = p.roots(s);
    while let Some((b, x, y)) = stack.pop() {
        p.block(s, &s.blocks[b as usize], Point { x, y }, &mut stack);
    }
    p.arrivals(s);
    p
}

impl Places {
    /// The column in which a link runs where it leaves (or enters) a node.
    pub(crate) fn column(&self, link: u32, leaving: bool, at: i32) -> i32 {
        let (column, landing) = (self.column[link as usize], self.landing[link as usize]);
        let both = if leaving { [column, landing] } else { [landing, column] };
        both.into_iter().flatten().next().unwrap_or(at)
    }

    /// The outermost blocks beside one another; the block with the first step comes first.
    #[inline(never)]
    fn roots(&mut self, s: &Shapes) -> Vec<(u32, i32, i32)> {
        let first = first_steps(s);
        let mut roots: Vec<u32> = (0..s.tree.roots.len() as u32).collect();
        roots.sort_by_key(|r| first[*r as usize]);
        let width = |r: &u32| {
            let b = &s.blocks[*r as usize];
            i64::from(b.left + b.right + APART)
        };
        let total: i64 = roots.iter().map(width).sum();
        let tall = roots.iter().map(|r| i64::from(s.blocks[*r as usize].height)).max().unwrap_or(0) + 1;
        let wide = roots.iter().map(width).max().unwrap_or(0);
        // Use several rows if one row would be far wider than high.
        let rows = ((total / (3 * tall)).max(1) as f64).sqrt().ceil().max(1.0) as i64;
        let most = match roots.len() > IN_A_ROW {
            true => (total / rows).max(wide),
            false => i64::MAX,
        };
        let mut found = Vec::with_capacity(roots.len());
        let (mut x, mut y, mut low) = (0i32, 0i32, 0i32);
        for r in roots {
            let b = &s.blocks[r as usize];
            if x > 0 && i64::from(x) + width(&r) > most {
                (x, y) = (0, low + APART);
            }
            let left = (b.left + 99) / 100 * 100;
            found.push((r, x + left, y));
            x += left + b.right + APART;
            low = low.max(y + b.height);
            self.size = Point { x: self.size.x.max(x - APART), y: low };
        }
        found
    }

    #[inline(never)]
    fn block(&mut self, s: &Shapes, b: &Block, at: Point, stack: &mut Vec<(u32, i32, i32)>) {
        if let Some(link) = b.branch.first {
            self.column[link as usize] = Some(at.x);
        }
        if let Some(link) = b.branch.last {
            self.landing[link as usize] = Some(at.x);
        }
        for (back, x) in &b.lanes {
            self.lane[*back as usize] = at.x + x;
        }
        for side in &b.sides {
            stack.push((side.block, at.x + side.x, at.y + side.y));
        }
        for (k, put) in b.puts.iter().enumerate() {
            let y = at.y + put.y;
            match put.item {
                Item::Node(n) => {
                    let n = n as usize;
                    self.at[n] = Point { x: at.x, y };
                    let moved = |line: Option<i32>| line.map(|y| y + at.y);
                    self.below_line[n] = moved(s.below_line[n]);
                    self.above_line[n] = moved(s.above_line[n]);
                }
                Item::Par(p) => {
                    let g = &s.groups[p as usize];
                    let places = g.xs.iter().zip(&g.ys).map(|(dx, dy)| (at.x + dx, y + dy));
                    stack.extend(g.blocks.clone().zip(places).map(|(b, (x, y))| (b, x, y)));
                }
                Item::Return(back) => self.row[back as usize] = y,
                Item::Leave(l) => {
                    let tail = Point { x: at.x, y: at.y + put.tail };
                    self.broken.push((l, true, tail, Point { x: at.x, y }));
                }
                Item::Arrive(l) => {
                    let tail = Point { x: at.x, y: at.y + put.tail };
                    // At the symbol that follows; alone in its block it leads out of that.
                    let next = b.puts.get(k + 1).map_or(b.foot, |next| next.y);
                    self.broken.push((l, false, tail, Point { x: at.x, y: at.y + next }));
                }
            }
        }
    }

    /// Places the connectors that arrive at a step: at the right of the link above it. If no link
    /// is drawn there, the uppermost connector arrives from above.
    #[inline(never)]
    fn arrivals(&mut self, s: &Shapes) {
        use crate::layout::rooms::{APART, HEAD, ROW, STUB};
        for (step, links) in s.tree.arrivals.iter().enumerate().filter(|(_, l)| !l.is_empty()) {
            let at = self.at[step];
            let alone = only_arrivals(s.graph, s.tree, step as u32);
            let (head, apart) = if from_above(s.graph, s.tree, step as u32) { (HEAD, APART) } else { (0, 0) };
            let first = at.y - s.rooms[step].text - ROW / 2 - 10 - head;
            for (k, &l) in (0..).zip(links) {
                let y = first - ROW * k;
                let last = k as usize + 1 == links.len();
                let (tail, tip) = match alone && last {
                    true => (Point { x: at.x, y: y - apart - ROW / 2 + LINE / 3 }, at),
                    false => (Point { x: at.x + STUB - 40, y }, Point { x: at.x, y }),
                };
                self.broken.push((l, false, tail, tip));
            }
        }
    }
}

/// The first step, in the order of the text, that each outermost block holds.
#[inline(never)]
fn first_steps(s: &Shapes) -> Vec<Option<u32>> {
    let mut root: Vec<u32> = (0..s.blocks.len() as u32).collect();
    let mut first: Vec<Option<u32>> = vec![None; s.tree.roots.len()];
    for b in 0..s.blocks.len() {
        let of = root[b];
        for put in &s.blocks[b].puts {
            match put.item {
                Item::Node(n) => {
                    let key = if s.graph.is_step(n) { n } else { n + s.graph.steps as u32 };
                    let first = &mut first[of as usize];
                    *first = Some(first.map_or(key, |f| f.min(key)));
                    let beside = [&s.below[n as usize], &s.above[n as usize]];
                    beside.into_iter().flat_map(|r| r.clone()).for_each(|c| root[c as usize] = of);
                }
                Item::Par(p) => {
                    s.groups[p as usize].blocks.clone().for_each(|c| root[c as usize] = of);
                }
                Item::Return(_) | Item::Leave(_) | Item::Arrive(_) => {}
            }
        }
    }
    first
}
