//! Parts of a chart to which no way leads from where it begins, for instance behind a transition that was
//! deleted. Such a part keeps its place behind the sequence after which it stands in the text: the graph
//! gets a gap there, of the room of the symbols that are missing, and nothing is drawn in it.
//!
//! ```text
//! links of the chart -> gaps -> Graph
//! ```
//!
//! Invariant: a chart of which every part can be reached has no gaps.

use g7_model::{Step, StepKind};

use crate::layout::lists::Lists;

/// A chart with more loose parts than this is not one from which something was cut; its parts stand beside one
/// another.
const MOST: usize = 64;

/// Missing symbols between nodes without a way on and nodes without a way in. The nodes have the numbers of the
/// chart: steps first, then transitions.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Gap {
    /// Steps, or transitions.
    pub(crate) from: Vec<u32>,
    /// Steps.
    pub(crate) to: Vec<u32>,
}

/// A part to which no way leads.
struct Part {
    nodes: Vec<u32>,
    /// The steps at which it begins.
    heads: Vec<u32>,
    /// Its first step in the order of the text.
    first: u32,
    /// The nodes that can be reached to which it leads back.
    returns: Vec<u32>,
    /// True if one of its steps becomes active by itself or from outside.
    begins: bool,
}

/// A step or transition from which no link leads on, or the last step of a loop without a way out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct End {
    /// The last step in the text that leads to it.
    place: u32,
    node: u32,
    /// True if it has ways on that all lead back to it.
    in_loop: bool,
}

fn begins(step: &Step) -> bool {
    step.initial || step.linked || step.kind == StepKind::Entry
}

struct Chart<'a> {
    steps: &'a [&'a Step],
    links: &'a [(u32, u32)],
    out: Lists,
    into: Lists,
    nodes: usize,
}

/// The gaps of a chart, in the order of the text.
#[inline(never)]
pub(crate) fn gaps(steps: &[&Step], nodes: usize, links: &[(u32, u32)]) -> Vec<Gap> {
    let out = Lists::new(nodes, links.iter().map(|l| l.0));
    let into = Lists::new(nodes, links.iter().map(|l| l.1));
    let chart = Chart { steps, links, out, into, nodes };
    let reached = chart.reached();
    if reached.iter().all(|r| *r) {
        return Vec::new();
    }
    let parts = chart.parts(&reached);
    if parts.len() > MOST {
        return Vec::new();
    }
    let ends = chart.ends();
    let mut gaps = Vec::new();
    for part in parts {
        let from = chart.before(&part, &ends);
        if from.is_empty() {
            continue;
        }
        // Simultaneous sequences come together in one transition later on, alternatives do not.
        let joined = part.nodes.iter().any(|n| !chart.is_step(*n) && chart.into.of(*n).len() > 1);
        if joined {
            gaps.push(Gap { from, to: part.heads });
        } else {
            gaps.extend(part.heads.iter().map(|h| Gap { from: from.clone(), to: vec![*h] }));
        }
    }
    gaps
}

