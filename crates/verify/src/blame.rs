//! The steps and transitions that take part in what the last scan of a run shows.

use g7_engine::{Program, State, StepId, scan};

use crate::look::{At, conflict, each_pass, sides, twice};
use crate::model::Model;
use crate::question::Claim;
use crate::verdict::Run;

/// The parts of a chart that a run shows at its end.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Blame {
    /// Steps, ascending.
    pub steps: Vec<StepId>,
    /// Ranks of transitions, ascending.
    pub transitions: Vec<u32>,
}

impl Blame {
    fn new(steps: impl IntoIterator<Item = u32>, transitions: impl IntoIterator<Item = u32>) -> Blame {
        let (mut steps, mut transitions): (Vec<StepId>, Vec<u32>) =
            (steps.into_iter().map(StepId).collect(), transitions.into_iter().collect());
        steps.sort_unstable();
        steps.dedup();
        transitions.sort_unstable();
        transitions.dedup();
        Blame { steps, transitions }
    }
}

/// The parts that the last scan of a run is about. For a conflict these are the two transitions and
/// the steps that they share; for a step that is activated twice, it and the transition; where
/// nothing leads on, the steps that are active; else the transitions that cleared in the last scan
/// and, if there was none, the active steps. Empty for a run without scans.
pub fn blame(model: &Model<'_>, claim: &Claim, run: &Run) -> Blame {
    let p: &Program = &model.compiled.program;
    let Some((last, before)) = run.moves.split_last() else { return Blame::default() };
    let mut s = State::new(p);
    for m in before {
        let now = s.now().saturating_add(m.wait);
        if scan(p, &mut s, &m.inputs, now).is_err() {
            return Blame::default();
        }
    }
    let now = s.now().saturating_add(last.wait);
    if let Some(found) = passes(p, &mut s.clone(), &last.inputs, now, claim) {
        return found;
    }
    // A fault is told by the run itself.
    let _fault = scan(p, &mut s, &last.inputs, now);
    let active = || s.active().map(|s| s.0);
    match claim {
        Claim::NoDeadlock | Claim::LeadsTo { .. } => Blame::new(active(), []),
        _ if s.cleared().is_empty() => Blame::new(active(), []),
        _ => Blame::new([], s.cleared().iter().copied()),
    }
}

/// The same for what a single pass shows.
fn passes(p: &Program, s: &mut State, inputs: &[u64], now: i64, claim: &Claim) -> Option<Blame> {
    if !matches!(claim, Claim::NoConflict | Claim::NoUnsafe) {
        return None;
    }
    let t = p.tables();
    let (mut was, mut found): (Vec<u32>, _) = (Vec::new(), None);
    each_pass(p, s, inputs, now, |s, at| {
        found = match (claim, at) {
            (Claim::NoConflict, At::Ahead) => conflict(p, s).map(|(a, b)| {
                let others = sides(t, b).0;
                Blame::new(sides(t, a).0.into_iter().filter(|s| others.contains(s)), [a, b])
            }),
            (Claim::NoUnsafe, At::Ahead) => {
                was = s.active().map(|s| s.0).collect();
                None
            }
            (Claim::NoUnsafe, At::Behind) => {
                twice(t, &was, s.cleared()).map(|(step, rank)| Blame::new([step], [rank]))
            }
            _ => None,
        };
        found.is_some()
    });
    found
}
