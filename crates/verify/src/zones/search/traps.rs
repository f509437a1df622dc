//! States from which no run leads on: deadlocks, or causes without their effect.
//!
//! A node may have states that lead on and others that do not, and a move of a part of it may end in a part
//! of another. So there are two questions. A node is *good* where each part has inputs with which each
//! of its states leads on, at once or by a node that is good: then every state of it is. A node is *bad* where
//! nothing that is tried in any part leads on, and all nodes behind it are bad: then every state of it is a trap.
//! A node that is neither is not decided.
//!
//! In a part that a move leads back to the same node because time goes on in it, the move cannot be made for ever:
//! some clock meets its bound. So this part is good if all others of the node are, and there are others.

use super::Search;
use crate::monitor::IDLE;
use crate::outcome::asks_for_traps;
use crate::question::Claim;
use crate::reason::Reason;
use crate::verdict::Verdict;
use crate::world::World;
use crate::zones::turns::Moves;

impl Search<'_> {
    /// Answers the question that asks for traps.
    pub(super) fn traps(&mut self) {
        let Some((i, q)) = self.open.iter().find(|(_, q)| asks_for_traps(&q.claim)).copied() else { return };
        let waits_for = matches!(q.claim, Claim::LeadsTo { .. });
        // With a claim that waits, a state in which it waits for nothing is good at once.
        let done: Vec<bool> = (0..self.graph.nodes.len())
            .map(|n| if waits_for { self.graph.image(n).last() == Some(&IDLE) } else { false })
            .collect();
        let good = self.good(&done);
        let mut world = World::new(self.model);
        let mut ends = |n: usize| !waits_for && self.is_end(n, &mut world);
        let left: Vec<usize> =
            self.graph.met().filter(|n| good.get(*n) == Some(&false) && !ends(*n)).collect();
        if left.is_empty() {
            return;
        }
        let bad = self.bad(&done);
        let trap = left.into_iter().find(|n| bad.get(*n) == Some(&true));
        let node = trap.and_then(|n| self.graph.nodes.get(n).map(|node| (n, node)));
        match node.and_then(|(n, node)| self.graph.run(n as u32, &node.zone, self.model.period)) {
            Some(run) => self.show(i, &run),
            None => {
                let open = self.outcome().so_far(Reason::ManyTimes);
                self.give(i, Verdict::Open(open));
            }
        }
    }

    /// The nodes of which every state leads on.
    fn good(&self, done: &[bool]) -> Vec<bool> {
        let mut good = done.to_vec();
        loop {
            let mut changed = false;
            // Nodes that lead on stand mostly behind those that they make good.
            for n in self.graph.met().collect::<Vec<_>>().into_iter().rev() {
                if good.get(n) == Some(&true) {
                    continue;
                }
                let parts = self.turns.get(n).map_or(&[][..], |t| &t.parts);
                let leads = |p: &&Moves| {
                    p.on || p.to.iter().any(|to| {
                        let to = self.graph.resolved(*to) as usize;
                        to != n && good.get(to) == Some(&true)
                    })
                };
                let by_waiting = |p: &&Moves| !leads(p) && p.waits;
                let others = parts.iter().filter(|p| !by_waiting(p)).count();
                let is_good = others > 0 && parts.iter().filter(|p| !by_waiting(p)).all(|p| leads(&p));
                if is_good {
                    good.get_mut(n).into_iter().for_each(|g| *g = true);
                    changed = true;
                }
            }
            if !changed {
                return good;
            }
        }
    }

    /// The nodes of which no state leads on.
    fn bad(&self, done: &[bool]) -> Vec<bool> {
        let mut bad: Vec<bool> = done.iter().map(|d| !d).collect();
        loop {
            let mut changed = false;
            for n in self.graph.met().collect::<Vec<_>>() {
                if bad.get(n) != Some(&true) {
                    continue;
                }
                let parts = self.turns.get(n).map_or(&[][..], |t| &t.parts);
                let on = |to: &u32| bad.get(self.graph.resolved(*to) as usize) != Some(&true);
                if parts.iter().any(|p| p.on || p.to.iter().any(on)) {
                    bad.get_mut(n).into_iter().for_each(|b| *b = false);
                    changed = true;
                }
            }
            if !changed {
                return bad;
            }
        }
    }

    /// True if no active step has a transition behind it. `world` is room for the state.
    fn is_end(&self, node: usize, world: &mut World<'_>) -> bool {
        world.put(&self.graph.image(node));
        world.charts.active().all(|step| self.asking.behind(step) == 0)
    }
}
