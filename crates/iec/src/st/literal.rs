//! Reads constants in the text: type words in any case, and forms without a counterpart.

use g7_model::codes;
use g7_model::{Expr, ExprKind, Literal, Moment, Name, Nanos, Said, say};

use super::lex::{Kind, Token};
use super::parse::Parser;
use crate::constant;

impl Parser<'_> {
    /// Reads the current token as a constant.
    pub(crate) fn literal(&mut self) -> Expr {
        let token = self.bump();
        let text = self.slice(token);
        match token.kind {
            Kind::Number => self.read(token, number(text), text),
            Kind::Str => self.read(token, string(text), text),
            Kind::WideStr => {
                let inner = text.trim_matches('"').replace("$\"", "\"").replace('\'', "$'");
                self.read(token, string(&format!("'{inner}'")), text)
            }
            _ => self.typed(token, text),
        }
    }

    /// `T#5s`, `INT#5`, `BYTE#16#FF`, `Colour#Red`.
    fn typed(&mut self, token: Token, text: &str) -> Expr {
        let (prefix, value) = text.split_once('#').unwrap_or((text, ""));
        let upper = prefix.to_ascii_uppercase();
        match upper.as_str() {
            word if Nanos::WORDS.contains(&word) => {
                let time = constant::duration(value).map(Literal::Time);
                self.read(token, time, text)
            }
            _ if Moment::of_literal(&upper).is_some() => {
                self.read(token, constant::typed(&format!("{upper}#{value}")), text)
            }
            "STRING" | "WSTRING" | "CHAR" | "WCHAR" => self.read(token, string(value), text),
            "BOOL" => match value.to_ascii_uppercase().as_str() {
                "TRUE" | "1" | "2#1" | "16#1" => self.boolean(token, true),
                "FALSE" | "0" | "2#0" | "16#0" => self.boolean(token, false),
                _ => self.refuse(token, say!("`{text}` is no BOOL")),
            },
            _ => match super::types::elementary(&upper) {
                Some(ty) if ty.is_real() => {
                    let constant = constant::typed(&format!("{ty}#{}", value.to_ascii_lowercase()));
                    self.read(token, constant, text)
                }
                Some(ty) => self.read(token, constant::typed(&format!("{ty}#{value}")), text),
                None => {
                    let at = self.span_of(token);
                    super::shape::typed(prefix, &Name::new(value, at))
                }
            },
        }
    }

    pub(crate) fn boolean(&self, token: Token, value: bool) -> Expr {
        let kind = ExprKind::Literal(Literal::Bool(value));
        Expr { kind, at: self.span_of(token).into() }
    }

    fn refuse(&mut self, token: Token, what: Said) -> Expr {
        let at = self.range(token.start as usize, token.end as usize);
        self.report.say(&codes::NOT_CARRIED, &at, what);
        Expr { kind: ExprKind::Bad, at: self.span_of(token).into() }
    }

    /// The constant that was read, or a problem at its place.
    fn read(&mut self, token: Token, constant: Result<Literal, Said>, source: &str) -> Expr {
        let at = self.span_of(token).into();
        match constant {
            Ok(literal) => Expr { kind: ExprKind::Literal(literal), at },
            Err(what) => {
                let place = self.range(token.start as usize, token.end as usize);
                let short: String = source.chars().take(40).collect();
                self.report.say(&codes::BAD_VALUE, &place, say!("`{short}`: {what}"));
                Expr { kind: ExprKind::Bad, at }
            }
        }
    }
}

/// A number without a type: real if it has a point or an exponent, otherwise whole.
fn number(text: &str) -> Result<Literal, Said> {
    if text.contains('#') || !text.contains(['.', 'e', 'E']) {
        constant::integer(text).map(|value| Literal::Int(value, None))
    } else {
        constant::real(&text.to_ascii_lowercase()).map(|value| Literal::Real(value, None))
    }
}

/// A string with its quotes.
fn string(text: &str) -> Result<Literal, Said> {
    match constant::unquote_st(text) {
        (_, Some(wrong)) => Err(wrong),
        (text, None) => Ok(Literal::Str(text.into())),
    }
}
