//! The end of a search of states, and the answers that follow from it: the same words for each way to search.

use crate::expand::Gap;
use crate::look::{PASSES, replay};
use crate::model::Model;
use crate::question::Claim;
use crate::verdict::{Certificate, Evidence, Open, Run, Verdict};

/// A reason, and a way out.
pub type Why = (String, String);

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
    pub hole: Option<Why>,
    /// Some scan cleared or ran more than it reports.
    pub cut: bool,
    /// Some scan had more passes than were looked at.
    pub cut_passes: bool,
}

impl Outcome {
    /// Not decided, for this reason.
    pub fn open(&self, (reason, help): Why) -> Verdict {
        Verdict::Open(Open { scans: self.depth, states: self.states, reason, help })
    }

    /// The answer to a claim that a run shows, if the run does the same again.
    pub fn shown(&self, model: &Model<'_>, claim: &Claim, run: Run) -> Verdict {
        if !replay(model, claim, &run) {
            let help = "please report this: search and engine do not agree".to_owned();
            self.open(("the run that was found does not show it again".to_owned(), help))
        } else if claim.is_of_some_run() {
            Verdict::Proved(Evidence::Run(run))
        } else {
            Verdict::Refuted(Evidence::Run(run))
        }
    }

    /// The answer to a claim with a condition that has this fault.
    pub fn unclear(&self, fault: &str) -> Verdict {
        let reason = format!("a condition of this property cannot be evaluated: {fault}");
        self.open((reason, "guard it, as in `n > 0 and x / n > 2`, with a condition of its own".to_owned()))
    }

    /// The answer to a claim that no run has shown.
    pub fn left_over(&self, claim: &Claim) -> Verdict {
        let cut = || ("a scan does more than it reports".to_owned(), String::new());
        let cut_passes = || {
            let help = "make every evolution end first, with an edge (`↑a`) or a step that waits";
            (format!("a scan has more than {PASSES} passes"), help.to_owned())
        };
        let hidden = match claim {
            Claim::Active(_) | Claim::Clears(_) | Claim::Runs(_) => self.cut.then(cut),
            Claim::NoConflict | Claim::NoUnsafe => self.cut_passes.then(cut_passes),
            _ => None,
        };
        let certificate = Certificate::Search { states: self.states, scans: self.scans };
        match self.hole.clone().or(hidden) {
            Some(why) => self.open(why),
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
    /// The gap in words.
    pub fn why(&self, model: &Model<'_>) -> Why {
        match self {
            Gap::Combinations(count) => (
                format!("{count} inputs matter at once, in more combinations than are tried"),
                "assume what the environment keeps, such as limit switches that exclude each other"
                    .to_owned(),
            ),
            Gap::Values(place) => {
                let p = &model.compiled.program;
                let addr = g7_engine::Addr(p.tables().inputs.start + *place as u32);
                let name = model.compiled.symbols.variable_at(addr).map_or("", |v| &v.name);
                let help = "compare it with constants only, or give it a smaller type".to_owned();
                (format!("the input `{name}` takes more values than are tried"), help)
            }
            Gap::Plant(kind) => (
                format!("the plant has a fault: {kind}"),
                "mend the plant: what the chart does behind its fault is not known".to_owned(),
            ),
        }
    }
}

/// No input satisfies the assumptions behind so many scans.
pub fn stuck_behind(depth: usize) -> Why {
    let place = if depth == 0 { "at the start".to_owned() } else { format!("behind a run of {depth} scans") };
    let help = "weaken the assumptions: without inputs there are no runs, and every claim would hold";
    (format!("no input satisfies the assumptions {place}"), help.to_owned())
}

/// There are more states than are allowed.
pub fn too_many(states: usize) -> Why {
    (format!("there are more than {states} states"), more("--states"))
}

/// The states need more than so many bytes.
pub fn too_large(bytes: usize) -> Why {
    (format!("the states need more than {} MiB", bytes >> 20), more("--memory"))
}

/// The time is over, or the user has stopped the search.
pub fn halted() -> Why {
    ("the search was stopped".to_owned(), more("--time"))
}

pub(crate) fn more(option: &str) -> String {
    format!("allow more with {option}, or assume what the environment keeps")
}
