//! The sizes of all sequences and groups of branches, from the innermost outward: first the heights
//! inside a sequence, then the parts beside it.

use std::ops::Range;

use crate::Sizes;
use crate::layout::graph::Graph;
use crate::layout::rooms::{
    ASIDE, BAR, CLEAR, DOUBLE, GAP, LINE, LINK, OVERHANG, ROW, Room, connector_width, rooms,
};
use crate::layout::tree::{Branch, Item, Tree};

/// A return that leaves a part at its left edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exit {
    /// The number of the return.
    pub(crate) back: u32,
    /// The height at which it leaves.
    pub(crate) y: i32,
    /// The left reach of the part that it leaves.
    pub(crate) edge: i32,
}

/// A step that a return can reach from the left edge of a part.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    /// The step.
    pub(crate) step: u32,
    /// The height at which the return enters.
    pub(crate) y: i32,
}

/// An item and its height in a sequence.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Put {
    /// The item.
    pub(crate) item: Item,
    /// Anchor of a node, top of a group of branches, row of a return, tip of a connector.
    pub(crate) y: i32,
    /// The height at which the link to a connector begins.
    pub(crate) tail: i32,
}

/// A sequence that stands beside a node.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Side {
    /// Its block.
    pub(crate) block: u32,
    /// Its spine, relative to the spine of the sequence that it stands beside.
    pub(crate) x: i32,
    /// Its top.
    pub(crate) y: i32,
}

/// A sequence: heights are measured from its top, widths from its spine.
#[derive(Debug)]
pub(crate) struct Block {
    /// The branch that it shows.
    pub(crate) branch: Branch,
    /// Its items.
    pub(crate) puts: Vec<Put>,
    /// The sequences that stand beside its items.
    pub(crate) sides: Vec<Side>,
    /// The vertical lines of loops: number of the return, column.
    pub(crate) lanes: Vec<(u32, i32)>,
    /// Reach to the left.
    pub(crate) left: i32,
    /// Reach to the right.
    pub(crate) right: i32,
    /// Height of the first anchor, if it begins with a symbol.
    pub(crate) head: Option<i32>,
    /// The least height at which a line can follow.
    pub(crate) foot: i32,
    /// The lowest edge of everything in it.
    pub(crate) height: i32,
    /// The returns that leave it.
    pub(crate) exits: Vec<Exit>,
    /// The steps that returns from outside can reach.
    pub(crate) entries: Vec<Entry>,
}

impl Block {
    /// Records that a return leaves the block at a new height.
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
    /// The spine of each block, relative to that of the group.
    pub(crate) xs: Vec<i32>,
    /// The top of each block.
    pub(crate) ys: Vec<i32>,
    /// All columns at the top; a branch that begins with branches has several.
    tops: Vec<i32>,
    left: i32,
    right: i32,
    head: Option<i32>,
    foot: i32,
    height: i32,
    exits: Vec<Exit>,
    entries: Vec<Entry>,
}

/// The sizes of all parts of a chart.
pub(crate) struct Shapes<'a> {
    pub(crate) graph: &'a Graph,
    pub(crate) tree: &'a Tree,
    pub(crate) sizes: &'a Sizes,
    pub(crate) rooms: Vec<Room>,
    pub(crate) blocks: Vec<Block>,
    pub(crate) groups: Vec<Group>,
    /// The blocks beside each node: those that hang below it, and those that enter it from above.
    pub(crate) below: Vec<Range<u32>>,
    pub(crate) above: Vec<Range<u32>>,
    /// The line or double line below and above each node, from the top of its block.
    pub(crate) below_line: Vec<Option<i32>>,
    pub(crate) above_line: Vec<Option<i32>>,
    /// For each step: from its anchor up to the row in which loops come in.
    pub(crate) entry: Vec<i32>,
    /// The number of returns to each step that have no column yet.
    pub(crate) waiting: Vec<u32>,
    /// The links that could not be drawn and have to be broken.
    pub(crate) failed: Vec<u32>,
}

/// The item above the next one of a sequence.
#[derive(Clone, Copy)]
enum Above {
    /// A line from which branches hang, at the current level.
    Line,
    /// A symbol whose link leaves at the current level; its texts reach down to this height.
    Port(i32),
    /// Branches that meet at the current level.
    Branches,
}

