//! The words of the language, and the nearest one to a misspelt word.
//!
//! Few words are reserved. All others (`at`, `max`, `scan`, …) have a meaning only in certain
//! places, and are names elsewhere.

use std::sync::LazyLock;

pub(crate) use g7_model::similar;
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
        || words::has(words::BLOCK, word)
        || matches!(
            word,
            "at" | "retain" | "inverted" | "safe" | "every" | "on" | "st" | "il" | "ld" | "INIT"
        )
}
