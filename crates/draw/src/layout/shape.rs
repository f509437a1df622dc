//! The size of every sequence and group of branches, from the innermost outward:
//! first the heights in a sequence, then what stands beside it.

use std::ops::Range;

use crate::Sizes;
use crate::layout::graph::Graph;
use crate::layout::rooms::{
    ASIDE, BAR, CLEAR, DOUBLE, GAP, LINE, LINK, OVERHANG, ROW, Room, connector_width, rooms,
};
use crate::layout::tree::{Branch, Item, NONE, Tree};

/// A height that is not there.
pub(crate) const NOWHERE: i32 = i32::MIN;

/// A way back that leaves a part at its left edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exit {
    /// Which way back.
    pub(crate) back: u32,
    /// At which height.
    pub(crate) y: i32,
    /// How far to the left the part reaches that it leaves.
    pub(crate) edge: i32,
}

/// A step that a way back can reach from the left edge of a part.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    /// The step.
    pub(crate) step: u32,
    /// At which height.
    pub(crate) y: i32,
}

/// An item at its height in a sequence.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Put {
    /// What.
    pub(crate) item: Item,
    /// Anchor of a node, top of branches, row of a way back, tip of a connector.
    pub(crate) y: i32,
    /// Where the link to a connector begins.
    pub(crate) tail: i32,
}

/// A sequence beside a node.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Side {
    /// Its block.
    pub(crate) block: u32,
    /// Where its spine is, from the spine of the sequence it stands beside.
    pub(crate) x: i32,
    /// Where its top is.
    pub(crate) y: i32,
}

/// A sequence, its heights from its top, its widths from its spine.
#[derive(Debug)]
pub(crate) struct Block {
    /// What it was made from.
    pub(crate) branch: Branch,
    /// Its items.
    pub(crate) puts: Vec<Put>,
    /// What stands beside them.
    pub(crate) sides: Vec<Side>,
    /// Vertical lines of loops: which way back, where.
    pub(crate) lanes: Vec<(u32, i32)>,
    /// Reach to the left.
    pub(crate) left: i32,
    /// Reach to the right.
    pub(crate) right: i32,
    /// Height of the first anchor, [`NOWHERE`] if it begins otherwise.
    pub(crate) head: i32,
    /// Where a line below can be at the earliest.
    pub(crate) foot: i32,
    /// Lowest edge of all that is in it.
    pub(crate) height: i32,
    /// Ways back that leave it.
    pub(crate) exits: Vec<Exit>,
    /// Steps that ways back can reach.
    pub(crate) entries: Vec<Entry>,
}

impl Block {
    /// A way back out of it runs at this height now.
    fn deepen(&mut self, back: u32, y: i32) {
        self.exits.iter_mut().filter(|e| e.back == back).for_each(|e| e.y = y);
        self.height = self.height.max(y);
        self.foot = self.foot.max(y);
    }
}

/// A group of branches.
#[derive(Clone, Debug, Default)]
pub(crate) struct Group {
    /// Its blocks.
    pub(crate) blocks: Range<u32>,
    /// The spine of each, from the group's.
    pub(crate) xs: Vec<i32>,
    /// The top of each.
    pub(crate) ys: Vec<i32>,
    /// All columns at its top: a branch that begins with branches has several.
    tops: Vec<i32>,
    left: i32,
    right: i32,
    head: i32,
    foot: i32,
    height: i32,
    exits: Vec<Exit>,
    entries: Vec<Entry>,
}

/// All sizes.
pub(crate) struct Shapes<'a> {
    pub(crate) graph: &'a Graph,
    pub(crate) tree: &'a Tree,
    pub(crate) sizes: &'a Sizes,
    pub(crate) rooms: Vec<Room>,
    pub(crate) blocks: Vec<Block>,
    pub(crate) groups: Vec<Group>,
    /// The blocks beside each node, below and above it.
    pub(crate) below: Vec<Range<u32>>,
    pub(crate) above: Vec<Range<u32>>,
    /// The line or double line below and above each node, from the top of its block.
    pub(crate) below_line: Vec<i32>,
    pub(crate) above_line: Vec<i32>,
    /// From each step's anchor up to where loops come in.
    pub(crate) entry: Vec<i32>,
    /// Ways back to each step that have not found their lane.
    pub(crate) waiting: Vec<u32>,
    /// Links that could not be drawn and have to be broken.
    pub(crate) failed: Vec<u32>,
}