/// Computes the sizes of all parts; the first blocks are the roots.
#[inline(never)]
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
        below_line: vec![None; graph.nodes],
        above_line: vec![None; graph.nodes],
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
    /// Makes a block of every sequence; outer sequences come before inner ones.
    #[inline(never)]
    fn unfold(&mut self) {
        let tree = self.tree;
        self.add(tree.roots.iter().map(|c| Branch { chain: *c, first: None, last: None }).collect());
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
                        branches.sort_by_key(|b| (b.first.is_none(), b.first));
                        self.groups[p as usize].blocks = self.add(branches);
                    }
                    Item::Return(_) | Item::Leave(_) | Item::Arrive(_) => {}
                }
            }
            b += 1;
        }
    }

    #[inline(never)]
    fn add(&mut self, branches: Vec<Branch>) -> Range<u32> {
        let from = self.blocks.len() as u32;
        self.blocks.extend(branches.into_iter().map(|branch| Block {
            branch,
            puts: Vec::new(),
            sides: Vec::new(),
            lanes: Vec::new(),
            left: LINE,
            right: LINE,
            head: None,
            foot: 0,
            height: 0,
            exits: Vec::new(),
            entries: Vec::new(),
        }));
        from..self.blocks.len() as u32
    }

    /// Marks the links of a return that could not be routed.
    pub(crate) fn fail(&mut self, back: u32) {
        self.failed.extend(&self.tree.returns[back as usize].links);
    }

    /// Computes the heights inside a sequence.
    #[inline(never)]
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
            Some(Put { item: Item::Node(_), y, .. }) => Some(*y),
            Some(Put { item: Item::Par(p), .. }) => self.groups[*p as usize].head,
            _ => None,
        };
        block.puts = puts;
    }

    /// Places one symbol: its anchor, the level below it, and what the next item finds there.
    #[inline(never)]
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
            self.above_line[at] = Some(line);
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
        self.below_line[at] = Some(line);
        (y, if step { line } else { line + DOUBLE }, Above::Line)
    }

    /// Computes the size of a group of branches.
    #[inline(never)]
    fn group(&mut self, p: usize) {
        let (top_open, end_open) = (self.tree.pars[p].top_open, self.tree.pars[p].end_open);
        let mut group = std::mem::take(&mut self.groups[p]);
        let blocks = group.blocks.clone();
        let range = blocks.start as usize..blocks.end as usize;
        let of = &self.blocks[range.clone()];
        let head = of.iter().filter_map(|b| b.head).max();
        group.head = head;
        // First symbols stand in one row; returns to several tops come in above that row.
        let entering: usize = of.iter().skip(1).map(|b| b.entries.len()).sum();
        let lift = if top_open { 100 * entering.min(10_000) as i32 } else { 0 };
        let below = |b: &Block| head.zip(b.head).map_or(0, |(row, own)| row - own);
        group.ys = of.iter().map(|b| lift + below(b)).collect();
        columns(&mut group, of, &self.groups);
        let mut row = lift;
        let mut low = i32::MIN;
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

    /// Lowers the return at the end of a block, or the returns of the branches at its end, to `y`.
    #[inline(never)]
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

    /// Lowers the returns of the branches at the end of a block.
    #[inline(never)]
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
            // Returns from farther inside stay where they are.
            group.exits.iter_mut().filter(|e| e.back == back).for_each(|e| e.y += by);
        }
        let low = group.exits.iter().map(|e| e.y).max().unwrap_or(0);
        group.height = group.height.max(low);
        group.foot = group.height;
        let top = self.blocks[b].puts.last().map_or(0, |put| put.y);
        group.exits.iter().for_each(|e| self.blocks[b].deepen(e.back, top + e.y));
        self.groups[p] = group;
    }

    /// The rows of a sequence with their reach, without the parts beside it.
    #[inline(never)]
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

    /// The returns that leave a sequence or its branches, and the steps that a return can reach.
    #[inline(never)]
    pub(crate) fn open_ends(&self, b: usize) -> (Vec<Exit>, Vec<Entry>) {
        let (mut exits, mut entries) = (Vec::new(), Vec::new());
        let mut meeting = LINE;
        for put in &self.blocks[b].puts {
            match put.item {
                Item::Node(n) if self.waiting[n as usize] > 0 => {
                    let y = self.above_line[n as usize].unwrap_or(put.y - self.entry[n as usize]);
                    entries.push(Entry { step: n, y });
                    meeting = LINE;
                }
                // Branches that meet and return share one line.
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

/// A range of rows of a sequence and its reach to both sides.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Band {
    pub(crate) y0: i32,
    pub(crate) y1: i32,
    pub(crate) left: i32,
    pub(crate) right: i32,
}

/// Places branches beside one another and finds the spine among them.
#[inline(never)]
fn columns(group: &mut Group, of: &[Block], groups: &[Group]) {
    let Some(last) = of.last() else { return };
    let need: Vec<i32> = of.windows(2).map(|w| (w[0].right + GAP + w[1].left + 99) / 100 * 100).collect();
    // Use equal distances if that costs little width.
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
    // An inner branch may reach further than the outermost ones.
    for (x, b) in group.xs.iter().zip(of) {
        group.left = group.left.max(b.left - x);
        group.right = group.right.max(b.right + x);
    }
}
