//! Places what stands beside a sequence: at the right, sequences that begin or end by themselves;
//! at the left, sequences that lead back, and the vertical lines of loops. A sequence that begins
//! lower stands nearer, so that no line to a sequence farther out crosses one.

use crate::layout::profile::Profile;
use crate::layout::rooms::{CLEAR, DOUBLE, GAP, LINE, LINK};
use crate::layout::shape::{Band, Entry, Exit, Put, Shapes, Side};
use crate::layout::tree::Item;

/// A sequence or a loop that is placed at the left.
#[derive(Debug)]
enum Left {
    Side(usize, Side),
    Loop { entry: Entry, exits: Vec<usize>, low: i32 },
}

impl Shapes<'_> {
    /// Places everything beside a sequence; afterwards its height, reach and open ends are known.
    #[inline(never)]
    pub(crate) fn beside(&mut self, b: usize) {
        let (left, right) = self.sides(b);
        self.lower_last(b, &left);
        let bands = self.bands(b);
        let (exits, entries) = self.open_ends(b);
        let mut height = bands.iter().map(|s| s.y1).max().unwrap_or(0);
        height = left.iter().chain(&right).map(|s| s.y + self.low(s)).max().unwrap_or(0).max(height);
        if !right.is_empty() {
            self.place_right(b, &bands, right);
        } else {
            self.blocks[b].right = bands.iter().map(|s| s.right).max().unwrap_or(0).max(LINE);
        }
        if left.is_empty() && exits.is_empty() {
            self.blocks[b].left = bands.iter().map(|s| s.left).max().unwrap_or(0).max(LINE);
            self.blocks[b].entries = entries;
        } else {
            self.place_left(b, &bands, left, exits, entries);
        }
        let block = &mut self.blocks[b];
        block.height = height;
        if !block.sides.is_empty() {
            block.foot = block.foot.max(height + CLEAR);
        }
    }

    fn low(&self, s: &Side) -> i32 {
        self.blocks[s.block as usize].height
    }

    /// The sequences beside a block's nodes, divided into left and right, with their heights. The
    /// block moves down if one of them begins above its top.
    #[inline(never)]
    fn sides(&mut self, b: usize) -> (Vec<Side>, Vec<Side>) {
        let (mut left, mut right, mut heads) = (Vec::new(), Vec::new(), Vec::<Side>::new());
        let mut nodes: Vec<u32> = Vec::new();
        for put in &self.blocks[b].puts {
            let Item::Node(n) = put.item else { continue };
            if self.below[n as usize].is_empty() && self.above[n as usize].is_empty() {
                continue;
            }
            nodes.push(n);
            for block in self.above[n as usize].clone() {
                let Some(line) = self.above_line[n as usize] else { continue };
                let y = line - self.blocks[block as usize].foot;
                heads.push(Side { block, x: 0, y });
            }
        }
        let lift = CLEAR - heads.iter().map(|h| h.y).min().unwrap_or(CLEAR).min(CLEAR);
        if lift > 0 {
            self.lower(b, lift);
            heads.iter_mut().for_each(|h| h.y += lift);
        }
        for n in nodes {
            let step = self.graph.is_step(n);
            let Some(line) = self.below_line[n as usize] else { continue };
            let line = line + if step { 0 } else { DOUBLE };
            for block in self.below[n as usize].clone() {
                let side = Side { block, x: 0, y: line };
                let under = heads.iter().any(|h| h.y <= line && line <= h.y + self.low(h));
                match self.blocks[block as usize].exits.is_empty() && !under {
                    true => right.push(side),
                    false => left.push(side),
                }
            }
        }
        heads.sort_by_key(|h| h.y + self.low(h));
        right.sort_by_key(|s| std::cmp::Reverse(s.y));
        heads.extend(right);
        // Of several at one node the tallest stands nearest and leaves below the others.
        left.sort_by_key(|s| (std::cmp::Reverse(s.y), std::cmp::Reverse(self.low(s))));
        for k in (1..left.len()).rev() {
            if left[k - 1].y == left[k].y {
                let low = self.low(&left[k]) + 2 * CLEAR;
                self.stretch(left[k - 1].block as usize, low);
            }
        }
        (left, heads)
    }

    /// Moves all items of a block down.
    #[inline(never)]
    fn lower(&mut self, b: usize, by: i32) {
        let block = &mut self.blocks[b];
        block.foot += by;
        block.head = block.head.map(|y| y + by);
        for put in &mut block.puts {
            put.y += by;
            put.tail += by;
            if let Item::Node(n) = put.item {
                for line in [&mut self.below_line[n as usize], &mut self.above_line[n as usize]] {
                    *line = line.map(|y| y + by);
                }
            }
        }
    }

    /// Moves a return at the end of the block below everything that stands at its left.
    fn lower_last(&mut self, b: usize, left: &[Side]) {
        let Some(Put { item: Item::Return(_), y, .. }) = self.blocks[b].puts.last().copied() else { return };
        let low = left.iter().map(|s| s.y + self.low(s)).filter(|low| *low > y - CLEAR).max();
        if let Some(low) = low {
            self.stretch(b, low + 2 * CLEAR);
        }
    }

    /// How far down a sequence needs room: past the line, possibly double, that it leads to.
    fn met(&self, s: &Side) -> i32 {
        self.low(s).max(self.blocks[s.block as usize].foot + DOUBLE) + CLEAR
    }

    #[inline(never)]
    fn place_right(&mut self, b: usize, bands: &[Band], right: Vec<Side>) {
        let rows = bands.iter().flat_map(|s| [s.y0, s.y1]);
        let rows = rows.chain(right.iter().flat_map(|s| [s.y - CLEAR, s.y + self.met(s)]));
        let mut reach = Profile::new(rows.collect());
        bands.iter().for_each(|s| reach.raise(s.y0, s.y1, s.right));
        let mut most = bands.iter().map(|s| s.right).max().unwrap_or(0).max(LINE);
        for mut side in right {
            let block = &self.blocks[side.block as usize];
            let (y0, y1) = (side.y - CLEAR, side.y + self.met(&side));
            side.x = (reach.most(y0, y1).max(LINE) + GAP + block.left + 99) / 100 * 100;
            let to = side.x + block.right;
            reach.raise(y0, y1, to);
            most = most.max(to);
            let exits = std::mem::take(&mut self.blocks[side.block as usize].exits);
            exits.iter().for_each(|e| self.fail(e.back));
            self.blocks[b].sides.push(side);
        }
        self.blocks[b].right = most;
    }

    #[inline(never)]
    fn place_left(
        &mut self,
        b: usize,
        bands: &[Band],
        left: Vec<Side>,
        mut exits: Vec<Exit>,
        mut entries: Vec<Entry>,
    ) {
        entries.sort_unstable_by_key(|e| e.step);
        let mut ends: Vec<Vec<usize>> = vec![Vec::new(); left.len()];
        for (k, side) in left.iter().enumerate() {
            for e in std::mem::take(&mut self.blocks[side.block as usize].exits) {
                ends[k].push(exits.len());
                // The edge is not known until the sequence is placed.
                exits.push(Exit { y: e.y + side.y, edge: -1, ..e });
            }
        }
        let rows = bands.iter().flat_map(|s| [s.y0, s.y1]);
        let rows = rows.chain(left.iter().flat_map(|s| [s.y - CLEAR, s.y + self.low(s) + CLEAR]));
        let rows = rows.chain(exits.iter().flat_map(|e| [e.y - CLEAR / 2, e.y + CLEAR / 2]));
        let rows: Vec<i32> = rows.chain(entries.iter().map(|e| e.y - CLEAR)).collect();
        let (mut solid, mut all) = (Profile::new(rows.clone()), Profile::new(rows));
        for s in bands {
            solid.raise(s.y0, s.y1, s.left);
            all.raise(s.y0, s.y1, s.left);
        }
        let mut most = bands.iter().map(|s| s.left).max().unwrap_or(0).max(LINE);
        let mut edges: Vec<i32> = exits.iter().map(|e| e.edge).collect();
        let mut matched = vec![false; exits.len()];
        let mut order = self.loops(&exits, &entries, &mut matched);
        let top = |l: &Left| match l {
            Left::Side(_, s) => (s.y, 0),
            Left::Loop { entry, low, .. } => (entry.y, entry.y - low),
        };
        order.extend(left.iter().enumerate().map(|(k, s)| Left::Side(k, *s)));
        order.sort_by_key(|l| {
            let (y, size) = top(l);
            (std::cmp::Reverse(y), std::cmp::Reverse(size))
        });
        for next in order {
            match next {
                Left::Side(which, mut side) => {
                    let block = &self.blocks[side.block as usize];
                    let (y0, y1) = (side.y - CLEAR, side.y + block.height + CLEAR);
                    let x = (all.most(y0, y1).max(LINE) + GAP + block.right + 99) / 100 * 100;
                    let to = x + block.left;
                    side.x = -x;
                    solid.raise(y0, y1, to);
                    all.raise(y0, y1, to);
                    most = most.max(to);
                    ends[which].iter().for_each(|k| edges[*k] = to);
                    self.blocks[b].sides.push(side);
                }
                Left::Loop { entry, exits: through, low } => {
                    let free = |k: &usize| {
                        let y = exits[*k].y;
                        y > entry.y && solid.most(y - CLEAR / 2, y + CLEAR / 2) <= edges[*k]
                    };
                    let (free, blocked): (Vec<usize>, Vec<usize>) = through.into_iter().partition(free);
                    blocked.iter().for_each(|k| self.fail(exits[*k].back));
                    self.waiting[entry.step as usize] -= (free.len() + blocked.len()) as u32;
                    if free.is_empty() {
                        continue;
                    }
                    let reach = (all.most(entry.y - CLEAR, low + CLEAR / 2).max(LINE) + LINK + 49) / 50 * 50;
                    all.raise(entry.y - CLEAR, low + CLEAR / 2, reach);
                    most = most.max(reach + LINE);
                    let lanes = free.into_iter().map(|k| (exits[k].back, -reach));
                    self.blocks[b].lanes.extend(lanes);
                }
            }
        }
        // A return that has not reached its step leaves the block and goes on outside.
        for (k, e) in exits.iter().enumerate().filter(|(k, _)| !matched[*k]) {
            match solid.most(e.y - CLEAR / 2, e.y + CLEAR / 2) <= edges[k] {
                true => self.blocks[b].exits.push(*e),
                false => self.fail(e.back),
            }
        }
        entries.retain(|e| {
            let reach = self.rooms[e.step as usize].left;
            self.waiting[e.step as usize] > 0 && solid.most(e.y - CLEAR, e.y) <= reach
        });
        self.blocks[b].entries = entries;
        self.blocks[b].left = most;
    }

    /// The loops that close inside a block.
    #[inline(never)]
    fn loops(&self, exits: &[Exit], entries: &[Entry], matched: &mut [bool]) -> Vec<Left> {
        let mut found: Vec<(u32, usize)> = Vec::new();
        for (k, e) in exits.iter().enumerate() {
            found.push((self.tree.returns[e.back as usize].target, k));
        }
        found.sort_unstable();
        let mut loops = Vec::new();
        for same in found.chunk_by(|a, b| a.0 == b.0) {
            let Ok(at) = entries.binary_search_by_key(&same[0].0, |e| e.step) else { continue };
            let entry = entries[at];
            let through: Vec<usize> = same.iter().map(|s| s.1).collect();
            let low = through.iter().map(|k| exits[*k].y).max().unwrap_or(entry.y);
            through.iter().for_each(|k| matched[*k] = true);
            loops.push(Left::Loop { entry, exits: through, low });
        }
        loops
    }
}
