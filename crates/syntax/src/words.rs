//! The words of the language, and the nearest one to a misspelt word.
//!
//! Few words are reserved; all others (`at`, `max`, `scan`, …) mean something
//! only where they can stand, and are names elsewhere.

/// Words that are never a plain name: those that would make an expression, a
/// statement or a chart ambiguous.
pub(crate) fn is_reserved(word: &str) -> bool {
    matches!(
        word,
        "rise"
            | "fall"
            | "delay"
            | "step"
            | "initial"
            | "enclosing"
            | "macro"
            | "chart"
            | "macrochart"
            | "task"
            | "when"
            | "priority"
            | "input"
            | "output"
            | "var"
            | "const"
            | "function"
            | "plant"
            | "layout"
            | "prove"
            | "profile"
            | "action"
            | "transition"
            | "TRUE"
            | "FALSE"
            | "true"
            | "false"
    ) || st(word).is_some()
        || operator(word)
}

fn operator(word: &str) -> bool {
    matches!(word, "and" | "or" | "xor" | "not" | "mod" | "AND" | "OR" | "XOR" | "NOT" | "MOD")
}

/// The words of Structured Text that build statements.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum St {
    If,
    Then,
    Elsif,
    Else,
    EndIf,
    Case,
    Of,
    EndCase,
    For,
    To,
    By,
    Do,
    EndFor,
    While,
    EndWhile,
    Repeat,
    Until,
    EndRepeat,
    Exit,
    Return,
}

/// Reads such a word, in upper or in lower case.
pub(crate) fn st(word: &str) -> Option<St> {
    Some(match word {
        "IF" | "if" => St::If,
        "THEN" | "then" => St::Then,
        "ELSIF" | "elsif" => St::Elsif,
        "ELSE" | "else" => St::Else,
        "END_IF" | "end_if" => St::EndIf,
        "CASE" | "case" => St::Case,
        "OF" | "of" => St::Of,
        "END_CASE" | "end_case" => St::EndCase,
        "FOR" | "for" => St::For,
        "TO" | "to" => St::To,
        "BY" | "by" => St::By,
        "DO" | "do" => St::Do,
        "END_FOR" | "end_for" => St::EndFor,
        "WHILE" | "while" => St::While,
        "END_WHILE" | "end_while" => St::EndWhile,
        "REPEAT" | "repeat" => St::Repeat,
        "UNTIL" | "until" => St::Until,
        "END_REPEAT" | "end_repeat" => St::EndRepeat,
        "EXIT" | "exit" => St::Exit,
        "RETURN" | "return" => St::Return,
        _ => return None,
    })
}

/// Words that begin something, or go on with it, in some places only; a name
/// that stands where one of them could is printed in back-ticks.
pub(crate) fn is_contextual(word: &str) -> bool {
    FILE.contains(&word)
        || CHART.contains(&word)
        || matches!(
            word,
            "at" | "retain" | "inverted" | "safe" | "every" | "on" | "st" | "il" | "ld" | "INIT"
        )
}

/// What a file's item can begin with.
pub(crate) const FILE: &[&str] = &[
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
    "layout",
];

/// What a chart's item can begin with, names aside.
pub(crate) const CHART: &[&str] = &[
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

/// What an action can begin with.
pub(crate) const ACTION: &[&str] = &[
    "N", "S", "R", "L", "D", "P", "P0", "P1", "SD", "DS", "SL", "on", "each", "force", "enable", "mask",
    "call", "enclose",
];

/// What a plant's item can begin with.
pub(crate) const PLANT: &[&str] =
    &["const", "state", "rate", "drive", "on", "each", "parts", "arrivals", "view"];

/// What a statement of a test can begin with.
pub(crate) const TEST: &[&str] =
    &["set", "pulse", "wait", "scan", "expect", "always", "force", "release", "restart", "repeat"];

/// The word of the list that was most likely meant: at most one slip in a word
/// of up to four letters, two in a longer one.
pub(crate) fn similar<'w>(word: &str, list: &[&'w str]) -> Option<&'w str> {
    let best = list.iter().map(|w| (slips(word, w), *w)).min_by_key(|(n, _)| *n)?;
    let allowed = if best.1.len() <= 4 { 1 } else { 2 };
    (best.0 <= allowed && best.0 < best.1.len()).then_some(best.1)
}

/// Insertions, removals, changes and swaps of neighbours between two words, capitals ignored.
fn slips(a: &str, b: &str) -> usize {
    let a: Vec<char> = a.chars().take(24).flat_map(char::to_lowercase).collect();
    let b: Vec<char> = b.chars().take(24).flat_map(char::to_lowercase).collect();
    let mut rows: [Vec<usize>; 3] = [Vec::new(), (0..=b.len()).collect(), Vec::new()];
    for (i, x) in a.iter().enumerate() {
        let mut row = vec![i + 1];
        for (j, y) in b.iter().enumerate() {
            let at = |r: &Vec<usize>, k: usize| r.get(k).copied().unwrap_or(usize::MAX / 2);
            let mut n =
                (at(&rows[1], j) + usize::from(x != y)).min(at(&rows[1], j + 1) + 1).min(at(&row, j) + 1);
            let swapped = i > 0 && j > 0 && a.get(i - 1) == Some(y) && b.get(j - 1) == Some(x);
            if swapped {
                n = n.min(at(&rows[0], j - 1) + 1);
            }
            row.push(n);
        }
        rows.rotate_left(1);
        rows[1] = row;
    }
    rows[1].last().copied().unwrap_or(usize::MAX)
}
