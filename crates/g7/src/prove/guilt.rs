//! The steps and transitions that break a claim, named: a conflict is of little use without the two transitions
//! that are in it.

use g7_model::{Said, say};
use g7_verify::{Claim, Model, Run, blame};

/// Most names in one sentence.
const NAMES: usize = 6;

/// The steps and transitions that break a claim at the end of a run.
#[derive(Default)]
pub(super) struct Guilt {
    /// A sentence that names them; empty if the claim itself names them.
    pub(super) said: Said,
    /// Their names, for the question why it is so; none for a claim of the author.
    pub(super) names: Vec<String>,
}

pub(super) fn guilt(model: &Model<'_>, claim: &Claim, run: &Run) -> Guilt {
    if claim.is_own() && !matches!(claim, Claim::LeadsTo { .. }) {
        return Guilt::default();
    }
    let symbols = &model.compiled.symbols;
    let blame = blame(model, claim, run);
    let steps = listed(blame.steps.iter().map(|s| symbols.step_name(*s).to_owned()));
    let transitions = listed(blame.transitions.iter().map(|r| symbols.transition_text(*r).to_owned()));
    let said = match claim {
        Claim::NoConflict => say!("both are clearable at once: {}", transitions),
        Claim::NoUnsafe => say!("step {steps} is active already when {transitions} activates it"),
        Claim::NoDeadlock => say!("nothing leads on from the situation {{{}}}", steps),
        Claim::LeadsTo { .. } => say!("the effect can no longer come in the situation {{{}}}", steps),
        Claim::NoInstability if !transitions.is_empty() => {
            say!("cleared again and again in one scan: {transitions}")
        }
        _ => Said::default(),
    };
    let paths = blame.steps.iter().map(|s| symbols.step_path(*s).to_owned());
    let transition = |r: &u32| format!("{}.{}", symbols.transition_chart(*r), symbols.transition_text(*r));
    let transitions = blame.transitions.iter().map(transition);
    let names = match claim {
        _ if claim.is_own() => Vec::new(),
        // Why both cleared, not why the step that they share is no longer active.
        Claim::NoConflict => transitions.collect(),
        _ => paths.chain(transitions).collect(),
    };
    Guilt { said, names }
}

fn listed(names: impl Iterator<Item = String>) -> Said {
    let all: Vec<String> = names.collect();
    let more = all.len().saturating_sub(NAMES);
    let shown: Vec<&str> = all.iter().take(NAMES).map(String::as_str).collect();
    let shown = Said::foreign(shown.join(", "));
    match more {
        0 => shown,
        n => say!("{shown}, … ({n} more)"),
    }
}
