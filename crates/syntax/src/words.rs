//! The words of the language, and the nearest one to a misspelt word.
//!
//! Few words are reserved. All others (`at`, `max`, `scan`, …) have a meaning only in certain
//! places, and are names elsewhere.

use std::sync::LazyLock;

use g7_model::words;

/// Reserved words by their first letter.
static RESERVED: LazyLock<[Vec<String>; 128]> = LazyLock::new(|| {
    let mut by_letter = std::array::from_fn(|_| Vec::new());
    for word in words::reserved() {
        let letter = word.bytes().next().map_or(0, usize::from);
        by_letter[letter % 128].push(word);
    }
    by_letter
});

/// True for a reserved word: as a plain name it would make an expression, a statement or a chart ambiguous.
pub(crate) fn is_reserved(word: &str) -> bool {
    // Most names end in a digit and need no comparison: no reserved word does.
    if word.ends_with(|c: char| c.is_ascii_digit()) {
        return false;
    }
    let list = word.bytes().next().and_then(|b| RESERVED.get(usize::from(b)));
    list.is_some_and(|list| list.iter().any(|r| r == word))
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

/// The words that end a statement.
pub(crate) const END: [&str; 5] = ["END_IF", "END_CASE", "END_FOR", "END_WHILE", "END_REPEAT"];

/// Returns such a word, written in upper or in lower case.
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

/// Words that begin or continue an item in some places only. A name in such a place is printed in
/// back-ticks.
pub(crate) fn is_contextual(word: &str) -> bool {
    words::has(words::FILE, word)
        || words::has(words::CHART, word)
        || matches!(
            word,
            "at" | "retain" | "inverted" | "safe" | "every" | "on" | "st" | "il" | "ld" | "INIT"
        )
}

/// The word of the list that was most likely meant: at most one slip in a word of up to four
/// letters, two in a longer one.
pub(crate) fn similar<'w>(word: &str, list: &[&'w str]) -> Option<&'w str> {
    let best = list.iter().map(|w| (slips(word, w), *w)).min_by_key(|(n, _)| *n)?;
    let allowed = if best.1.len() <= 4 { 1 } else { 2 };
    (best.0 <= allowed && best.0 < best.1.len()).then_some(best.1)
}

/// The number of insertions, deletions, replacements and swaps of neighbours between two words;
/// case is ignored.
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
