//! The parser: its current token, its places in the file, and its problems.

use std::ops::Range;

use g7_model::codes::{self, Code};
use g7_model::{Expr, ExprKind, Name, Said, Span, Stmt, say};

use super::lex::{Kind, Lexed, Token, tokens};
use crate::report::Report;

/// The deepest nesting of brackets and statements.
const MOST_NESTED: u32 = 100;

/// Maps a range of bytes of the text to its place in the file.
pub type Places<'a> = &'a dyn Fn(Range<usize>) -> Range<usize>;

/// Told of a pragma with statements of another language.
pub(crate) fn foreign() -> Said {
    say!("statements in a pragma, in C or another language, are not read")
}

/// A parser of IEC 61131-3 text.
pub(crate) struct Parser<'a> {
    pub(crate) text: &'a str,
    tokens: Vec<Token>,
    pub(crate) comments: Vec<Range<usize>>,
    foreign: Vec<Range<usize>>,
    pos: usize,
    place: Places<'a>,
    pub(crate) report: &'a mut Report,
    nested: u32,
    /// True if an element of an array becomes a variable with a name such as `a[1]`.
    pub(super) single: bool,
    /// True in a function, whose inputs keep their limits.
    pub(crate) of_function: bool,
    /// The token at which the last problem was reported.
    told: Option<usize>,
}

