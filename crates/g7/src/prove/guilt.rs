//! The steps and transitions that break a claim, named: a conflict is of little use without the two transitions
//! that are in it.

use g7_model::{Said, say};
use g7_verify::{Claim, Model, Run, blame};

/// Most names in one sentence.
const NAMES: usize = 6;

/// A sentence about the end of a run; empty where the claim itself says all.
pub(super) fn guilt(model: &Model<'_>, claim: &Claim, run: &Run) -> Said {
    let found = || {
        let symbols = &model.compiled.symbols;
        let blame = blame(model, claim, run);
        let steps = blame.steps.iter().map(|s| symbols.step_name(*s).to_owned());
        let transitions = blame.transitions.iter().map(|r| symbols.transition_text(*r).to_owned());
        (listed(steps), listed(transitions))
    };
    match claim {
        Claim::NoConflict => say!("both are clearable at once: {}", found().1),
        Claim::NoUnsafe => {
            let (steps, transitions) = found();
            say!("step {steps} is active already when {transitions} activates it")
        }
        Claim::NoDeadlock => say!("nothing leads on from the situation {{{}}}", found().0),
        Claim::LeadsTo { .. } => say!("the effect can no longer come in the situation {{{}}}", found().0),
        Claim::NoInstability => match found().1 {
            none if none.is_empty() => none,
            transitions => say!("cleared again and again in one scan: {transitions}"),
        },
        _ => Said::default(),
    }
}

/// The names of what breaks a claim of every chart, for the question why it is so; none for a claim of the author.
pub(super) fn names(model: &Model<'_>, claim: &Claim, run: &Run) -> Vec<String> {
    if claim.is_own() {
        return Vec::new();
    }
    let symbols = &model.compiled.symbols;
    let blame = blame(model, claim, run);
    let steps = blame.steps.iter().map(|s| symbols.step_path(*s).to_owned());
    let transition = |r: &u32| format!("{}.{}", symbols.transition_chart(*r), symbols.transition_text(*r));
    let transitions = blame.transitions.iter().map(transition);
    match claim {
        // Why both cleared, not why the step that they share is no longer active.
        Claim::NoConflict => transitions.collect(),
        _ => steps.chain(transitions).collect(),
    }
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
