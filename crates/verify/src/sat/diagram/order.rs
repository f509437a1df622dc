//! The order of the variables of a diagram, which decides how large it is.
//!
//! Variables that are read together should stand together. The latches are placed one after the other. The next one
//! is always the latch that brings the fewest new variables; if two are equal, the one that reads more placed ones.
//! Only the first pass of a scan counts as reading: through later passes every latch reads nearly every variable.

use std::collections::BTreeSet;

use crate::sat::graph::{Node, Signal, System};

/// A variable of the system.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Place {
    /// By its place in [`System::latches`].
    Latch(usize),
    /// By its place in [`System::inputs`].
    Input(usize),
}

/// The variables of the part `inside` of a system, in order. `guards` are 0 in a scan of one pass.
pub(super) fn order(system: &System, inside: &[bool], guards: &[Signal]) -> Vec<Place> {
    let known = fixed(system, guards);
    let is_in = |s: Signal| inside.get(s.node() as usize) == Some(&true);
    let latches = system.latches.iter().enumerate().filter(|(_, l)| is_in(l.signal));
    let mut left: Vec<(Place, Vec<Place>)> =
        latches.map(|(k, l)| (Place::Latch(k), read(system, &known, l.next))).collect();
    let mut stands: BTreeSet<Place> = BTreeSet::new();
    let mut list = Vec::new();
    while !left.is_empty() {
        let cost = |(own, reads): &(Place, Vec<Place>)| {
            let new = reads.iter().chain([own]).filter(|p| !stands.contains(p)).count();
            let old = reads.iter().filter(|p| stands.contains(p)).count();
            (new, usize::MAX - old)
        };
        let best = (0..left.len()).min_by_key(|k| left.get(*k).map(cost)).unwrap_or(0);
        let (own, reads) = left.remove(best);
        let new = reads.into_iter().chain([own]).filter(|p| stands.insert(*p));
        list.extend(new);
    }
    let inputs = system.inputs.iter().enumerate().filter(|(_, s)| is_in(**s));
    list.extend(inputs.map(|(k, _)| Place::Input(k)).filter(|p| stands.insert(*p)));
    list
}

/// For each node its value where these signals are 0, if that fixes it.
fn fixed(system: &System, guards: &[Signal]) -> Vec<Option<bool>> {
    let mut known: Vec<Option<bool>> = Vec::with_capacity(system.graph.nodes().len());
    let value = |known: &[Option<bool>], s: Signal| {
        known.get(s.node() as usize).copied().flatten().map(|v| v != s.is_negated())
    };
    let guards: std::collections::HashMap<u32, bool> =
        guards.iter().map(|g| (g.node(), g.is_negated())).collect();
    for (k, node) in (0u32..).zip(system.graph.nodes()) {
        let new = match node {
            _ if guards.contains_key(&k) => guards.get(&k).copied(),
            Node::False => Some(false),
            Node::Input(_) | Node::Latch(_) => None,
            Node::And(a, b) => match (value(&known, *a), value(&known, *b)) {
                (Some(false), _) | (_, Some(false)) => Some(false),
                (Some(true), Some(true)) => Some(true),
                _ => None,
            },
        };
        known.push(new);
    }
    known
}

/// The variables that a function reads, in the order in which a walk meets them.
fn read(system: &System, known: &[Option<bool>], root: Signal) -> Vec<Place> {
    let (mut seen, mut list, mut work) = (BTreeSet::new(), Vec::new(), vec![root.node()]);
    while let Some(n) = work.pop() {
        if known.get(n as usize).copied().flatten().is_some() || !seen.insert(n) {
            continue;
        }
        match system.graph.nodes().get(n as usize) {
            Some(Node::And(a, b)) => work.extend([b.node(), a.node()]),
            Some(Node::Input(i)) => list.push(Place::Input(*i as usize)),
            Some(Node::Latch(l)) => list.push(Place::Latch(*l as usize)),
            Some(Node::False) | None => {}
        }
    }
    list
}