impl<'a> Parser<'a> {
    pub(crate) fn new(text: &'a str, place: Places<'a>, report: &'a mut Report) -> Parser<'a> {
        let Lexed { tokens, comments, foreign } = tokens(text);
        Parser {
            text,
            tokens,
            comments,
            foreign,
            pos: 0,
            place,
            report,
            nested: 0,
            single: false,
            of_function: false,
            told: None,
        }
    }

    /// A parser for a format whose elements of arrays become single variables.
    pub(super) fn single(text: &'a str, place: Places<'a>, report: &'a mut Report) -> Parser<'a> {
        Parser { single: true, ..Parser::new(text, place, report) }
    }

    /// Reads the whole text as statements.
    pub(super) fn body(mut self) -> Vec<Stmt> {
        let statements = self.statements();
        self.expect_end();
        self.tell_foreign();
        statements
    }

    /// Reports a pragma with statements of another language.
    fn tell_foreign(&mut self) {
        if let Some(at) = self.foreign(0) {
            self.report.put(g7_model::Problem::new(&codes::NOT_CARRIED, at, foreign()));
        }
    }

    /// Reads the whole text as one expression; `;` may follow.
    pub(super) fn whole(mut self) -> Expr {
        let expr = self.expr();
        while self.eat(";") {}
        self.expect_end();
        self.tell_foreign();
        expr
    }

    // Tokens

    pub(crate) fn token(&self) -> Token {
        self.ahead(0)
    }

    pub(crate) fn ahead(&self, n: usize) -> Token {
        let last =
            Token { kind: Kind::End, start: self.end_of_text(), end: self.end_of_text(), newline: true };
        self.tokens.get(self.pos + n).copied().unwrap_or(last)
    }

    fn end_of_text(&self) -> u32 {
        u32::try_from(self.text.len()).unwrap_or(u32::MAX)
    }

    /// The current position, to find out whether the parser has moved on.
    pub(crate) fn mark(&self) -> usize {
        self.pos
    }

    pub(crate) fn bump(&mut self) -> Token {
        let token = self.token();
        if token.kind != Kind::End {
            self.pos += 1;
        }
        token
    }

    pub(crate) fn slice(&self, token: Token) -> &'a str {
        self.text.get(token.start as usize..token.end as usize).unwrap_or("")
    }

    pub(crate) fn at_end(&self) -> bool {
        self.token().kind == Kind::End
    }

    /// True if the current token is this sign.
    pub(crate) fn at(&self, sign: &str) -> bool {
        let token = self.token();
        token.kind == Kind::Sign && self.slice(token) == sign
    }

    pub(crate) fn ahead_is(&self, n: usize, sign: &str) -> bool {
        let token = self.ahead(n);
        token.kind == Kind::Sign && self.slice(token) == sign
    }

    pub(crate) fn eat(&mut self, sign: &str) -> bool {
        let here = self.at(sign);
        if here {
            self.bump();
        }
        here
    }

    /// True if the current token is this word, in any case.
    pub(crate) fn at_word(&self, word: &str) -> bool {
        let token = self.token();
        token.kind == Kind::Word && self.slice(token).eq_ignore_ascii_case(word)
    }

    pub(crate) fn ahead_word(&self, n: usize, word: &str) -> bool {
        let token = self.ahead(n);
        token.kind == Kind::Word && self.slice(token).eq_ignore_ascii_case(word)
    }

    pub(crate) fn eat_word(&mut self, word: &str) -> bool {
        let here = self.at_word(word);
        if here {
            self.bump();
        }
        here
    }

    /// The current word in upper case; empty for any other token.
    pub(crate) fn word(&self) -> String {
        let token = self.token();
        if token.kind == Kind::Word { self.slice(token).to_ascii_uppercase() } else { String::new() }
    }

    /// The first pragma with statements of another language behind a place in the text.
    pub(crate) fn foreign(&self, start: u32) -> Option<Span> {
        let first = self.foreign.partition_point(|r| r.start < start as usize);
        let place = self.foreign.get(first).filter(|r| r.end <= self.token().start as usize)?;
        Some(self.report.span(&(self.place)(place.clone())))
    }

    // Places

    /// The place in the file of a part of the text.
    pub(crate) fn range(&self, start: usize, end: usize) -> Range<usize> {
        (self.place)(start..end.max(start))
    }

    pub(crate) fn here(&self) -> Range<usize> {
        let token = self.token();
        self.range(token.start as usize, token.end as usize)
    }

    pub(crate) fn span(&self, start: usize, end: usize) -> Span {
        self.report.span(&self.range(start, end))
    }

    pub(crate) fn span_of(&self, token: Token) -> Span {
        self.span(token.start as usize, token.end as usize)
    }

    /// The end of the previous token.
    pub(crate) fn behind(&self) -> usize {
        let before = self.pos.checked_sub(1).and_then(|i| self.tokens.get(i));
        before.map_or(0, |t| t.end as usize)
    }

    /// From a byte of the text to the end of the last token.
    pub(crate) fn since(&self, start: u32) -> Span {
        self.span(start as usize, self.behind())
    }

    // Problems

    pub(crate) fn say(&mut self, code: &'static Code, at: &Range<usize>, what: Said) {
        if self.told != Some(self.pos) {
            self.told = Some(self.pos);
            self.report.say(code, at, what);
        }
    }

    /// A description of the current token.
    pub(crate) fn found(&self) -> Said {
        let token = self.token();
        if token.kind == Kind::End {
            return say!("the end of the text");
        }
        let short: String = self.slice(token).chars().take(24).collect();
        say!("`{short}`")
    }

    pub(crate) fn expected(&mut self, what: Said) {
        let at = self.here();
        let words = say!("expected {what}, found {}", self.found());
        self.say(&codes::BAD_TEXT, &at, words);
    }

    pub(crate) fn expect(&mut self, sign: &str) -> bool {
        let here = self.eat(sign);
        if !here {
            self.expected(say!("`{sign}`"));
        }
        here
    }

    pub(crate) fn expect_word(&mut self, word: &str) -> bool {
        let here = self.eat_word(word);
        if !here {
            self.expected(say!("`{word}`"));
        }
        here
    }

    pub(crate) fn expect_end(&mut self) {
        if !self.at_end() {
            self.expected(say!("nothing more"));
        }
    }

    /// Enters one more level of nesting; beyond the limit, skips the rest of the text and returns
    /// false.
    pub(crate) fn enter(&mut self) -> bool {
        if self.nested < MOST_NESTED {
            self.nested += 1;
            return true;
        }
        let at = self.here();
        self.say(&codes::TOO_DEEP, &at, say!("brackets or statements nested more than {MOST_NESTED} deep"));
        self.pos = self.tokens.len().saturating_sub(1);
        false
    }

    pub(crate) fn leave(&mut self) {
        self.nested = self.nested.saturating_sub(1);
    }

    // Names

    /// Reads a name as written; reports a problem and returns None if there is none.
    pub(crate) fn name(&mut self, what: Said) -> Option<Name> {
        let token = self.token();
        if token.kind != Kind::Word {
            self.expected(what);
            return None;
        }
        self.bump();
        Some(Name::new(self.slice(token), self.span_of(token)))
    }

    pub(crate) fn bad(&self, start: u32) -> Expr {
        Expr { kind: ExprKind::Bad, at: self.since(start).into() }
    }
}
