//! The words of the .g7 language that begin something or go on with it.
//!
//! `syntax` looks for the nearest of them to a misspelt word, and the editor colours them. What they
//! mean stands in `docs/book/src/language/grammar.md`.

use crate::Qualifier;

/// Words that an item of a file can begin with.
pub const FILE: &[&str] = &[
    "profile",
    "scan",
    "target",
    "input",
    "output",
    "var",
    "const",
    "chart",
    "macrochart",
    "task",
    "action",
    "transition",
    "function",
    "pre",
    "post",
    "plant",
    "test",
    "prove",
    "assume",
    "layout",
];

/// Words that an item of a chart can begin with, names aside.
pub const CHART: &[&str] = &[
    "step",
    "initial",
    "entry",
    "exit",
    "enclosing",
    "macro",
    "input",
    "output",
    "var",
    "const",
    "pre",
    "post",
    "action",
    "transition",
];

/// Words that an action can begin with, qualifiers aside.
pub const ACTION: &[&str] = &["on", "each", "force", "enable", "mask", "call", "enclose"];

/// Words that an item of a plant can begin with.
pub const PLANT: &[&str] = &["const", "state", "rate", "drive", "on", "each", "parts", "arrivals", "view"];

/// Words that a statement of a test can begin with.
pub const TEST: &[&str] =
    &["set", "pulse", "wait", "scan", "expect", "always", "force", "release", "restart", "repeat"];

/// Words that go on with an item within its line, and are names elsewhere.
pub const CONTINUATIONS: &[&str] = &[
    "at",
    "retain",
    "inverted",
    "safe",
    "every",
    "with",
    "seed",
    "within",
    "until",
    "scan",
    "in",
    "max",
    "length",
    "after",
    "never",
    "reachable",
    "always",
    "between",
    "leads",
    "to",
    "most",
    "of",
    "fault",
    "cold",
    "st",
    "il",
    "ld",
    "section",
    "each",
    "if",
    "INIT",
    "stable",
    "one-pass",
];

/// True if an item, an action or a statement of a test can begin with this word.
pub fn begins(word: &str) -> bool {
    [FILE, CHART, ACTION, PLANT, TEST].iter().any(|list| list.contains(&word))
        || Qualifier::named(word).is_some()
}