impl Chart<'_> {
    fn is_step(&self, n: u32) -> bool {
        (n as usize) < self.steps.len()
    }

    fn next(&self, n: u32) -> impl Iterator<Item = u32> {
        self.out.of(n).iter().map(|l| self.links[*l as usize].1)
    }

    fn previous(&self, n: u32) -> impl Iterator<Item = u32> {
        self.into.of(n).iter().map(|l| self.links[*l as usize].0)
    }

    /// The nodes to which ways lead from these.
    fn onward(&self, seeds: impl Iterator<Item = u32>) -> Vec<bool> {
        let mut reached = vec![false; self.nodes];
        let mut stack: Vec<u32> = seeds.collect();
        while let Some(n) = stack.pop() {
            if !std::mem::replace(&mut reached[n as usize], true) {
                stack.extend(self.next(n));
            }
        }
        reached
    }

    /// The nodes from which ways lead to these.
    fn backward(&self, seeds: impl Iterator<Item = u32>) -> Vec<bool> {
        let mut reached = vec![false; self.nodes];
        let mut stack: Vec<u32> = seeds.collect();
        while let Some(n) = stack.pop() {
            if !std::mem::replace(&mut reached[n as usize], true) {
                stack.extend(self.previous(n));
            }
        }
        reached
    }

    /// The nodes to which ways lead from where the chart begins: at the first of the steps that become active by
    /// themselves or from outside, otherwise at its first step, and at source transitions.
    fn reached(&self) -> Vec<bool> {
        let sources = (self.steps.len() as u32..self.nodes as u32).filter(|t| self.into.of(*t).is_empty());
        self.onward(sources.chain(self.first()))
    }

    fn first(&self) -> Option<u32> {
        let first = self.steps.iter().position(|s| begins(s)).unwrap_or(0) as u32;
        (!self.steps.is_empty()).then_some(first)
    }

    /// The nodes without a way on, and the last step of each loop without a way out, in the order of the text.
    fn ends(&self) -> Vec<End> {
        let open = |n: &u32| self.out.of(*n).is_empty();
        let steps = (0..).zip(self.steps).filter(|(n, s)| open(n) && s.kind != StepKind::Exit);
        let mut ends: Vec<End> = steps.map(|(n, _)| End { place: n, node: n, in_loop: false }).collect();
        for t in (self.steps.len() as u32..self.nodes as u32).filter(open) {
            ends.extend(self.previous(t).max().map(|s| End { place: s, node: t, in_loop: false }));
        }
        let closed = self.closed_loops().into_iter();
        ends.extend(closed.map(|s| End { place: s, node: s, in_loop: true }));
        ends.sort_unstable();
        ends
    }

    /// The last step, in the order of the text, of each loop without a way out in which the chart does not begin.
    fn closed_loops(&self) -> Vec<u32> {
        let open = (0..self.nodes as u32).filter(|n| self.out.of(*n).is_empty());
        let mut done = self.backward(open.chain(self.first()));
        let mut found = Vec::new();
        for step in (0..self.steps.len() as u32).rev() {
            if done[step as usize] {
                continue;
            }
            let (ways, back) = (self.onward(self.next(step)), self.backward([step].into_iter()));
            if ways[step as usize] && ways.iter().zip(&back).all(|(way, back)| *back || !way) {
                found.push(step);
                done.iter_mut().zip(back).for_each(|(to, of)| *to |= of);
            }
        }
        found
    }

    fn parts(&self, reached: &[bool]) -> Vec<Part> {
        let mut seen = reached.to_vec();
        let mut parts = Vec::new();
        for first in 0..self.steps.len() as u32 {
            if seen[first as usize] {
                continue;
            }
            let (mut nodes, mut stack, mut returns) = (Vec::new(), vec![first], Vec::new());
            while let Some(n) = stack.pop() {
                if !std::mem::replace(&mut seen[n as usize], true) {
                    nodes.push(n);
                    returns.extend(self.next(n).filter(|o| reached[*o as usize]));
                    let around = self.next(n).chain(self.previous(n));
                    stack.extend(around.filter(|o| !reached[*o as usize]));
                }
            }
            nodes.sort_unstable();
            let heads = self.heads(&nodes);
            let begins = nodes.iter().any(|n| self.steps.get(*n as usize).is_some_and(|s| begins(s)));
            parts.push(Part { nodes, heads, first, returns, begins });
        }
        parts
    }

    /// The steps at which a part begins: those without a way in, and the first one of each loop that has none.
    fn heads(&self, nodes: &[u32]) -> Vec<u32> {
        let mut heads: Vec<u32> = nodes.iter().copied().filter(|n| self.into.of(*n).is_empty()).collect();
        let mut seen = self.onward(heads.iter().copied());
        for &n in nodes.iter().filter(|n| self.is_step(**n)) {
            if !seen[n as usize] {
                heads.push(n);
                let more = self.onward([n].into_iter());
                seen.iter_mut().zip(more).for_each(|(to, of)| *to |= of);
            }
        }
        heads.sort_unstable();
        heads
    }

    /// The nodes without a way on after which a part stands in the text.
    fn before(&self, part: &Part, ends: &[End]) -> Vec<u32> {
        let mut above =
            ends.get(..ends.partition_point(|e| e.place < part.first)).unwrap_or_default().to_vec();
        above.retain(|e| !e.in_loop || self.needs(e.node, part));
        let Some(&last) = above.last() else { return Vec::new() };
        // A part without any link to the rest may be a chart of its own, unless it follows at once.
        if part.returns.is_empty() && (part.begins || last.place + 1 != part.first) {
            return Vec::new();
        }
        // Alternatives that led to a step which has gone, or simultaneous sequences that were joined.
        let alike = |e: &&End| self.is_step(e.node) == self.is_step(last.node);
        let mut from: Vec<u32> = above.iter().filter(alike).map(|e| e.node).collect();
        if from.len() > 1 && self.is_step(last.node) {
            let beside = self.beside(last.node);
            from.retain(|n| *n == last.node || beside[*n as usize]);
        }
        from
    }

    /// True if a part leads to where no other way leads from a step.
    fn needs(&self, step: u32, part: &Part) -> bool {
        let ways = self.onward([step].into_iter());
        part.returns.iter().any(|n| !ways[*n as usize])
    }

    /// The nodes in sequences that are simultaneous with the one in which a step stands.
    fn beside(&self, step: u32) -> Vec<bool> {
        let mut beside = vec![false; self.nodes];
        for fork in self.steps.len() as u32..self.nodes as u32 {
            if self.out.of(fork).len() < 2 {
                continue;
            }
            let branches: Vec<Vec<bool>> = self.next(fork).map(|n| self.onward([n].into_iter())).collect();
            if branches.iter().any(|b| b[step as usize]) {
                let others = branches.iter().filter(|b| !b[step as usize]);
                others.for_each(|b| beside.iter_mut().zip(b).for_each(|(to, of)| *to |= of));
            }
        }
        beside
    }
}