/// What is above the next item of a sequence.
#[derive(Clone, Copy)]
enum Above {
    /// A line from which branches hang, at the level.
    Line,
    /// A symbol with its port at the level and its texts down to here.
    Port(i32),
    /// Branches that meet at the level.
    Branches,
}

/// The sizes of all parts; the first blocks are the roots.
pub(crate) fn shapes<'a>(graph: &'a Graph, tree: &'a Tree, sizes: &'a Sizes) -> Shapes<'a> {
    let rooms = rooms(graph, tree, sizes);
    let mut waiting = vec![0; graph.nodes];
    tree.returns.iter().for_each(|r| waiting[r.target as usize] += 1);
    let mut s = Shapes {
        graph,
        tree,
        sizes,
        entry: rooms.iter().map(|r| r.entry).collect(),
        rooms,
        blocks: Vec::new(),
        groups: vec![Group::default(); tree.pars.len()],
        below: vec![0..0; graph.nodes],
        above: vec![0..0; graph.nodes],
        below_line: vec![NOWHERE; graph.nodes],
        above_line: vec![NOWHERE; graph.nodes],
        waiting,
        failed: Vec::new(),
    };
    s.unfold();
    for b in (0..s.blocks.len()).rev() {
        let chain = s.blocks[b].branch.chain;
        for item in tree.walk(chain) {
            if let Item::Par(p) = item {
                s.group(p as usize);
            }
        }
        s.sequence(b);
        s.beside(b);
    }
    for root in 0..tree.roots.len() {
        let exits = std::mem::take(&mut s.blocks[root].exits);
        exits.iter().for_each(|e| s.fail(e.back));
    }
    s
}

