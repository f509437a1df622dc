//! Claims in words, with the names of the chart.

use g7_compile::Compiled;
use g7_rig::Source;
use g7_verify::{Claim, Question};

/// The claim of a question; true if the author wrote it.
pub(super) fn claim(source: &Source, compiled: &Compiled, question: &Question) -> (bool, String) {
    let symbols = &compiled.symbols;
    let variable = |a| symbols.variable_at(a).map_or("", |v| &*v.name);
    let transition = |rank| match symbols.label(rank) {
        Some(label) => format!("{label}: {}", symbols.transition_text(rank)),
        None => symbols.transition_text(rank).to_owned(),
    };
    let written = || {
        let text = source.text.get(source.range(question.at)).unwrap_or_default();
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let plain = |text: &str| (false, text.to_owned());
    match &question.claim {
        Claim::Active(step) => (false, format!("step {} can be active", symbols.step_name(*step))),
        Claim::Clears(rank) => (false, format!("transition {} can clear", transition(*rank))),
        Claim::Runs(_) => (false, format!("action `{}` can run", first_line(&written()))),
        Claim::On(addr) => (false, format!("output `{}` can be other than 0", variable(*addr))),
        Claim::Asked(addr) => (false, format!("input `{}` is asked for", variable(*addr))),
        Claim::NoDeadlock => plain("no deadlock"),
        Claim::NoConflict => plain("no conflict: no two transitions of one step are clearable at once"),
        Claim::NoUnsafe => plain("no step is activated while it is active"),
        Claim::NoInstability => plain("every evolution ends"),
        Claim::NoOpposedWrites => plain("no pass gives a variable two values"),
        Claim::NoOpposedOrders => plain("forcing orders agree"),
        Claim::NoFault => plain("no fault"),
        Claim::Always(_)
        | Claim::Never(_)
        | Claim::Reachable(_)
        | Claim::AtMost(..)
        | Claim::Within { .. }
        | Claim::Until { .. }
        | Claim::Between { .. }
        | Claim::LeadsTo { .. } => (true, written()),
    }
}

fn first_line(text: &str) -> String {
    if text.chars().count() > 40 { text.chars().take(39).chain(['…']).collect() } else { text.to_owned() }
}

/// The way out of a claim that fails.
pub(super) fn way_out(claim: &str) -> Option<&'static str> {
    let ways = [
        ("no deadlock", "give the last situation of the run a transition that some input clears"),
        (
            "no conflict",
            "exclude the receptivities (`a and not b`), or give both a `priority` where the profile follows it",
        ),
        ("no step is activated", "let the token before leave the step first, or join the sequences"),
        ("every evolution ends", "put an edge (`↑a`) or a step that waits into the loop"),
        ("no pass gives", "write the variable in one place, or exclude the steps"),
        ("no fault", "guard the operation, or widen the type"),
    ];
    ways.iter().find(|(start, _)| claim.starts_with(start)).map(|(_, way)| *way)
}
