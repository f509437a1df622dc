//! Splits JGrafchart's action language into tokens.

use std::ops::Range;

/// A token with its place in the text.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Token {
    pub(super) kind: Kind,
    pub(super) at: Range<usize>,
    /// True if it is the first in its line.
    pub(super) fresh: bool,
}

/// The kind of a token.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Kind {
    Name(String),
    Int(i64),
    Real(f64),
    Str(String),
    /// One or two signs: `=`, `==`, `/`, …
    Sign(&'static str),
    /// A string without its closing quote.
    Unclosed,
    /// A number that is too large.
    Huge,
    /// A character without a meaning.
    Odd(char),
    /// The end of the text.
    End,
}

const SIGNS: [&str; 24] = [
    "<=", ">=", "==", "!=", "<", ">", "=", "!", "&", "|", "*", "+", "-", "/", "\\", "%", "(", ")", ",", ";",
    "?", ":", ".", "^",
];

/// The tokens of a text, ending with [`Kind::End`].
pub(super) fn tokens(text: &str) -> Vec<Token> {
    let mut list = Vec::new();
    let mut rest = text;
    let mut fresh = true;
    loop {
        let trimmed = rest.trim_start();
        let blank = rest.get(..rest.len() - trimmed.len()).unwrap_or("");
        fresh |= blank.contains('\n');
        rest = trimmed;
        let start = text.len() - rest.len();
        let (kind, len) = word(rest);
        let end = kind == Kind::End;
        list.push(Token { kind, at: start..start + len, fresh });
        if end {
            return list;
        }
        fresh = false;
        rest = rest.get(len..).unwrap_or("");
    }
}

/// The first token of a text that begins without blanks, and its length in bytes.
fn word(text: &str) -> (Kind, usize) {
    let Some(first) = text.chars().next() else { return (Kind::End, 0) };
    if first.is_alphabetic() || first == '_' || first == '#' || first == '$' {
        let len = span(text, |c| c.is_alphanumeric() || matches!(c, '_' | '#' | '$'));
        return (Kind::Name(text.get(..len).unwrap_or("").to_string()), len);
    }
    if first.is_ascii_digit() {
        return number(text);
    }
    if first == '"' {
        return string(text);
    }
    match SIGNS.iter().find(|sign| text.starts_with(**sign)) {
        Some(sign) => (Kind::Sign(sign), sign.len()),
        None => (Kind::Odd(first), first.len_utf8()),
    }
}

fn span(text: &str, of: impl Fn(char) -> bool) -> usize {
    text.find(|c| !of(c)).unwrap_or(text.len())
}

fn number(text: &str) -> (Kind, usize) {
    let digits = |from: usize| from + text.get(from..).map_or(0, |t| span(t, |c| c.is_ascii_digit()));
    let byte = |at: usize| text.as_bytes().get(at).copied();
    let whole = digits(0);
    let mut len = whole;
    if byte(len) == Some(b'.') && byte(len + 1).is_some_and(|b| b.is_ascii_digit()) {
        len = digits(len + 1);
    }
    if matches!(byte(len), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(byte(len + 1), Some(b'+' | b'-')));
        if byte(len + 1 + sign).is_some_and(|b| b.is_ascii_digit()) {
            len = digits(len + 1 + sign);
        }
    }
    let written = text.get(..len).unwrap_or("");
    let kind = if len == whole {
        written.parse().map_or(Kind::Huge, Kind::Int)
    } else {
        written.parse().ok().filter(|v: &f64| v.is_finite()).map_or(Kind::Huge, Kind::Real)
    };
    (kind, len)
}

fn string(text: &str) -> (Kind, usize) {
    let mut value = String::new();
    let mut escaped = false;
    for (i, c) in text.char_indices().skip(1) {
        match c {
            _ if escaped => {
                value.push(match c {
                    'n' => '\n',
                    't' => '\t',
                    'r' => '\r',
                    other => other,
                });
                escaped = false;
            }
            '\\' => escaped = true,
            '"' => return (Kind::Str(value), i + 1),
            '\n' => break,
            other => value.push(other),
        }
    }
    (Kind::Unclosed, span(text, |c| c != '\n'))
}