impl Shapes<'_> {
    /// Makes a block of every sequence, outer ones before those in them.
    fn unfold(&mut self) {
        let tree = self.tree;
        self.add(tree.roots.iter().map(|c| Branch { chain: *c, first: NONE, last: NONE }).collect());
        let mut b = 0;
        while b < self.blocks.len() {
            let items: Vec<Item> = tree.walk(self.blocks[b].branch.chain).collect();
            for item in items {
                match item {
                    Item::Node(n) => {
                        let n = n as usize;
                        if !tree.below[n].is_empty() {
                            self.below[n] = self.add(tree.below[n].clone());
                        }
                        if !tree.above[n].is_empty() {
                            self.above[n] = self.add(tree.above[n].clone());
                        }
                    }
                    Item::Par(p) => {
                        let mut branches = tree.pars[p as usize].branches.clone();
                        branches.sort_by_key(|b| b.first);
                        self.groups[p as usize].blocks = self.add(branches);
                    }
                    Item::Return(_) | Item::Leave(_) | Item::Arrive(_) => {}
                }
            }
            b += 1;
        }
    }

    fn add(&mut self, branches: Vec<Branch>) -> Range<u32> {
        let from = self.blocks.len() as u32;
        self.blocks.extend(branches.into_iter().map(|branch| Block {
            branch,
            puts: Vec::new(),
            sides: Vec::new(),
            lanes: Vec::new(),
            left: LINE,
            right: LINE,
            head: NOWHERE,
            foot: 0,
            height: 0,
            exits: Vec::new(),
            entries: Vec::new(),
        }));
        from..self.blocks.len() as u32
    }

    /// A way back for which there is no way.
    pub(crate) fn fail(&mut self, back: u32) {
        self.failed.extend(&self.tree.returns[back as usize].links);
    }

    /// The heights in a sequence.
    fn sequence(&mut self, b: usize) {
        let tree = self.tree;
        let items: Vec<Item> = tree.walk(self.blocks[b].branch.chain).collect();
        let mut puts: Vec<Put> = Vec::with_capacity(items.len());
        let (mut level, mut above) = (0, Above::Line);
        for (k, &item) in items.iter().enumerate() {
            let branches_follow = matches!(items.get(k + 1), Some(Item::Par(_)));
            let tail = level;
            let y;
            (y, level, above) = match item {
                Item::Node(n) => self.node(n, level, above, branches_follow),
                Item::Par(p) => (level, level + self.groups[p as usize].foot, Above::Branches),
                Item::Return(_) => {
                    let y = match above {
                        Above::Line => level + BAR,
                        Above::Port(text) => (level + LINK).max(text + CLEAR),
                        Above::Branches => level,
                    };
                    (y, y, Above::Branches)
                }
                Item::Leave(_) => {
                    let text = if let Above::Port(text) = above { text } else { level };
                    let y = (level + LINK + 50).max(text + ROW);
                    (y, y, Above::Line)
                }
                Item::Arrive(_) => (level + 2 * CLEAR + ROW, level + 2 * CLEAR + ROW, Above::Line),
            };
            puts.push(Put { item, y, tail });
        }
        let block = &mut self.blocks[b];
        block.foot = match above {
            Above::Line if items.is_empty() => 100,
            Above::Line => level + CLEAR,
            Above::Port(text) => (level + LINK).max(text + CLEAR),
            Above::Branches => level,
        };
        block.head = match puts.first() {
            Some(Put { item: Item::Node(_), y, .. }) => *y,
            Some(Put { item: Item::Par(p), .. }) => self.groups[*p as usize].head,
            _ => NOWHERE,
        };
        block.puts = puts;
    }

    /// One symbol: its anchor, and where what follows begins.
    fn node(&mut self, n: u32, level: i32, above: Above, branches: bool) -> (i32, i32, Above) {
        let at = n as usize;
        let (room, step) = (self.rooms[at], self.graph.is_step(n));
        let meets = matches!(above, Above::Branches) || !self.above[at].is_empty();
        let y = if meets {
            let line = match above {
                Above::Line => level + LINK,
                Above::Port(text) => (level + LINK).max(text + CLEAR),
                Above::Branches => level,
            };
            self.above_line[at] = line;
            match step {
                true => line + LINK.max(CLEAR + room.up),
                false => line + DOUBLE + BAR.max(CLEAR + room.up),
            }
        } else {
            match above {
                Above::Port(text) => (level + 2 * LINK).max(text + CLEAR + room.top()),
                Above::Line | Above::Branches => level + LINK.max(CLEAR + room.top()),
            }
        };
        let (port, text) = (y + room.port, y + room.down.max(room.port));
        if !branches && self.below[at].is_empty() {
            return (y, port, Above::Port(text));
        }
        let line = if step { (port + LINK).max(text + CLEAR) } else { (port + BAR).max(text + DOUBLE) };
        self.below_line[at] = line;
        (y, if step { line } else { line + DOUBLE }, Above::Line)
    }

    /// The size of a group of branches.
    fn group(&mut self, p: usize) {
        let (top_open, end_open) = (self.tree.pars[p].top_open, self.tree.pars[p].end_open);
        let mut group = std::mem::take(&mut self.groups[p]);
        let blocks = group.blocks.clone();
        let range = blocks.start as usize..blocks.end as usize;
        let of = &self.blocks[range.clone()];
        let head = of.iter().map(|b| b.head).max().unwrap_or(NOWHERE);
        group.head = head;
        // First symbols stand in one row; ways back to several tops come in above it.
        let entering: usize = of.iter().skip(1).map(|b| b.entries.len()).sum();
        let lift = if top_open { 100 * entering.min(10_000) as i32 } else { 0 };
        group.ys = of.iter().map(|b| lift + if b.head == NOWHERE { 0 } else { head - b.head }).collect();
        columns(&mut group, of, &self.groups);
        let mut row = lift;
        let mut low = NOWHERE;
        for (k, b) in range.enumerate() {
            let dy = group.ys[k];
            if end_open && k > 0 {
                self.stretch(b, low + 2 * CLEAR - dy);
            }
            let edge = group.left;
            for e in std::mem::take(&mut self.blocks[b].exits) {
                match k == 0 || low < e.y + dy - CLEAR / 2 {
                    true => group.exits.push(Exit { y: e.y + dy, edge, ..e }),
                    false => self.fail(e.back),
                }
            }
            for e in std::mem::take(&mut self.blocks[b].entries) {
                if k == 0 {
                    group.entries.push(Entry { y: e.y + dy, ..e });
                } else if top_open && self.begins_with(b, e.step) {
                    row -= 100;
                    self.entry[e.step as usize] += e.y + dy - row;
                    group.entries.push(Entry { y: row, ..e });
                }
            }
            let block = &self.blocks[b];
            low = low.max(dy + block.height);
            group.foot = group.foot.max(dy + block.foot);
        }
        group.height = low.max(group.foot);
        if end_open {
            group.foot = group.height;
        }
        self.groups[p] = group;
    }

    fn begins_with(&self, b: usize, step: u32) -> bool {
        self.blocks[b].puts.first().is_some_and(|p| p.item == Item::Node(step))
    }

    /// Lets a way back at the end of a block run lower, or those of the branches at its end.
    pub(crate) fn stretch(&mut self, b: usize, y: i32) {
        let Some(last) = self.blocks[b].puts.last().copied() else { return };
        match last.item {
            Item::Return(back) if last.y < y => {
                if let Some(put) = self.blocks[b].puts.last_mut() {
                    put.y = y;
                }
                self.blocks[b].deepen(back, y);
            }
            Item::Par(p) if self.tree.pars[p as usize].end_open => {
                let highest = self.groups[p as usize].exits.iter().map(|e| last.y + e.y).min();
                if let Some(by) = highest.map(|row| y - row).filter(|by| *by > 0) {
                    self.stretch_all(b, p as usize, by);
                }
            }
            Item::Return(_) | Item::Par(_) | Item::Node(_) | Item::Leave(_) | Item::Arrive(_) => {}
        }
    }

    /// Lets the ways back of the branches at the end of a block run lower.
    fn stretch_all(&mut self, b: usize, p: usize, by: i32) {
        let mut group = std::mem::take(&mut self.groups[p]);
        for inner in group.blocks.clone() {
            let Some(Put { item: Item::Return(back), y, .. }) = self.blocks[inner as usize].puts.last_mut()
            else {
                continue;
            };
            *y += by;
            let (back, row) = (*back, *y);
            self.blocks[inner as usize].deepen(back, row);
            // Others, from farther inside, stay where they are.
            group.exits.iter_mut().filter(|e| e.back == back).for_each(|e| e.y += by);
        }
        let low = group.exits.iter().map(|e| e.y).max().unwrap_or(0);
        group.height = group.height.max(low);
        group.foot = group.height;
        let top = self.blocks[b].puts.last().map_or(0, |put| put.y);
        group.exits.iter().for_each(|e| self.blocks[b].deepen(e.back, top + e.y));
        self.groups[p] = group;
    }

    /// The rows of a sequence with their reach, without what stands beside it.
    pub(crate) fn bands(&self, b: usize) -> Vec<Band> {
        let band = |put: &Put| {
            let y = put.y;
            match put.item {
                Item::Node(n) => {
                    let r = &self.rooms[n as usize];
                    Band { y0: y - r.top(), y1: y + r.down.max(r.port), left: r.left, right: r.right }
                }
                Item::Par(p) => {
                    let g = &self.groups[p as usize];
                    Band { y0: y, y1: y + g.height, left: g.left, right: g.right }
                }
                Item::Return(_) => Band { y0: y - 50, y1: y + 50, left: LINE, right: LINE },
                Item::Leave(l) => {
                    let right = ASIDE + connector_width(self.graph, self.sizes, l, true) + CLEAR;
                    Band { y0: y - ROW, y1: y + 50, left: OVERHANG, right: right.max(OVERHANG) }
                }
                Item::Arrive(l) => {
                    let right = ASIDE + connector_width(self.graph, self.sizes, l, false) + CLEAR;
                    Band { y0: y - ROW - CLEAR, y1: y + 50, left: OVERHANG, right: right.max(OVERHANG) }
                }
            }
        };
        self.blocks[b].puts.iter().map(band).collect()
    }

    /// The ways back that leave the branches in a sequence or the sequence itself,
    /// and the steps to which one can come back.
    pub(crate) fn open_ends(&self, b: usize) -> (Vec<Exit>, Vec<Entry>) {
        let (mut exits, mut entries) = (Vec::new(), Vec::new());
        let mut meeting = LINE;
        for put in &self.blocks[b].puts {
            match put.item {
                Item::Node(n) if self.waiting[n as usize] > 0 => {
                    let line = self.above_line[n as usize];
                    let y = if line == NOWHERE { put.y - self.entry[n as usize] } else { line };
                    entries.push(Entry { step: n, y });
                    meeting = LINE;
                }
                // Branches that meet and go back have that line in common.
                Item::Return(back) => exits.push(Exit { back, y: put.y, edge: meeting }),
                Item::Par(p) => {
                    let g = &self.groups[p as usize];
                    meeting = meeting.max(g.left);
                    exits.extend(g.exits.iter().map(|e| Exit { y: e.y + put.y, ..*e }));
                    entries.extend(g.entries.iter().map(|e| Entry { y: e.y + put.y, ..*e }));
                }
                Item::Node(_) | Item::Leave(_) | Item::Arrive(_) => meeting = LINE,
            }
        }
        (exits, entries)
    }
}

