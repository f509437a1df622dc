//! Where a construct ends: with its line, unless a bracket is open.
//!
//! While a construct that stands on one line is read, the parser puts a token [`Tok::Line`] before
//! the first token of the next line, so that no rule can read on by mistake: a forgotten operand,
//! name or number is told where it is missing. Tokens that can begin nothing (operators, `->`, `{`,
//! `:=`, a comment) go on with the line before. `docs/decisions/049-lines.md` says why.

use super::Parser;
use super::extent::Extent;
use crate::lexer::{Tok, Token};
use g7_model::{BinaryOp, Problem, Said, Span, codes, say};

impl Parser<'_> {
    /// Reads a construct that stands on one line.
    pub(super) fn line<T>(&mut self, read: impl FnOnce(&mut Self) -> T) -> T {
        self.within(Extent::Line, read)
    }

    /// Reads the line before the braces of a construct. What is wrong at its end is told once.
    pub(super) fn head<T>(&mut self, read: impl FnOnce(&mut Self) -> T) -> T {
        let mut told = false;
        let out = self.line(|p| {
            let out = read(p);
            told = p.silent();
            out
        });
        if told {
            self.told = Some(self.cur.start);
        }
        out
    }

    /// Reads a statement of Structured Text, which may stand on several lines. If a line ends in the
    /// middle of an expression, the next line may continue it or be another statement. A `;` at the end
    /// says that it continues; without one, the operand is reported as missing.
    pub(super) fn statement_line<T>(&mut self, read: impl FnOnce(&mut Self) -> T) -> T {
        self.within(Extent::Statement, |p| {
            let out = read(p);
            if let Some(at) = p.lines.ran_on.take().filter(|_| !p.at(Tok::Semi)) {
                let what = p.missing_operand(at);
                p.report(at, || {
                    Problem::new(&codes::EXPECTED, at, what)
                        .help(say!("a statement that goes on in the next line ends with `;`"))
                });
            }
            out
        })
    }

    fn within<T>(&mut self, extent: Extent, read: impl FnOnce(&mut Self) -> T) -> T {
        let outer = (self.lines.extent, self.lines.base);
        self.lines.extent = extent;
        self.lines.base = self.lines.outside.len();
        let out = read(self);
        self.lines.outside.truncate(self.lines.base);
        (self.lines.extent, self.lines.base) = outer;
        if self.lines.extent == Extent::Free {
            self.pass_line_end();
        }
        out
    }

    /// Puts the end of the line before a token that begins a line and may not go on with the last.
    pub(super) fn hold_line_end(&mut self) {
        let token = self.cur;
        let ends = self.lines.extent != Extent::Free
            && token.newline
            && token.kind != Tok::Line
            && !self.goes_on(token);
        if ends {
            self.lines.behind = Some(token);
            let end = self.prev.end;
            self.cur = Token { kind: Tok::Line, start: end, end, newline: true };
        }
    }

    /// Goes on with the next line, if the current token is the end of one.
    pub(super) fn pass_line_end(&mut self) {
        if let Some(token) = self.lines.behind.take() {
            self.cur = token;
        }
    }

    /// The token behind the end of the line, if that is the current token.
    pub(super) fn behind_line_end(&self) -> Option<Token> {
        self.lines.behind
    }

    /// True at the first of these two words, also at the start of the next line.
    pub(super) fn at_two_words(&mut self, first: &str, second: &str) -> bool {
        let token = self.behind_line_end().unwrap_or(self.cur);
        if token.kind != Tok::Word || self.slice(token) != first {
            return false;
        }
        let next = self.lexer.ahead(token).token();
        next.kind == Tok::Word && self.slice(next) == second
    }

    /// True if a token at the start of a line goes on with the line before: it can begin nothing.
    fn goes_on(&self, token: Token) -> bool {
        match token.kind {
            Tok::Word => BinaryOp::of_word(self.slice(token)).is_some(),
            kind => !kind.begins_operand(),
        }
    }

    /// True if an operand may not stand here, since the line ended before it.
    pub(super) fn operand_over_line(&mut self) -> bool {
        if !self.cur.newline {
            return false;
        }
        match self.lines.extent {
            Extent::Free => false,
            Extent::Line => true,
            Extent::Statement => {
                self.lines.ran_on = self.lines.ran_on.or(Some(self.behind()));
                self.pass_line_end();
                false
            }
        }
    }

    /// Reports that the line ended before an operand.
    pub(super) fn operand_missing(&mut self) {
        let at = self.behind();
        let what = self.missing_operand(at);
        let when = what.ends_with("`when`");
        let help = if when {
            say!("a receptivity stands on the line of its `when`; `when =1` is always true")
        } else {
            say!(
                "an expression goes on in the next line within brackets, or if that line begins with the operator"
            )
        };
        self.report(at, || Problem::new(&codes::EXPECTED, at, what).help(help));
    }

    /// The words for an operand that is missing at the end of a line, by the word or sign before it.
    fn missing_operand(&self, at: Span) -> Said {
        let line = self.text.get(..at.start as usize).unwrap_or_default();
        let word = |c: char| c.is_alphanumeric() || c == '_';
        let last = if line.ends_with(word) {
            line.rsplit(|c| !word(c)).next().unwrap_or_default()
        } else {
            line.rsplit(|c: char| word(c) || c.is_whitespace()).next().unwrap_or_default()
        };
        match last {
            "" => say!("expected an expression"),
            "when" => say!("expected the receptivity after `when`"),
            _ => say!("expected an expression after `{last}`"),
        }
    }
}
