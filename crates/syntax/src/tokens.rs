//! The words and signs of a text, for code that colours or edits it.

use crate::lexer::{Lexer, Tok};
use crate::print::is_plain;
use crate::quote;
use crate::words;
use g7_model::{FileId, Note};

/// A word, sign or note of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Token {
    /// Its kind.
    pub kind: TokenKind,
    /// First byte.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
}

/// Kinds of token, as far as code outside of the parser needs them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TokenKind {
    /// A word of the language or a name; [`is_reserved`] tells which words are never names.
    Word,
    /// A name in back-ticks.
    Ticked,
    /// A number, with its type if it has one.
    Number,
    /// A duration.
    Time,
    /// `'text'`.
    Str,
    /// `"text"`, a comment that is drawn.
    Comment,
    /// `%I0.1`.
    Direct,
    /// `->`.
    Arrow,
    /// `{`.
    LBrace,
    /// `}`.
    RBrace,
    /// `(`.
    LParen,
    /// `)`.
    RParen,
    /// `,`.
    Comma,
    /// `;`.
    Semi,
    /// `:`.
    Colon,
    /// `*`.
    Star,
    /// `.` between two names.
    PathDot,
    /// Any other sign.
    Sign,
    /// A note to the reader.
    Note,
}

/// The tokens of a text in their order, notes among them.
pub fn tokens(text: &str) -> Tokens<'_> {
    Tokens { lexer: Lexer::new(text, FileId(0), 0), held: None, notes: Vec::new() }
}

/// The iterator of [`tokens`].
#[derive(Debug)]
pub struct Tokens<'a> {
    lexer: Lexer<'a>,
    /// Read already, but notes come before it.
    held: Option<Token>,
    /// The tokens to return next, in reverse order.
    notes: Vec<Note>,
}

impl Iterator for Tokens<'_> {
    type Item = Token;

    fn next(&mut self) -> Option<Token> {
        if self.notes.is_empty() && self.held.is_none() {
            let token = self.lexer.token();
            self.notes = std::mem::take(&mut self.lexer.notes);
            self.notes.reverse();
            self.held = public(token.kind).map(|kind| Token {
                kind,
                start: token.start as usize,
                end: token.end as usize,
            });
        }
        match self.notes.pop() {
            Some(note) => Some(Token {
                kind: TokenKind::Note,
                start: note.at.start as usize,
                end: note.at.end as usize,
            }),
            None => self.held.take(),
        }
    }
}

fn public(kind: Tok) -> Option<TokenKind> {
    Some(match kind {
        Tok::End | Tok::Line => return None,
        Tok::Word => TokenKind::Word,
        Tok::Ticked => TokenKind::Ticked,
        Tok::Int | Tok::Real | Tok::Typed => TokenKind::Number,
        Tok::Time => TokenKind::Time,
        Tok::Str => TokenKind::Str,
        Tok::Comment => TokenKind::Comment,
        Tok::Direct => TokenKind::Direct,
        Tok::Arrow => TokenKind::Arrow,
        Tok::LBrace => TokenKind::LBrace,
        Tok::RBrace => TokenKind::RBrace,
        Tok::LParen => TokenKind::LParen,
        Tok::RParen => TokenKind::RParen,
        Tok::Comma => TokenKind::Comma,
        Tok::Semi => TokenKind::Semi,
        Tok::Colon => TokenKind::Colon,
        Tok::Star => TokenKind::Star,
        Tok::PathDot => TokenKind::PathDot,
        Tok::LBracket
        | Tok::RBracket
        | Tok::Assign
        | Tok::Output
        | Tok::Eq
        | Tok::Ne
        | Tok::Lt
        | Tok::Gt
        | Tok::Le
        | Tok::Ge
        | Tok::Plus
        | Tok::Minus
        | Tok::Power
        | Tok::Slash
        | Tok::Amp
        | Tok::AmpAmp
        | Tok::Bars
        | Tok::Dot
        | Tok::DotDot
        | Tok::Bang
        | Tok::Rise
        | Tok::Fall
        | Tok::Prime
        | Tok::Overline
        | Tok::Hash
        | Tok::Percent
        | Tok::Question
        | Tok::Bad => TokenKind::Sign,
    })
}

/// True if a word is reserved: it is never a plain name.
pub fn is_reserved(word: &str) -> bool {
    words::is_reserved(word)
}

/// A name as it is declared: in back-ticks if it needs them.
pub fn show_name(name: &str) -> String {
    if is_plain(name) { name.to_owned() } else { quote::quote(name, '`') }
}

/// A name in a place where words of the language are allowed as well: at the start of a transition,
/// in lists of steps.
pub fn show_step_name(name: &str) -> String {
    if is_plain(name) && !words::is_contextual(name) { name.to_owned() } else { quote::quote(name, '`') }
}

/// A name as it is written between or before the dots of a path.
pub fn show_path_name(name: &str, first: bool, only: bool) -> String {
    let number = name.starts_with(|c: char| c.is_ascii_digit());
    let word = name.chars().next().is_some_and(crate::lexer::name_start)
        && name.chars().all(crate::lexer::name_continue);
    let fits = match (first, only) {
        (false, _) => word || number && is_plain(name),
        (true, true) => is_plain(name) && !number,
        (true, false) => is_plain(name),
    };
    if fits { name.to_owned() } else { quote::quote(name, '`') }
}

/// A comment in its double quotes.
pub fn show_comment(text: &str) -> String {
    quote::quote(text, '"')
}

#[cfg(test)]
mod tests {
    use super::{TokenKind, show_path_name, tokens};

    #[test]
    fn tokens_and_notes_come_in_the_order_of_the_text() {
        let text = "1 // one\n-> /*a*/ (2) when a.b' \"c\"";
        let all: Vec<(TokenKind, &str)> =
            tokens(text).map(|t| (t.kind, text.get(t.start..t.end).unwrap_or_default())).collect();
        assert_eq!(
            all,
            [
                (TokenKind::Number, "1"),
                (TokenKind::Note, "// one"),
                (TokenKind::Arrow, "->"),
                (TokenKind::Note, "/*a*/"),
                (TokenKind::LParen, "("),
                (TokenKind::Number, "2"),
                (TokenKind::RParen, ")"),
                (TokenKind::Word, "when"),
                (TokenKind::Word, "a"),
                (TokenKind::PathDot, "."),
                (TokenKind::Word, "b"),
                (TokenKind::Sign, "'"),
                (TokenKind::Comment, "\"c\""),
            ]
        );
    }

    #[test]
    fn names_in_paths_have_ticks_only_where_they_must() {
        assert_eq!(show_path_name("12", true, true), "`12`");
        assert_eq!(show_path_name("12", true, false), "12");
        assert_eq!(show_path_name("step", false, false), "step");
        assert_eq!(show_path_name("a b", false, false), "`a b`");
    }
}
