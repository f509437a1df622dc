//! The room of each symbol together with what is placed round it: texts, arriving connectors, and
//! the row in which loops come back.

use crate::layout::graph::Graph;
use crate::layout::tree::Tree;
use crate::{Extent, Sizes};

/// Height of a step's square.
pub(crate) const SQUARE: i32 = 500;
/// Distance from a symbol to the line or symbol that follows.
pub(crate) const LINK: i32 = 200;
/// Distance between the two lines of a synchronisation.
pub(crate) const DOUBLE: i32 = 50;
/// Distance from a transition's bar to its double line.
pub(crate) const BAR: i32 = 150;
/// How far a double line reaches beyond its outermost links.
pub(crate) const OVERHANG: i32 = 220;
/// Distance between texts and what stands below or above them.
pub(crate) const CLEAR: i32 = 60;
/// Distance between branches.
pub(crate) const GAP: i32 = 250;
/// Least reach of a link to each side.
pub(crate) const LINE: i32 = 60;
/// Height of one connector.
pub(crate) const ROW: i32 = 200;
/// Height of the text box of a connector.
pub(crate) const ROW_TEXT: i32 = 180;
/// How far arriving connectors stand above a step if one of them leads into it from above: clear of
/// its arrow head.
pub(crate) const HEAD: i32 = 100;
/// How much higher that connector begins than the others.
pub(crate) const APART: i32 = 60;
/// Distance from the tip of an arriving connector to its text.
pub(crate) const STUB: i32 = 240;
/// Distance from a vertical connector to its text.
pub(crate) const ASIDE: i32 = 90;

/// The room of one symbol round its anchor.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Room {
    /// To the left.
    pub(crate) left: i32,
    /// To the right.
    pub(crate) right: i32,
    /// Texts above the anchor, without connectors.
    pub(crate) text: i32,
    /// Everything above the anchor except the row of loops.
    pub(crate) up: i32,
    /// Everything below the anchor.
    pub(crate) down: i32,
    /// From the anchor down to where a link leaves.
    pub(crate) port: i32,
    /// From the anchor up to the row in which loops come back; 0 if no loop does.
    pub(crate) entry: i32,
}

impl Room {
    /// Everything above the anchor.
    pub(crate) fn top(&self) -> i32 {
        if self.entry == 0 { self.up } else { self.entry + CLEAR }
    }
}

fn grid(n: i32) -> i32 {
    (n + 49) / 50 * 50
}

/// The extents of all nodes, rounded to half units and limited so that no sum overflows.
#[inline(never)]
pub(crate) fn extents(graph: &Graph, sizes: &Sizes) -> Vec<Extent> {
    let most = (1_500_000_000 / (4 * (graph.nodes as i64 + 1))).clamp(300, 100_000) as i32;
    let limit = |n: i32| grid(n.clamp(0, most));
    let get = |n: usize| {
        let e = match n < graph.steps {
            true => sizes.steps.get(n).copied().unwrap_or_default(),
            false => sizes.transitions.get(n - graph.steps).copied().unwrap_or_default(),
        };
        let e = Extent { left: limit(e.left), right: limit(e.right), up: limit(e.up), down: limit(e.down) };
        match n < graph.steps {
            true => {
                Extent { left: e.left.max(250), right: e.right.max(250), up: e.up, down: e.down.max(SQUARE) }
            }
            false => Extent {
                left: e.left.max(250),
                right: e.right.max(250),
                up: e.up.max(50),
                down: e.down.max(50),
            },
        }
    };
    (0..graph.nodes).map(get).collect()
}

/// The width of the text at one end of a broken link.
#[inline(never)]
pub(crate) fn connector_width(graph: &Graph, sizes: &Sizes, link: u32, leaving: bool) -> i32 {
    let Some(&(from, to)) = graph.links.get(link as usize) else { return 0 };
    let other = if leaving { to } else { from };
    let step = match (graph.is_step(other), leaving) {
        (true, _) => Some(other),
        // A transition is named after the first step beyond it.
        (false, true) => graph.out.of(other).first().map(|l| graph.links[*l as usize].1),
        (false, false) => graph.into.of(other).first().map(|l| graph.links[*l as usize].0),
    };
    let width = step.and_then(|s| sizes.connectors.get(s as usize)).copied().unwrap_or(0);
    width.clamp(0, 4000)
}

/// True if only broken links lead into a step.
pub(crate) fn only_arrivals(graph: &Graph, tree: &Tree, step: u32) -> bool {
    graph.into.of(step).len() == tree.arrivals[step as usize].len()
}

/// True if one of several broken links enters a step from above and the others from its right.
pub(crate) fn from_above(graph: &Graph, tree: &Tree, step: u32) -> bool {
    tree.arrivals[step as usize].len() > 1 && only_arrivals(graph, tree, step)
}

/// The rooms of all nodes.
#[inline(never)]
pub(crate) fn rooms(graph: &Graph, tree: &Tree, sizes: &Sizes) -> Vec<Room> {
    let mut all: Vec<Room> = extents(graph, sizes)
        .into_iter()
        .map(|e| Room { left: e.left, right: e.right, text: e.up, up: e.up, down: e.down, port: 0, entry: 0 })
        .collect();
    for (step, room) in (0u32..).zip(&mut all).take(graph.steps) {
        room.port = SQUARE;
        let arrivals = &tree.arrivals[step as usize];
        if !arrivals.is_empty() {
            let widest = arrivals.iter().map(|l| connector_width(graph, sizes, *l, false)).max().unwrap_or(0);
            room.up += ROW * arrivals.len().min(10_000) as i32 + 30;
            if from_above(graph, tree, step) {
                room.up += HEAD + APART;
            }
            room.right = room.right.max(grid(STUB + widest + CLEAR));
        }
    }
    for r in &tree.returns {
        let room = &mut all[r.target as usize];
        room.entry = (room.up + CLEAR).max(150);
    }
    all
}
