//! Texts in quotes, durations and whole numbers.

use super::{Parser, meant};
use crate::lexer::{Tok, Token};
use crate::quote;
use g7_iec::constant;
use g7_model::{Expr, ExprKind, Literal, Nanos, Problem, Said, codes, say};

/// Values for text that could not be read. They are allowed everywhere, so that no later stage
/// complains again.
const UNREAD_TIME: Nanos = Nanos::SECOND;
const UNREAD_NUMBER: u64 = 1;

/// The units of a duration as people write them behind a number.
pub const UNITS: [&str; 7] = ["d", "h", "m", "s", "ms", "us", "ns"];

impl Parser<'_> {
    /// `"…"`, if it stands here.
    pub(super) fn comment_if(&mut self) -> Option<Box<str>> {
        if self.at(Tok::Str) && !self.cur.newline {
            let text = self.slice(self.cur).trim_matches('\'').replace('"', "\\\"");
            self.slip_to(self.here(), say!("a comment stands in double quotes"), &format!("\"{text}\""));
            self.bump();
            return Some(text.into());
        }
        self.at(Tok::Comment).then(|| {
            let token = self.bump();
            quote::unquote(self.slice(token), '"').into()
        })
    }

    /// A text in quotes of either kind.
    pub(super) fn text_if(&mut self) -> Option<Box<str>> {
        if self.at(Tok::Str) {
            let token = self.bump();
            return Some(self.string(token));
        }
        self.comment_if()
    }

    /// The text of a string token.
    pub(super) fn string(&mut self, token: Token) -> Box<str> {
        let (text, wrong) = constant::unquote_st(self.slice(token));
        if let Some(wrong) = wrong {
            let at = self.span_of(token);
            self.lexer.problems.add(at, || Problem::new(&codes::BAD_CHARACTER, at, wrong));
        }
        text.into()
    }

    /// A duration as written, if one stands here.
    pub(super) fn duration_if(&mut self) -> Option<Nanos> {
        self.at(Tok::Time).then(|| {
            let token = self.bump();
            self.duration_of(token)
        })
    }

    pub(super) fn duration_of(&mut self, token: Token) -> Nanos {
        let at = self.span_of(token);
        let text = self.slice(token);
        match constant::duration(text) {
            Ok(time) => time,
            Err(what) => {
                let name_like = !text.contains('#');
                self.lexer.problems.add(at, || {
                    let problem = Problem::new(&codes::BAD_DURATION, at, what);
                    if name_like {
                        problem.help(
                            say!("a duration is `5s` or `1h30m`; a name that begins with a digit stands in back-ticks"),
                        )
                    } else {
                        problem
                    }
                });
                UNREAD_TIME
            }
        }
    }

    /// A duration; without one a problem.
    pub(super) fn duration(&mut self, what: Said) -> Nanos {
        if let Some(time) = self.duration_if() {
            return time;
        }
        if self.unit_ahead() {
            self.loose_time();
        } else if matches!(self.cur.kind, Tok::Int | Tok::Real) {
            self.bare_time();
        } else {
            self.expected_help(what, Some(say!("for example `10ms`, `5s` or `1m30s`")));
        }
        UNREAD_TIME
    }

    /// True at a number with a unit of time behind it, and a blank between them.
    pub(super) fn unit_ahead(&mut self) -> bool {
        if !matches!(self.cur.kind, Tok::Int | Tok::Real) {
            return false;
        }
        let unit = self.peek();
        if unit.newline || unit.kind != Tok::Word || !UNITS.contains(&self.slice(unit)) {
            return false;
        }
        // A variable or a step can have the name of a unit.
        let behind = self.lexer.ahead(unit).token();
        let named = matches!(
            behind.kind,
            Tok::Assign | Tok::PathDot | Tok::Arrow | Tok::Output | Tok::Colon | Tok::LParen | Tok::LBracket
        );
        !named || behind.newline
    }

    /// `5 s`: told, and read without the blank.
    pub(super) fn loose_time(&mut self) -> Expr {
        let number = self.bump();
        let unit = self.bump();
        let text = format!("{}{}", self.slice(number), self.slice(unit));
        let at = self.since(number.start);
        self.lexer.problems.add(at, || {
            let what = say!("no blank stands between the number and the unit of a duration");
            meant(Problem::new(&codes::BAD_DURATION, at, what), &text)
        });
        let time = constant::duration(&text).unwrap_or(UNREAD_TIME);
        Expr { kind: ExprKind::Literal(Literal::Time(time)), at: at.into() }
    }

    /// A number where a duration is needed: told, and read as seconds.
    pub(super) fn bare_time(&mut self) -> Expr {
        let number = self.bump();
        let at = self.span_of(number);
        let text = self.slice(number);
        self.lexer.problems.add(at, || {
            Problem::new(&codes::BAD_DURATION, at, say!("the unit of this duration is missing"))
                .help(say!("write `{text}s` for seconds, `{text}ms` for milliseconds, `{text}m` for minutes"))
        });
        Expr { kind: ExprKind::Literal(Literal::Time(UNREAD_TIME)), at: at.into() }
    }

    /// A whole number that fits into `most`, if one stands here.
    pub(super) fn integer_if(&mut self, most: u64) -> Option<u64> {
        self.at(Tok::Int).then(|| {
            let token = self.bump();
            let at = self.span_of(token);
            let value = constant::integer(self.slice(token)).and_then(|v| {
                u64::try_from(v).ok().filter(|v| *v <= most).ok_or_else(|| say!("at most {most} here"))
            });
            value.unwrap_or_else(|what| {
                self.lexer.problems.add(at, || Problem::new(&codes::BAD_NUMBER, at, what));
                UNREAD_NUMBER
            })
        })
    }

    pub(super) fn integer_u32(&mut self, what: Said) -> u32 {
        match self.integer_if(u64::from(u32::MAX)) {
            Some(n) => u32::try_from(n).unwrap_or(u32::MAX),
            None => {
                self.expected(what);
                1
            }
        }
    }
}
