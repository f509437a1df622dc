//! The end of a search of states, and the answers that follow from it: the same for each way to search.

use crate::expand::Gap;
use crate::look::{PASSES, replay};
use crate::model::Model;
use crate::question::Claim;
use crate::reason::Reason;
use crate::verdict::{Certificate, Evidence, Open, Run, Verdict};
use crate::world::WAYS;

/// How far a search has come.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Outcome {
    /// Number of states.
    pub states: usize,
    /// Number of scans made.
    pub scans: usize,
    /// All runs of so many scans were seen.
    pub depth: usize,
    /// Why not all runs were seen.
    pub hole: Option<Reason>,
    /// Some scan cleared or ran more than it reports.
    pub cut: bool,
    /// Some scan had more passes than were looked at.
    pub cut_passes: bool,
}

impl Outcome {
    /// Not decided, for this reason.
    pub fn so_far(&self, reason: Reason) -> Open {
        Open { scans: self.depth, states: self.states, reason }
    }

    /// The answer to a claim that a run shows, if the run does the same again.
    pub fn shown(&self, model: &Model<'_>, claim: &Claim, run: Run) -> Verdict {
        if !replay(model, claim, &run) {
            Verdict::Open(self.so_far(Reason::NotRepeated))
        } else if claim.is_of_some_run() {
            Verdict::Proved(Evidence::Run(run))
        } else {
            Verdict::Refuted(Evidence::Run(run))
        }
    }

    /// The answer to a claim that no run has shown, where each state was visited by itself.
    pub fn left_over(&self, claim: &Claim) -> Verdict {
        self.without_run(claim, Certificate::Search { states: self.states, scans: self.scans })
    }

    /// The answer to a claim that no run has shown; the certificate counts if all runs were seen.
    pub(crate) fn without_run(&self, claim: &Claim, certificate: Certificate) -> Verdict {
        let hidden = match claim {
            Claim::Active(_) | Claim::Clears(_) | Claim::Runs(_) => self.cut.then_some(Reason::Reports),
            Claim::NoConflict | Claim::NoUnsafe => self.cut_passes.then_some(Reason::Passes(PASSES)),
            _ => None,
        };
        match self.hole.clone().or(hidden) {
            Some(reason) => Verdict::Open(self.so_far(reason)),
            None if claim.is_of_some_run() => Verdict::Refuted(Evidence::Certificate(certificate)),
            None => Verdict::Proved(Evidence::Certificate(certificate)),
        }
    }
}

/// True if the claim is about states that no run leaves, which only the whole graph shows.
pub fn asks_for_traps(claim: &Claim) -> bool {
    matches!(claim, Claim::NoDeadlock | Claim::LeadsTo { .. })
}

impl Gap {
    /// The reason why a question is not decided that this gap is.
    pub fn reason(&self, model: &Model<'_>) -> Reason {
        match *self {
            Gap::Combinations(count) => Reason::Combinations(count),
            Gap::Values(place) => {
                let addr = g7_engine::Addr(model.compiled.program.tables().inputs.start + place as u32);
                let name = model.compiled.symbols.variable_at(addr).map_or("", |v| &v.name);
                Reason::Values(name.to_owned())
            }
            Gap::Plant(kind) => Reason::Plant(kind),
            Gap::Chance => Reason::Chance(WAYS.into()),
        }
    }
}
