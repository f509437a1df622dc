//! The conformance case that tells the rule behind a word, a sign or a problem.
//!
//! Here stand only the names of the cases, which the page ships too; [`crate::cases`] holds their texts.

use g7_model::{Document, Qualifier, Said, Transition, say};

/// The case of each qualifier.
pub const OF_QUALIFIERS: &[(Qualifier, &str)] = &[
    (Qualifier::N, "side-by-side/qualifier-n"),
    (Qualifier::S, "side-by-side/qualifier-s"),
    (Qualifier::R, "litmus/10-reset-dominates"),
    (Qualifier::L, "side-by-side/qualifier-l"),
    (Qualifier::D, "side-by-side/qualifier-d"),
    (Qualifier::P, "side-by-side/qualifier-p"),
    (Qualifier::P0, "side-by-side/qualifier-p0"),
    (Qualifier::P1, "side-by-side/qualifier-p1"),
    (Qualifier::SD, "side-by-side/qualifier-sd"),
    (Qualifier::DS, "side-by-side/qualifier-ds"),
    (Qualifier::SL, "side-by-side/qualifier-sl"),
];

/// The case of each word of the language that has a rule of its own.
pub const OF_WORDS: &[(&str, &str)] = &[
    ("step", "iec60848/rule-2-only-enabled-transitions"),
    ("initial", "iec60848/rule-1-initial-situation"),
    ("chart", "iec60848/linked-charts-alternation"),
    ("when", "iec60848/rule-2-only-enabled-transitions"),
    ("rise", "iec60848/edge-with-a-condition"),
    ("fall", "iec60848/edge-falling"),
    ("delay", "iec60848/time-on-a-condition"),
    ("priority", "side-by-side/priorities"),
    ("clearing", "side-by-side/on-clearing"),
    ("on", "side-by-side/event"),
    ("macro", "iec60848/macro-entry-and-exit"),
    ("macrochart", "iec60848/macro-entry-and-exit"),
    ("entry", "iec60848/macro-entry-and-exit"),
    ("exit", "iec60848/macro-entry-and-exit"),
    ("task", "iec60848/task-called-twice-in-turn"),
    ("call", "iec60848/task-called-twice-in-turn"),
    ("enclosing", "iec60848/enclosing-activation-links"),
    ("enclose", "iec60848/enclosing-activation-links"),
    ("force", "iec60848/forcing-given-steps"),
    ("enable", "iec60848/enable"),
    ("mask", "iec60848/mask-a-chart"),
    ("section", "unity/transition-section"),
    ("pre", "pl7/pre-of-charts"),
    ("post", "pl7/pre-of-charts"),
];

/// The case of each problem whose rule a case tells.
pub const OF_CODES: &[(&str, &str)] = &[
    ("G0101", "iec60848/rule-1-initial-situation"),
    ("G0102", "iec60848/macro-entry-and-exit"),
    ("G0103", "iec60848/rule-2-only-enabled-transitions"),
    ("G0108", "iec60848/rule-2-only-enabled-transitions"),
    ("G0110", "iec60848/enclosing-initial"),
    ("G0112", "iec60848/rule-2-join-waits"),
    ("G0301", "iec60848/rule-3-or-divergence"),
    ("G0302", "side-by-side/event"),
    ("G0310", "litmus/04-unstable-loop"),
    ("G0312", "side-by-side/priorities"),
    ("G0314", "side-by-side/event"),
    ("G0315", "iec60848/forcing-agreement"),
    ("G0316", "litmus/10-reset-dominates"),
];

/// The cases of the shapes of a transition: a source, a sink, a join, a fork, and one with a single step on both sides.
pub const OF_TRANSITIONS: [&str; 5] = [
    "iec60848/source-transition",
    "iec60848/sink-transition",
    "iec60848/rule-2-join-waits",
    "iec60848/rule-3-fork",
    "iec60848/rule-2-only-enabled-transitions",
];

/// The case in a list.
pub(crate) fn of(list: &[(&str, &'static str)], what: &str) -> Option<&'static str> {
    list.iter().find(|(word, _)| *word == what).map(|(_, case)| *case)
}

/// The case of a word or qualifier of the language.
pub(crate) fn of_word(word: &str) -> Option<&'static str> {
    match Qualifier::named(word) {
        Some(q) => OF_QUALIFIERS.iter().find(|(of, _)| *of == q).map(|(_, case)| *case),
        None => of(OF_WORDS, word),
    }
}

/// The transition whose arrow stands at a byte, in words, and its case.
pub(crate) fn of_arrow(document: &Document, byte: usize) -> Option<(Said, &'static str)> {
    let all = document.charts().flat_map(g7_model::Chart::transitions);
    // Of a chain, the last one that begins before the arrow.
    let inside = all.filter(|t| t.at.0.bytes().contains(&byte)).min_by_key(|t| t.at.0.bytes().len())?;
    let Transition { from, to, .. } = inside;
    let names = |steps: &[g7_model::Name]| {
        Said::foreign(steps.iter().map(|s| format!("`{}`", s.text)).collect::<Vec<_>>().join(", "))
    };
    let (before, behind) = (names(from), names(to));
    let (said, shape) = match (from.len(), to.len()) {
        (0, _) => (say!("source transition to {behind}"), 0),
        (_, 0) => (say!("sink transition from {before}"), 1),
        (2.., _) => (say!("transition that joins from {before} to {behind}"), 2),
        (_, 2..) => (say!("transition that forks from {before} to {behind}"), 3),
        _ => (say!("transition from {before} to {behind}"), 4),
    };
    Some((said, *OF_TRANSITIONS.get(shape)?))
}
