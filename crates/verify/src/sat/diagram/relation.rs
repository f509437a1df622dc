//! The states behind one scan of a set of states.
//!
//! Each latch has a relation between state, inputs and its next value. Small relations are joined. A variable is
//! quantified away after the last relation that reads it.

use std::collections::{BTreeMap, BTreeSet};

use g7_sat::diagram::{Function, Renaming};

use super::functions::{Functions, Stop};

/// Nodes of the largest relation that several latches share.
const JOINED: usize = 1000;

/// A relation, and the variables that are quantified away after it.
struct Part {
    relation: Function,
    gone: Function,
}

/// The scans of a system.
pub(super) struct Relation {
    /// The constraints.
    pub(super) valid: Function,
    parts: Vec<Part>,
    /// Variables that no part reads.
    free: Function,
    /// The names of the next values become those of the values.
    back: Renaming,
    /// All inputs.
    pub(super) inputs: Function,
}

impl Relation {
    /// From functions that were made of all latches and constraints.
    pub(super) fn new(f: &Functions<'_>) -> Result<Relation, Stop> {
        let relations = joined(f)?;
        let next: BTreeSet<u32> = f.latches.values().map(|v| v + 1).collect();
        let mut last: BTreeMap<u32, usize> = BTreeMap::new();
        for (k, relation) in relations.iter().enumerate() {
            read(relation).into_iter().filter(|v| !next.contains(v)).for_each(|v| {
                last.insert(v, k);
            });
        }
        let parts = relations.into_iter().enumerate().map(|(k, relation)| {
            let gone = last.iter().filter(|(_, at)| **at == k).map(|(v, _)| *v);
            Ok(Part { relation, gone: f.list(gone)? })
        });
        let parts = parts.collect::<Result<Vec<Part>, Stop>>()?;
        let own: BTreeSet<u32> = f.latches.values().chain(f.inputs.values()).copied().collect();
        let free = f.list(own.into_iter().filter(|v| !last.contains_key(v)))?;
        let pairs: Vec<(u32, u32)> = f.latches.values().map(|v| (v + 1, *v)).collect();
        let inputs: BTreeSet<u32> = f.inputs.values().copied().collect();
        Ok(Relation {
            valid: f.valid()?,
            parts,
            free,
            back: f.diagrams.renaming(&pairs)?,
            inputs: f.list(inputs.into_iter())?,
        })
    }

    /// The states behind one scan of these.
    pub(super) fn image(&self, f: &Functions<'_>, from: &Function) -> Result<Function, Stop> {
        let start = from.and_exists(&self.valid, &self.free)?;
        let reached = self.parts.iter().try_fold(start, |set, part| {
            f.look()?;
            Ok::<_, Stop>(set.and_exists(&part.relation, &part.gone)?)
        })?;
        Ok(reached.renamed(&self.back)?)
    }
}

/// The relations of the latches in the order of their variables, joined while they are small.
fn joined(f: &Functions<'_>) -> Result<Vec<Function>, Stop> {
    let mut order: Vec<(u32, usize)> = f.latches.iter().map(|(l, v)| (*v, *l)).collect();
    order.sort_unstable();
    let mut relations: Vec<Function> = Vec::new();
    for (variable, latch) in order {
        f.look()?;
        let Some(latch) = f.system.latches.get(latch) else { continue };
        let next = f.diagrams.variable(variable + 1)?;
        let one = next.choose(&f.get(latch.next)?, &f.get(!latch.next)?)?;
        let both = match relations.last() {
            Some(before) => Some(before.and(&one)?).filter(|both| both.nodes() <= JOINED),
            None => None,
        };
        match (both, relations.last_mut()) {
            (Some(both), Some(last)) => *last = both,
            _ => relations.push(one),
        }
    }
    Ok(relations)
}

/// The variables that a function depends on.
fn read(f: &Function) -> BTreeSet<u32> {
    let (mut seen, mut found) = (std::collections::HashSet::from([f.clone()]), BTreeSet::new());
    let mut work = vec![f.clone()];
    while let Some((variable, one, zero)) = work.pop().map(|f| f.branches()).into_iter().flatten().next() {
        found.insert(variable);
        work.extend([one, zero].into_iter().filter(|g| g.branches().is_some() && seen.insert(g.clone())));
    }
    found
}
