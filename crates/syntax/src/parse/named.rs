//! Types with a name: enumerations, subranges, and other names for types.

use super::Parser;
use crate::lexer::Tok;
use g7_model::{Expr, Limits, Name, Type, VarDecl, VarKind, codes, say};

impl Parser<'_> {
    /// True if `type` begins an item here: the name of a variable or step can be the same word.
    pub(super) fn at_type(&mut self) -> bool {
        let name = self.peek();
        let named = matches!(name.kind, Tok::Word | Tok::Ticked) && !name.newline;
        named && matches!(self.lexer.ahead(name).token().kind, Tok::Colon)
    }

    /// `type Percent : INT(0..100) := 50 "…"`; the word is in hand.
    pub(super) fn type_declaration(&mut self) -> VarDecl {
        let start = self.bump().start;
        let made = self.declaration(VarKind::Var, start);
        if let Some(second) = made.names.get(1) {
            let at = second.at.0;
            let what = say!("a type has one name");
            self.problem_help(
                &codes::EXPECTED,
                at,
                what,
                say!("write a second `type` for `{}`", second.text),
            );
        }
        let what = say!("a type has values and a comment; all else stands at the variable");
        self.type_alone(&made, false, what);
        if made.array.is_some() {
            self.no_values(&made);
        }
        made
    }

    /// `: (Manual, Automatic := 5)`; behind `OF` (`element`) it begins with the bracket.
    pub(super) fn enumeration(&mut self, element: bool) -> Option<Limits> {
        let open = if element { self.cur } else { self.peek() };
        if open.kind != Tok::LParen || open.newline || !element && !self.at(Tok::Colon) {
            return None;
        }
        if !element {
            self.bump();
        }
        let open = self.here();
        self.bump();
        let mut values: Vec<(Name, Option<Expr>)> = Vec::new();
        loop {
            let name = self.name(say!("the name of a value"));
            let number = self.initial_value();
            values.push((name, number));
            if !self.eat(Tok::Comma) {
                break;
            }
        }
        self.close(Tok::RParen, say!("`)` after the values"), open);
        Some(Limits::Values(values))
    }

    /// `(0..100)` behind a type.
    pub(super) fn subrange(&mut self, ty: Type) -> Option<Limits> {
        if !self.at(Tok::LParen) || self.cur.newline {
            return None;
        }
        let open = self.here();
        self.bump();
        let least = self.expr();
        self.expect(Tok::DotDot, say!("`..` and the greatest value"));
        let most = self.expr();
        self.close(Tok::RParen, say!("`)`"), open);
        if !ty.is_integer() {
            let at = self.since(open.start);
            let what = say!("only whole numbers have bounds in their type, not {}", ty);
            self.problem_help(
                &codes::EXPECTED,
                at,
                what,
                say!("write `LIMIT(0.0, x, 1.0)` where a value is set"),
            );
            return None;
        }
        Some(Limits::Range(least, most))
    }

    /// Reports the values of an enumeration anywhere but in `type Name : (…)`, because an enumeration needs a name.
    pub(super) fn no_values(&mut self, v: &VarDecl) {
        if let Some((first, _)) = v.values().first() {
            let first = first.at.0;
            let what = say!("an enumeration has a name of its own");
            let help = say!("write `type Mode : (Manual, Automatic)`, and `: Mode` here");
            self.problem_help(&codes::EXPECTED, first, what, help);
        }
    }
}
