//! Findings of a search become answers: runs that show something, states that nothing leaves, and at the end all
//! that is left over.

use super::Search;
use crate::expand::Shown;
use crate::explore::Move;
use crate::monitor::IDLE;
use crate::outcome::{Outcome, asks_for_traps};
use crate::reason::Reason;
use crate::verdict::{Run, Verdict};

impl<'a> Search<'a> {
    /// Answers a question that a scan shows.
    pub(super) fn settle(&mut self, at: usize, m: &Move, way: u8, shown: &Shown) {
        match *shown {
            Shown::Run { question, fault } => {
                let mut run = self.path(at);
                run.moves.push(m.clone());
                if !self.ways.is_empty() {
                    run.ways.push(way);
                }
                run.fault = fault;
                self.show(question, run);
            }
            Shown::Unclear { question, fault } => {
                let open = self.outcome().so_far(Reason::Condition(fault.kind));
                self.give(question, Verdict::Open(open));
            }
        }
    }

    /// Answers a question with a run, if the run does the same again.
    fn show(&mut self, i: usize, run: Run) {
        let Some((_, q)) = self.open.iter().find(|(n, _)| *n == i) else { return };
        let claim = &q.claim;
        let verdict = self.outcome().shown(self.model, claim, run);
        self.give(i, verdict);
    }

    pub(super) fn give(&mut self, i: usize, verdict: Verdict) {
        self.open.retain(|(n, _)| *n != i);
        self.answers.push((i, verdict));
    }

    /// True before the first scan of all, which is at time 0.
    pub(super) fn is_first(&self, at: usize) -> bool {
        at == 0 && self.start.is_empty()
    }

    /// The run that leads to a state from the beginning of the search.
    pub(crate) fn path(&self, mut at: usize) -> Run {
        let (mut moves, mut ways) = (Vec::new(), Vec::new());
        while at > 0 {
            ways.extend(self.ways.get(at).copied());
            let before = self.parents.get(at).copied().unwrap_or(0) as usize;
            let wait = if self.is_first(before) { 0 } else { self.model.period };
            let mut inputs = Vec::new();
            self.inputs.get(at, &mut inputs);
            moves.push(Move { inputs, wait });
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
            *on |= self.memory.is_some() && self.store.last_word(at) == Some(IDLE);
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
        let Some(mut expander) = self.expander.take() else { return };
        // Other parts are only at rest here, so they need not be at an end when this one is.
        let is_part = self.within.is_some();
        let mut is_end = |at: usize| !is_part && expander.is_end(&self.store.image(at));
        if let Some(at) = bad.into_iter().find(|at| self.memory.is_some() || !is_end(*at)) {
            self.show(i, self.path(at));
        }
    }

    /// Answers what is left over.
    pub(super) fn close(&mut self) {
        let end = self.outcome();
        for (i, q) in std::mem::take(&mut self.open) {
            self.answers.push((i, end.left_over(&q.claim)));
        }
    }

    /// How far the search has come.
    pub(super) fn outcome(&self) -> Outcome {
        Outcome {
            states: self.store.len(),
            scans: self.scans,
            depth: self.depth,
            hole: self.hole.clone(),
            cut: self.cut,
            cut_passes: self.cut_passes,
        }
    }
}
