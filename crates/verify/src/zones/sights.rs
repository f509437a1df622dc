//! One scan of one state of a set, with all that the questions look for in it.
//!
//! The states of a set that lie between the same bounds have equal scans. Each scan is made with the
//! least and with the greatest values of the clocks, and what is seen of both must be the same.

use g7_engine::{Fault, FaultKind, Report, StepId, scan};

use crate::explore::Move;
use crate::look::{Passes, Scanned, allowed, passes, shows};
use crate::model::Model;
use crate::monitor::{IDLE, judge_each};
use crate::question::{Claim, Question};
use crate::world::World;

/// The outcome of a scan.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sight {
    report: Result<Report, Fault>,
    /// The transitions that it cleared, by their ranks.
    pub(super) cleared: Vec<u32>,
    ran: Vec<u32>,
    /// The questions of which it shows something, by their numbers.
    pub(super) hits: Vec<usize>,
    /// The questions whose condition has no value.
    pub(super) without: Vec<(usize, FaultKind)>,
    /// It leads on: the situation changes, or what a claim waits for has come.
    pub(super) on: bool,
    /// There were more passes than were looked at.
    pub(super) cut_passes: bool,
    /// Reports were cut.
    pub(super) cut: bool,
}

impl Sight {
    pub(super) fn fault(&self) -> Option<Fault> {
        self.report.err()
    }
}

/// Makes scans.
pub(super) struct Eye<'a> {
    model: &'a Model<'a>,
    /// The charts in hand.
    pub(super) world: World<'a>,
    other: World<'a>,
    /// The claim that remembers something.
    pub(super) memory: Option<&'a Claim>,
}

impl<'a> Eye<'a> {
    pub(super) fn new(model: &'a Model<'a>, memory: Option<&'a Claim>) -> Eye<'a> {
        Eye { model, world: World::new(model), other: World::new(model), memory }
    }

    /// True if the assumptions allow a move of a state.
    pub(super) fn allows(&mut self, image: &[u64], m: &Move) -> bool {
        if self.model.assume.is_empty() {
            return true;
        }
        self.other.put(image);
        let now = self.other.charts.now().saturating_add(m.wait);
        allowed(self.model, &mut self.other, m, now)
    }

    /// Makes a move of the state of an image, and writes the image behind it into `after`, unless there
    /// was a fault. The last word of an image is what the claim remembers.
    pub(super) fn see(
        &mut self,
        image: &[u64],
        m: &Move,
        open: &[(usize, &Question)],
        after: &mut Vec<u64>,
    ) -> Sight {
        let p = &self.model.compiled.program;
        let memory = image.last().copied().unwrap_or(IDLE);
        self.world.put(image);
        let now = self.world.charts.now().saturating_add(m.wait);
        let seen = self.passes(image, m, now, open);
        let active: Vec<StepId> = self.world.charts.active().collect();
        let report = scan(p, &mut self.world.charts, &m.inputs, now);
        let scanned = Scanned { state: &self.world.charts, report };
        let is_shown = |c: &Claim| match c {
            Claim::NoConflict => seen.conflict,
            Claim::NoUnsafe => seen.unsafe_,
            Claim::Asked(_) => false,
            c => shows(p, c, &scanned),
        };
        let hits = open.iter().filter(|(_, q)| is_shown(&q.claim)).map(|(i, _)| *i).collect();
        let (cut, s) = (scanned.is_cut(p), &self.world.charts);
        let mut sight = Sight {
            report,
            cleared: s.cleared().to_vec(),
            ran: s.ran().to_vec(),
            hits,
            without: Vec::new(),
            on: self.memory.is_none(),
            cut_passes: seen.cut,
            cut,
        };
        let Ok(report) = report else { return sight };
        let kept = self.judge(memory, m.wait, open, &mut sight);
        sight.on = match self.memory {
            Some(_) => kept == IDLE,
            None => report.cleared > 0 || !self.world.charts.active().eq(active.iter().copied()),
        };
        self.world.image(after);
        after.push(kept);
        sight
    }

    /// The claims about the ends of scans; gives what is to be remembered.
    fn judge(&mut self, memory: u64, wait: i64, open: &[(usize, &Question)], sight: &mut Sight) -> u64 {
        let claims = open.iter().map(|(i, q)| (*i, &q.claim));
        judge_each(self.model, claims, &mut self.world, memory, wait, |i, seen| match seen {
            Ok(hit) => sight.hits.extend(hit.then_some(i)),
            Err(fault) => sight.without.push((i, fault.kind)),
        })
    }

    fn passes(&mut self, image: &[u64], m: &Move, now: i64, open: &[(usize, &Question)]) -> Passes {
        let wants = |c: &Claim| open.iter().any(|(_, q)| q.claim == *c);
        let conflict = wants(&Claim::NoConflict);
        if !conflict && !wants(&Claim::NoUnsafe) {
            return Passes::default();
        }
        self.other.put(image);
        passes(&self.model.compiled.program, &mut self.other.charts, &m.inputs, now, conflict)
    }
}
