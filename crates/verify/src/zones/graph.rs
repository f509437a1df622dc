//! The sets of states that were found, and concrete runs through them.

use super::clocks::Shape;
use super::matrix::{From, Span, Zone};
use crate::explore::Move;
use crate::store::Store;
use crate::verdict::Run;

/// A move of a set of states.
#[derive(Clone, Debug)]
pub(super) struct Edge {
    /// The inputs of its scans.
    pub(super) inputs: Vec<u64>,
    /// The limits of the clocks at the scan.
    pub(super) limits: Vec<Span>,
    /// The origin of the clocks behind it.
    pub(super) to: Vec<From>,
    /// The scan may be repeated as long as the clocks stay within the limits.
    pub(super) repeats: bool,
}

/// A set of states: a shape with the values that its clocks may have.
pub(super) struct Node {
    /// Number of the shape.
    pub(super) shape: u32,
    pub(super) zone: Zone,
    /// The node before, and the move that led here. Node 0 has none.
    before: Option<(u32, Edge)>,
    /// The node that has all states of this one, and was found before this one had its turn.
    pub(super) covered: Option<u32>,
}

/// All nodes, in the order in which they were found.
pub(super) struct Graph {
    store: Store,
    /// For each shape, the clocks that run.
    runs: Vec<Vec<usize>>,
    /// For each shape, the nodes that no other one contains.
    of_shape: Vec<Vec<u32>>,
    pub(super) nodes: Vec<Node>,
    bytes: usize,
}

impl Graph {
    /// The state before the first scan.
    pub(super) fn new(start: &Shape) -> Graph {
        let mut graph = Graph {
            store: Store::new(),
            runs: Vec::new(),
            of_shape: Vec::new(),
            nodes: Vec::new(),
            bytes: 0,
        };
        graph.add(start, Zone::zero(start.runs.len()), None, 0);
        graph
    }

    pub(super) fn bytes(&self) -> usize {
        self.store.bytes() + self.bytes
    }

    pub(super) fn shape(&self, node: &Node) -> Shape {
        let runs = self.runs.get(node.shape as usize).cloned().unwrap_or_default();
        Shape { image: self.store.image(node.shape as usize), runs }
    }

    /// The image of a node's shape.
    pub(super) fn image(&self, node: usize) -> Vec<u64> {
        self.nodes.get(node).map_or(Vec::new(), |n| self.store.image(n.shape as usize))
    }

    /// The node that has these states: one that is there, or a new one. Of the nodes that the new one
    /// contains, those from number `waiting` on need no turn any more.
    pub(super) fn add(
        &mut self,
        shape: &Shape,
        zone: Zone,
        before: Option<(u32, Edge)>,
        waiting: usize,
    ) -> u32 {
        let next = self.of_shape.len() as u32;
        let number = self.store.find_or_insert(&shape.image).unwrap_or_else(|| {
            self.runs.push(shape.runs.clone());
            self.of_shape.push(Vec::new());
            next
        });
        let new = self.nodes.len() as u32;
        if let Some(list) = self.of_shape.get_mut(number as usize) {
            let zone_of = |n: &u32| self.nodes.get(*n as usize).map(|n| &n.zone);
            if let Some(there) = list.iter().find(|n| zone_of(n).is_some_and(|z| z.contains(&zone))) {
                return *there;
            }
            let (inside, mut rest): (Vec<u32>, Vec<u32>) =
                list.iter().partition(|n| zone_of(n).is_some_and(|z| zone.contains(z)));
            rest.push(new);
            *list = rest;
            for n in inside.into_iter().filter(|n| *n as usize >= waiting) {
                self.nodes.get_mut(n as usize).into_iter().for_each(|n| n.covered = Some(new));
            }
        }
        let words = before.as_ref().map_or(0, |(_, e)| e.inputs.len() + 2 * e.limits.len() + 2 * e.to.len());
        self.bytes += zone.bytes() + 8 * words + size_of::<Node>();
        self.nodes.push(Node { shape: number, zone, before, covered: None });
        new
    }

    /// The node that stands for another one in the end.
    pub(super) fn resolved(&self, mut node: u32) -> u32 {
        while let Some(by) = self.nodes.get(node as usize).and_then(|n| n.covered) {
            node = by;
        }
        node
    }

    /// A run to some state of a node whose clocks are in this set, with as few scans in each wait as
    /// possible. `None` where no such state is found, which would be a mistake of the search.
    pub(super) fn run(&self, node: u32, target: &Zone, period: i64) -> Option<Run> {
        let mut way: Vec<(&Edge, bool, Zone)> = Vec::new();
        let (mut at, mut target) = (node, target.clone());
        while let Some((before, edge)) = self.nodes.get(at as usize).and_then(|n| n.before.as_ref()) {
            let source = self.nodes.get(*before as usize)?;
            let first =
                if edge.repeats { target.ever_earlier()?.within(&edge.limits)? } else { target.clone() };
            let scanned = first.unmoved(&edge.to, source.zone.clocks())?.within(&edge.limits)?;
            let elapse = i64::from(*before != 0);
            way.push((edge, *before != 0, target));
            target = scanned.later(-elapse).and(&source.zone)?;
            at = *before;
        }
        let (mut values, mut moves) = (target.least(), Vec::new());
        for (edge, later, target) in way.iter().rev() {
            let scanned: Vec<i64> = values.iter().map(|v| v + i64::from(*later)).collect();
            values = edge.to.iter().map(|f| f.of(&scanned)).collect();
            let missing = |(v, least): (&i64, i64)| least - v;
            let wait = values.iter().zip(target.least()).map(missing).max().unwrap_or(0).max(0);
            values.iter_mut().for_each(|v| *v += wait);
            if !target.has(&values) || wait > 0 && !edge.repeats {
                return None;
            }
            let one = |wait| Move { inputs: edge.inputs.clone(), wait };
            moves.push(one(if *later { period } else { 0 }));
            moves.extend((0..wait).map(|_| one(period)));
        }
        Some(Run { moves, ..Run::default() })
    }

    /// For each node that had a turn, its number.
    pub(super) fn met(&self) -> impl Iterator<Item = usize> + '_ {
        self.nodes.iter().enumerate().filter(|(_, n)| n.covered.is_none()).map(|(i, _)| i)
    }
}
