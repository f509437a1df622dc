//! Function blocks: those that the controller's own ones stand for, and those
//! that are printed as assignments.

use std::collections::{HashMap, HashSet};

use g7_engine::Block;
use g7_equations::{Equations, MemoryId, Stmt, What};

use crate::spare::{expanded, operands, sections};

/// The instances that a controller's own function blocks stand for: what they
/// remember inside is mentioned in their calls alone, and in the count of time.
/// Gives the memories that the controller keeps; the others are assignments. A controller without these
/// blocks (`own_blocks` is false) keeps none.
pub(crate) fn native(e: &mut Equations, own_blocks: bool) -> HashSet<MemoryId> {
    let mut inside: HashMap<MemoryId, Vec<MemoryId>> = HashMap::new();
    for s in e.sections().flat_map(|s| &s.body) {
        s.visit(&mut |s| {
            if let Stmt::Call(block, list) = s {
                let own = list.get(members(*block)..).unwrap_or_default();
                if let Some(first) = list.first() {
                    inside.insert(*first, own.to_vec());
                }
            }
        });
    }
    let mut elsewhere: HashSet<MemoryId> = HashSet::new();
    // The first section counts the time.
    let others = e.begin.iter().skip(1).chain(&e.pass).chain(&e.finish).flat_map(|s| &s.body);
    for s in others {
        s.visit(&mut |s| {
            s.expressions(&mut |x| elsewhere.extend(operands(x)));
            match s {
                Stmt::Set(m, _) | Stmt::SetElement(m, _, _) => drop(elsewhere.insert(*m)),
                _ => {}
            }
        });
    }
    let copies: HashSet<MemoryId> = e
        .memories
        .iter()
        .filter_map(|m| match m.what {
            What::Own(of) | What::Given(of) | What::Begun(of) => Some(of),
            _ => None,
        })
        .collect();
    let plain = |m: &MemoryId| {
        e.memory(*m).is_some_and(|m| matches!(m.what, What::Variable(_) | What::BlockClock(_)))
            && !elsewhere.contains(m)
            && !copies.contains(m)
    };
    let first_is_plain = |m: &MemoryId| e.memory(*m).is_some_and(|m| matches!(m.what, What::Variable(_)));
    let kept: HashMap<MemoryId, Vec<MemoryId>> = inside
        .into_iter()
        .filter(|(first, own)| {
            own_blocks && first_is_plain(first) && !copies.contains(first) && own.iter().all(plain)
        })
        .collect();
    let firsts: HashSet<MemoryId> = kept.keys().copied().collect();
    for s in sections(e) {
        let stays = |m: &[MemoryId]| m.first().is_some_and(|m| firsts.contains(m));
        s.body = expanded(std::mem::take(&mut s.body), &stays);
    }
    kept.into_values().flatten().collect()
}

/// The words of an instance that have names.
pub(crate) fn members(block: Block) -> usize {
    match block {
        Block::Ctu | Block::Ctd => 5,
        Block::Ctud => 8,
        Block::Ton | Block::Tof | Block::Tp => 4,
        Block::RTrig | Block::FTrig => 2,
        Block::Sr | Block::Rs => 3,
    }
}
