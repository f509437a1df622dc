//! Constants: brought to the spelling of the .g7 language, which reads them.

use g7_model::codes;
use g7_model::{Expr, ExprKind, Literal, Name, Path, Type};

use super::lex::{Kind, Token};
use super::parse::Parser;
use super::types::bits;

impl Parser<'_> {
    /// The constant in hand.
    pub(super) fn literal(&mut self) -> Expr {
        let token = self.bump();
        let text = self.slice(token);
        match token.kind {
            Kind::Number => self.written(token, &text.to_ascii_uppercase().replace('E', "e"), text),
            Kind::Str => self.written(token, text, text),
            Kind::WideStr => {
                let inner = text.trim_matches('"').replace("$\"", "\"").replace('\'', "$'");
                self.written(token, &format!("'{inner}'"), text)
            }
            _ => self.typed(token, text),
        }
    }

    /// `T#5s`, `INT#5`, `BYTE#16#FF`, `Colour#Red`.
    fn typed(&mut self, token: Token, text: &str) -> Expr {
        let (prefix, value) = text.split_once('#').unwrap_or((text, ""));
        let upper = prefix.to_ascii_uppercase();
        match upper.as_str() {
            "T" | "TIME" | "LTIME" | "LT" => {
                let value = value.to_ascii_lowercase();
                self.written(token, &format!("T#{value}"), text)
            }
            "DATE" | "D" | "DT" | "DATE_AND_TIME" | "TOD" | "TIME_OF_DAY" | "LDT" | "LTOD" | "LDATE" => {
                self.refuse(token, &format!("`{text}`: there are no dates and times of day"))
            }
            "STRING" | "WSTRING" | "CHAR" | "WCHAR" => self.written(token, value, text),
            "BOOL" => match value.to_ascii_uppercase().as_str() {
                "TRUE" | "1" | "2#1" | "16#1" => self.boolean(token, true),
                "FALSE" | "0" | "2#0" | "16#0" => self.boolean(token, false),
                _ => self.refuse(token, &format!("`{text}` is no BOOL")),
            },
            _ => match super::types::elementary(&upper).or_else(|| bits(&upper)) {
                Some(Type::Real | Type::Lreal) => {
                    self.written(token, &format!("{upper}#{}", value.to_ascii_lowercase()), text)
                }
                Some(ty) => self.written(token, &format!("{ty}#{}", value.to_ascii_uppercase()), text),
                None => {
                    let at = self.span_of(token);
                    let names = vec![Name::new(value, at)];
                    Expr { kind: ExprKind::Path(Path { names }), at: at.into() }
                }
            },
        }
    }

    pub(super) fn boolean(&self, token: Token, value: bool) -> Expr {
        let kind = ExprKind::Literal(Literal::Bool(value));
        Expr { kind, at: self.span_of(token).into() }
    }

    fn refuse(&mut self, token: Token, what: &str) -> Expr {
        let at = self.range(token.start as usize, token.end as usize);
        self.report.say(&codes::NOT_CARRIED, &at, what);
        Expr { kind: ExprKind::Bad, at: self.span_of(token).into() }
    }

    /// A constant by its text in the .g7 language.
    fn written(&mut self, token: Token, text: &str, source: &str) -> Expr {
        let at = self.span_of(token);
        let (expr, problems) = g7_syntax::parse_expr(text, at.file);
        if let Some(problem) = problems.first() {
            let place = self.range(token.start as usize, token.end as usize);
            let short: String = source.chars().take(40).collect();
            let what = problem.what.replace('\'', "`");
            self.report.say(&codes::BAD_VALUE, &place, format!("`{short}`: {what}"));
            return Expr { kind: ExprKind::Bad, at: at.into() };
        }
        Expr { kind: expr.kind, at: at.into() }
    }
}
