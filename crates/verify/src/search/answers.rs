//! Findings of a search become answers: runs that show something, states that nothing leaves, and at the end all
//! that is left over.

use g7_engine::Fault;

use super::Search;
use crate::explore::Move;
use crate::look::{PASSES, replay};
use crate::monitor::{IDLE, has_memory, is_of_scans, judge};
use crate::question::Claim;
use crate::reason::Reason;
use crate::verdict::{Certificate, Evidence, Open, Run, Verdict};
use crate::world::World;

impl<'a> Search<'a> {
    /// Judges the claims about the end of a scan; gives what is to be remembered, or nothing
    /// where the search need not go on.
    pub(super) fn judge(&mut self, at: usize, world: &mut World<'a>, memory: u64, m: &Move) -> Option<u64> {
        let mut hits = Vec::new();
        let mut kept = IDLE;
        let open = self.open.clone();
        for (i, q) in open.iter().filter(|(_, q)| is_of_scans(&q.claim)) {
            match judge(self.model, &q.claim, world, memory, m.wait) {
                Ok(seen) => {
                    hits.extend(seen.hit.then_some(*i));
                    kept = if has_memory(&q.claim) { seen.memory } else { kept };
                }
                Err(fault) => {
                    self.give(*i, Verdict::Open(self.so_far(Reason::Condition(fault.kind))));
                }
            }
        }
        if !hits.is_empty() {
            self.settle_those(at, m, None, &hits);
        }
        Some(kept).filter(|_| self.goes_on())
    }

    /// Answers the open questions that a scan shows.
    pub(super) fn settle(
        &mut self,
        at: usize,
        m: &Move,
        fault: Option<Fault>,
        is_shown: impl Fn(&Claim) -> bool,
    ) {
        let hits: Vec<usize> =
            self.open.iter().filter(|(_, q)| is_shown(&q.claim)).map(|(i, _)| *i).collect();
        if !hits.is_empty() {
            self.settle_those(at, m, fault, &hits);
        }
    }

    pub(super) fn settle_those(&mut self, at: usize, m: &Move, fault: Option<Fault>, hits: &[usize]) {
        let mut run = self.path(at);
        run.moves.push(m.clone());
        if !self.ways.is_empty() {
            run.ways.push(self.way);
        }
        run.fault = fault;
        for i in hits {
            self.show(*i, run.clone());
        }
    }

    /// Answers a question with a run, if the run does the same again.
    fn show(&mut self, i: usize, run: Run) {
        let Some((_, q)) = self.open.iter().find(|(n, _)| *n == i) else { return };
        let claim = &q.claim;
        let verdict = if !replay(self.model, claim, &run) {
            Verdict::Open(self.so_far(Reason::NotRepeated))
        } else if claim.is_of_some_run() {
            Verdict::Proved(Evidence::Run(run))
        } else {
            Verdict::Refuted(Evidence::Run(run))
        };
        self.give(i, verdict);
    }

    pub(super) fn give(&mut self, i: usize, verdict: Verdict) {
        self.open.retain(|(n, _)| *n != i);
        self.answers.push((i, verdict));
    }

    /// The time before the next scan behind a state: the first scan of all is at time 0.
    pub(super) fn wait(&self, at: usize) -> i64 {
        if at == 0 && self.start.is_empty() { 0 } else { self.model.period }
    }

    /// The run that leads to a state from the beginning of the search.
    pub(crate) fn path(&self, mut at: usize) -> Run {
        let count = self.asking.count();
        let (mut moves, mut ways) = (Vec::new(), Vec::new());
        while at > 0 {
            ways.extend(self.ways.get(at).copied());
            let before = self.parents.get(at).copied().unwrap_or(0) as usize;
            let inputs = self.inputs.get(at * count..(at + 1) * count).unwrap_or(&[]).to_vec();
            moves.push(Move { inputs, wait: self.wait(before) });
            at = before;
        }
        moves.reverse();
        ways.reverse();
        Run { moves, ways, fault: None }
    }

    /// Finds the states from which no run leads on: deadlocks, or causes without their effect.
    pub(super) fn traps(&mut self) {
        let Some(i) = self.open.iter().find(|(_, q)| asks_for_traps(&q.claim)).map(|(i, _)| *i) else {
            return;
        };
        let mut back: Vec<(u32, u32)> = self.edges.iter().map(|(from, to)| (*to, *from)).collect();
        back.sort_unstable();
        let mut good = self.leads_on.clone();
        for (at, on) in good.iter_mut().enumerate() {
            *on |= self.memory.is_some() && self.store.image(at).last() == Some(&IDLE);
        }
        let mut work: Vec<u32> = (0u32..).zip(&good).filter(|(_, g)| **g).map(|(at, _)| at).collect();
        while let Some(at) = work.pop() {
            let first = back.partition_point(|(to, _)| *to < at);
            for (_, from) in back.iter().skip(first).take_while(|(to, _)| *to == at) {
                if let Some(g) = good.get_mut(*from as usize).filter(|g| !**g) {
                    *g = true;
                    work.push(*from);
                }
            }
        }
        let bad: Vec<usize> = good.iter().enumerate().filter(|(_, g)| !**g).map(|(at, _)| at).collect();
        if let Some(at) = bad.into_iter().find(|at| self.memory.is_some() || !self.is_end(*at)) {
            self.show(i, self.path(at));
        }
    }

    /// True if no active step has a transition behind it.
    fn is_end(&self, at: usize) -> bool {
        let mut world = World::new(self.model);
        world.put(self.store.image(at).get(..self.width).unwrap_or(&[]));
        world.charts.active().all(|step| self.asking.behind(step) == 0)
    }

    /// Answers what is left over.
    pub(super) fn close(&mut self) {
        let certificate = Certificate::Search { states: self.store.len(), scans: self.scans };
        for (i, q) in std::mem::take(&mut self.open) {
            let hidden = match &q.claim {
                Claim::Active(_) | Claim::Clears(_) | Claim::Runs(_) => self.cut.then_some(Reason::Reports),
                Claim::NoConflict | Claim::NoUnsafe => self.cut_passes.then_some(Reason::Passes(PASSES)),
                _ => None,
            };
            let verdict = match self.hole.clone().or(hidden) {
                Some(reason) => Verdict::Open(self.so_far(reason)),
                None if q.claim.is_of_some_run() => {
                    Verdict::Refuted(Evidence::Certificate(certificate.clone()))
                }
                None => Verdict::Proved(Evidence::Certificate(certificate.clone())),
            };
            self.answers.push((i, verdict));
        }
    }

    pub(super) fn so_far(&self, reason: Reason) -> Open {
        Open { scans: self.depth, states: self.store.len(), reason }
    }
}

fn asks_for_traps(claim: &Claim) -> bool {
    matches!(claim, Claim::NoDeadlock | Claim::LeadsTo { .. })
}