/// Rows of a sequence and their reach.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Band {
    pub(crate) y0: i32,
    pub(crate) y1: i32,
    pub(crate) left: i32,
    pub(crate) right: i32,
}

/// Sets branches beside one another and finds the spine among them.
fn columns(group: &mut Group, of: &[Block], groups: &[Group]) {
    let Some(last) = of.last() else { return };
    let need: Vec<i32> = of.windows(2).map(|w| (w[0].right + GAP + w[1].left + 99) / 100 * 100).collect();
    // Even distances where that costs little.
    let widest = need.iter().copied().max().unwrap_or(0);
    let total: i64 = need.iter().map(|n| i64::from(*n)).sum();
    let even = need.len() <= 8 && i64::from(widest) * need.len() as i64 * 4 <= total * 5;
    let mut x = 0;
    group.xs = Vec::with_capacity(of.len());
    group.xs.push(0);
    for n in need {
        x += if even { widest } else { n };
        group.xs.push(x);
    }
    for (x, b) in group.xs.iter().zip(of) {
        match b.puts.first() {
            Some(Put { item: Item::Par(p), .. }) => {
                group.tops.extend(groups[*p as usize].tops.iter().map(|top| x + top));
            }
            _ => group.tops.push(*x),
        }
    }
    let rows = |k: usize| of[k].branch.chain.rows;
    let light = |a: usize, b: usize| rows(a) <= 1 && rows(b) > 1 || rows(a) * 4 <= rows(b);
    let count = group.tops.len();
    let spine = match of.len() {
        2 if light(0, 1) => group.xs[1],
        2 if light(1, 0) => 0,
        _ if count % 2 == 1 => group.tops[count / 2],
        _ => (group.tops[count / 2 - 1] + group.tops[count / 2]) / 2,
    };
    group.tops.iter_mut().for_each(|x| *x -= spine);
    group.left = (spine + of[0].left).max(spine + OVERHANG);
    group.right = (x - spine + last.right).max(x - spine + OVERHANG);
    group.xs.iter_mut().for_each(|x| *x -= spine);
    // A branch between may reach further than the outermost.
    for (x, b) in group.xs.iter().zip(of) {
        group.left = group.left.max(b.left - x);
        group.right = group.right.max(b.right + x);
    }
}
