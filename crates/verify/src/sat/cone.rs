//! The part of a system that a signal depends on, and the part of a state that made it 1.

use crate::sat::graph::{Node, Signal, System};

/// Latches with values: the states in which all of these signals are 1. Sorted.
pub(crate) type Cube = Vec<Signal>;

/// True if a state of the first step may be in a cube.
pub(crate) fn touches_start(system: &System, cube: &[Signal]) -> bool {
    !cube.iter().any(|s| leaves_start(system, *s))
}

/// True if a latch has the opposite value at the first step.
pub(crate) fn leaves_start(system: &System, s: Signal) -> bool {
    let Node::Latch(place) = system.graph.node(s) else { return false };
    let init = system.latches.get(place as usize).and_then(|l| l.init.value());
    init.is_some_and(|value| value == s.is_negated())
}

/// The next value of a latch, negated as the signal is.
pub(crate) fn next(system: &System, s: Signal) -> Signal {
    match system.graph.node(s) {
        Node::Latch(place) => {
            let next = system.latches.get(place as usize).map_or(Signal::FALSE, |l| l.next);
            next.negated_if(s.is_negated())
        }
        Node::False | Node::Input(_) | Node::And(..) => s,
    }
}

/// For each node, whether the roots depend on it, in this step or through the steps before.
pub(crate) fn cone(system: &System, roots: impl Iterator<Item = Signal>) -> Vec<bool> {
    let mut seen = vec![false; system.graph.nodes().len()];
    let mut work: Vec<Signal> = roots.collect();
    while let Some(s) = work.pop() {
        let Some(slot) = seen.get_mut(s.node() as usize).filter(|seen| !**seen) else { continue };
        *slot = true;
        match system.graph.node(s) {
            Node::And(a, b) => work.extend([a, b]),
            Node::Latch(_) => work.push(next(system, s)),
            Node::False | Node::Input(_) => {}
        }
    }
    seen
}

/// Finds the part of a state that matters, again and again.
pub(crate) struct Lift {
    /// The round in which a node was seen last.
    seen: Vec<u32>,
    round: u32,
    /// For each node seen: its value, the number of latches that its value is thought to need,
    /// and whether it is needed.
    rows: Vec<Row>,
    /// The nodes of a round, operands first.
    order: Vec<u32>,
}

#[derive(Clone, Copy, Default)]
struct Row {
    value: bool,
    cost: u32,
    needed: bool,
}

impl Lift {
    pub(crate) fn new(system: &System) -> Lift {
        let count = system.graph.nodes().len();
        Lift { seen: vec![0; count], round: 0, rows: vec![Row::default(); count], order: Vec::new() }
    }

    /// A cube around a state: whatever the other latches are, the targets are 1 with the same
    /// inputs. `value` gives latches and inputs; with them all targets are 1.
    pub(crate) fn cube(
        &mut self,
        system: &System,
        targets: impl Iterator<Item = Signal>,
        value: impl Fn(Signal) -> bool,
    ) -> Cube {
        let targets: Vec<Signal> = targets.collect();
        self.collect(system, &targets);
        self.evaluate(system, value);
        for t in &targets {
            self.need(t.node());
        }
        let mut cube = Vec::new();
        for at in (0..self.order.len()).rev() {
            let Some(node) = self.order.get(at).copied() else { continue };
            let row = self.row(node);
            if !row.needed {
                continue;
            }
            match system.graph.node(Signal::of(node, false)) {
                Node::Latch(_) => cube.push(Signal::of(node, !row.value)),
                Node::And(a, b) if row.value => [a, b].into_iter().for_each(|s| self.need(s.node())),
                // One operand that is 0 is enough.
                Node::And(a, b) => {
                    let cost = |s: Signal| {
                        let row = self.row(s.node());
                        (!row.needed, row.cost)
                    };
                    let chosen = match (self.is(a), self.is(b)) {
                        (false, false) if cost(b) < cost(a) => b,
                        (false, _) => a,
                        (true, _) => b,
                    };
                    self.need(chosen.node());
                }
                Node::False | Node::Input(_) => {}
            }
        }
        cube.sort_unstable();
        cube
    }

    fn row(&self, node: u32) -> Row {
        self.rows.get(node as usize).copied().unwrap_or_default()
    }

    fn is(&self, s: Signal) -> bool {
        self.row(s.node()).value != s.is_negated()
    }

    fn need(&mut self, node: u32) {
        if let Some(row) = self.rows.get_mut(node as usize) {
            row.needed = true;
        }
    }

    /// Lists the nodes below the targets.
    fn collect(&mut self, system: &System, targets: &[Signal]) {
        self.round += 1;
        self.order.clear();
        let mut work: Vec<(u32, bool)> = targets.iter().map(|s| (s.node(), false)).collect();
        while let Some((node, done)) = work.pop() {
            if done {
                self.order.push(node);
                continue;
            }
            let round = self.round;
            let Some(seen) = self.seen.get_mut(node as usize).filter(|seen| **seen != round) else {
                continue;
            };
            *seen = round;
            work.push((node, true));
            if let Node::And(a, b) = system.graph.node(Signal::of(node, false)) {
                work.extend([(a.node(), false), (b.node(), false)]);
            }
        }
    }

    fn evaluate(&mut self, system: &System, value: impl Fn(Signal) -> bool) {
        for at in 0..self.order.len() {
            let Some(node) = self.order.get(at).copied() else { continue };
            let signal = Signal::of(node, false);
            let (value, cost) = match system.graph.node(signal) {
                Node::False => (false, 0),
                Node::Input(_) => (value(signal), 0),
                Node::Latch(_) => (value(signal), 1),
                Node::And(a, b) => {
                    let (x, y) = (self.row(a.node()).cost, self.row(b.node()).cost);
                    match (self.is(a), self.is(b)) {
                        (true, true) => (true, x.saturating_add(y)),
                        (false, false) => (false, x.min(y)),
                        (false, true) => (false, x),
                        (true, false) => (false, y),
                    }
                }
            };
            if let Some(row) = self.rows.get_mut(node as usize) {
                *row = Row { value, cost, needed: false };
            }
        }
    }
}
