//! Colours for a text: the class of each word.

use std::collections::HashSet;

use g7_model::{Type, words};
use g7_syntax::{Token, TokenKind};

use super::definitions::{Meaning, names};
use crate::file::File;

/// A token for the page: its place in code units, and its class.
pub(crate) type Coloured = (usize, usize, &'static str);

/// The coloured tokens between two code units.
pub(crate) fn tokens(file: &File, from: usize, to: usize) -> Vec<Coloured> {
    let text = file.text();
    let readable = file.drawn();
    let (mut variables, mut steps, mut charts) = (HashSet::new(), HashSet::new(), HashSet::new());
    for n in names(&readable.document) {
        let list = match n.meaning {
            Meaning::Step(..) => &mut steps,
            Meaning::Chart(_) => &mut charts,
            Meaning::Variable(..) | Meaning::Other(..) => &mut variables,
        };
        list.insert(n.name.text.to_string());
    }
    let (first, last) = (file.positions.byte(text, from), file.positions.byte(text, to));
    let mut out = Vec::new();
    let all: Vec<Token> = g7_syntax::tokens(text).take_while(|t| t.start < last).collect();
    for (i, token) in all.iter().enumerate() {
        if token.end <= first {
            continue;
        }
        let before = i.checked_sub(1).and_then(|i| all.get(i));
        let behind = all.get(i + 1);
        let word = text.get(token.start..token.end).unwrap_or("");
        let class = match token.kind {
            TokenKind::Word | TokenKind::Ticked => {
                let name = word.trim_matches('`');
                let known = variables.contains(name) || steps.contains(name) || charts.contains(name);
                let ticked = token.kind == TokenKind::Ticked;
                if !ticked && is_keyword(text, word, before, token, behind, known) {
                    "keyword"
                } else if !ticked && Type::named(&word.to_ascii_uppercase()).is_some() && !known {
                    "type"
                } else if charts.contains(name) {
                    "chart"
                } else if variables.contains(name) {
                    "variable"
                } else if steps.contains(name) || is_activity(name, &steps) {
                    "step"
                } else if behind.is_some_and(|b| b.kind == TokenKind::LParen && b.start == token.end) {
                    "function"
                } else {
                    "name"
                }
            }
            TokenKind::Number if steps.contains(word) && is_step_place(text, before, behind) => "step",
            TokenKind::Number => "number",
            TokenKind::Time => "time",
            TokenKind::Str => "string",
            TokenKind::Comment => "comment",
            TokenKind::Note => "note",
            TokenKind::Direct => "direct",
            TokenKind::LBrace | TokenKind::RBrace | TokenKind::LParen | TokenKind::RParen => "bracket",
            TokenKind::Comma | TokenKind::Semi | TokenKind::Colon | TokenKind::PathDot => "punctuation",
            TokenKind::Arrow | TokenKind::Star | TokenKind::Sign => "operator",
        };
        let unit = |byte| file.positions.unit(text, byte);
        out.push((unit(token.start), unit(token.end), class));
    }
    out
}

fn is_keyword(
    text: &str,
    word: &str,
    before: Option<&Token>,
    token: &Token,
    behind: Option<&Token>,
    known: bool,
) -> bool {
    if g7_syntax::is_reserved(word) {
        return true;
    }
    let between = before.map_or("\n", |b| text.get(b.end..token.start).unwrap_or(""));
    let begins = between.contains('\n')
        || before.is_some_and(|b| matches!(b.kind, TokenKind::LBrace | TokenKind::RBrace | TokenKind::Semi));
    // A word before an assignment, arrow, comma, colon or dot is a name.
    let named = behind.is_some_and(|b| {
        let sign = text.get(b.start..b.end).unwrap_or("");
        matches!(b.kind, TokenKind::Arrow | TokenKind::Comma | TokenKind::PathDot | TokenKind::Colon)
            || sign == ":="
    });
    let dotted = before.is_some_and(|b| b.kind == TokenKind::PathDot);
    if dotted || named {
        return false;
    }
    begins && words::begins(word) || !begins && !known && words::CONTINUATIONS.contains(&word)
}

/// `X12`, where there is a step 12.
fn is_activity(name: &str, steps: &HashSet<String>) -> bool {
    name.strip_prefix('X').is_some_and(|s| steps.contains(s))
}

/// True if a number stands where the name of a step is expected.
fn is_step_place(text: &str, before: Option<&Token>, behind: Option<&Token>) -> bool {
    let word = before.and_then(|b| text.get(b.start..b.end)).unwrap_or("");
    let arrow = |t: Option<&Token>| t.is_some_and(|t| t.kind == TokenKind::Arrow);
    matches!(word, "step" | "macro" | "enclosing") || arrow(before) || arrow(behind)
}
