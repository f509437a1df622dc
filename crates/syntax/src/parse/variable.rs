//! Declarations of variables, and types.

use super::composed::usual_type;
use super::{Parser, meant};
use crate::lexer::{Tok, Token};
use crate::words::{self, St};
use g7_iec::constant;
use g7_model::{
    Array, Expr, ExprKind, Name, Param, Problem, Said, Type, ValueType, VarDecl, VarKind, codes, say,
};

impl Parser<'_> {
    /// The kind of variable that is declared here, if one is.
    pub(super) fn var_kind(&self) -> Option<VarKind> {
        Some(match self.word() {
            "input" => VarKind::Input,
            "output" => VarKind::Output,
            "var" => VarKind::Var,
            "const" => VarKind::Const,
            _ => return None,
        })
    }

    /// Reads a declaration; its first word is the current token.
    pub(super) fn variable(&mut self, kind: VarKind) -> VarDecl {
        let start = self.bump().start;
        let made = self.declaration(kind, start);
        self.no_values(&made);
        made
    }

    /// Reads a declaration whose word is read, or that has none.
    pub(super) fn declaration(&mut self, kind: VarKind, start: u32) -> VarDecl {
        let names = self.names(say!("the name of a variable"));
        let array = self.array();
        let values = self.enumeration(array.is_some());
        let of = if values.is_none() { self.named_type(array.is_some()) } else { None };
        let ty = match (&of, &array) {
            _ if values.is_some() => Type::Int,
            (Some(_), _) => Type::Bool,
            (None, Some(_)) => self.ty(),
            (None, None) => self.typed(),
        };
        let limits = values.or_else(|| if of.is_none() { self.subrange(ty) } else { None });
        let at = self.since(start).into();
        // The type of this name can be one of arrays.
        let list = of.is_some() && self.peek().kind == Tok::LBracket;
        let init = if array.is_some() || list { self.values() } else { self.initial_value() };
        let mut decl = VarDecl {
            kind,
            names,
            array,
            ty,
            of,
            limits: limits.map(Box::new),
            part_of: None,
            usual: None,
            init,
            address: None,
            inverted: false,
            retain: false,
            safe: None,
            comment: None,
            at,
        };
        if kind == VarKind::Const && decl.init.is_none() {
            self.expected(say!("`:=` and the value of the constant"));
        }
        while self.clause(&mut decl) {}
        decl.at = self.since(start).into();
        decl
    }

    /// Reads one of the clauses after the type.
    fn clause(&mut self, decl: &mut VarDecl) -> bool {
        if decl.comment.is_none() && self.at(Tok::Comment) {
            decl.comment = self.comment_if();
            return true;
        }
        let token = self.behind_line_end().unwrap_or(self.cur);
        let word = self.slice(token);
        // In a chart, a step may have the name of one of these words; in a structure, a member.
        if !matches!(word, "at" | "inverted" | "retain" | "safe") || self.before_transition(token) {
            return false;
        }
        self.pass_line_end();
        let at = self.here();
        let (fits, where_to) = match word {
            "at" => (decl.kind != VarKind::Const, say!("`input`, `output` or `var`")),
            "inverted" => {
                (matches!(decl.kind, VarKind::Input | VarKind::Output), say!("`input` or `output`"))
            }
            "retain" => (decl.kind == VarKind::Var, say!("`var`")),
            _ => (decl.kind == VarKind::Output, say!("`output`")),
        };
        if !fits {
            let what = say!("`{word}` belongs to {where_to}");
            self.lexer.problems.add(at, || Problem::new(&codes::EXPECTED, at, what));
        }
        self.bump();
        match word {
            "at" => decl.address = self.address(),
            "inverted" => decl.inverted = fits,
            "retain" => decl.retain = fits,
            _ => decl.safe = Some(self.expr()).filter(|_| fits),
        }
        true
    }

    fn before_transition(&self, token: Token) -> bool {
        matches!(self.lexer.ahead(token).token().kind, Tok::Arrow | Tok::Colon | Tok::Comma | Tok::Output)
    }

    /// `%I0.0`, a number, a name or a text.
    fn address(&mut self) -> Option<Name> {
        let at = self.here();
        if self.at(Tok::Direct) {
            let token = self.bump();
            return Some(Name::new(self.slice(token).to_ascii_uppercase(), at));
        }
        if self.at(Tok::Str) {
            let token = self.bump();
            return Some(Name::new(self.string(token), at));
        }
        let start = self.cur.start;
        let name = self.name_if();
        if name.is_some() && self.at(Tok::PathDot) {
            while self.eat(Tok::PathDot) {
                self.bump();
            }
            let at = self.since(start);
            let text = self.text_at(at);
            self.slip_to(at, say!("a direct address begins with `%`"), &format!("%{text}"));
        }
        if name.is_none() {
            self.expected(say!("an address such as `%I0.0`, or the name of a channel"));
        }
        name
    }

    /// `: type`; BOOL where it is missing.
    pub(super) fn typed(&mut self) -> Type {
        if self.eat(Tok::Colon) {
            return self.ty();
        }
        if self.at(Tok::Word) && !self.cur.newline && self.known_type().is_some() {
            self.slip(self.here(), say!("`:` is missing before the type"), say!("write `name : type`"));
            return self.ty();
        }
        self.expected_help(say!("`:` and a type"), Some(say!("for example `a : BOOL`")));
        Type::Bool
    }

    /// `: type` of one value: a type of the language, with bounds perhaps, or one that the file declares.
    pub(super) fn value_type(&mut self) -> ValueType {
        let of = self.named_type(false);
        if of.is_some() {
            return ValueType { of, ..Type::Bool.into() };
        }
        let base = self.typed();
        ValueType { base, of, limits: self.subrange(base).map(Box::new) }
    }

    /// `: ARRAY[1..6, 0..3] OF`, if it stands here.
    fn array(&mut self) -> Option<Box<Array>> {
        let next = self.peek();
        if !self.at(Tok::Colon) || !self.slice(next).eq_ignore_ascii_case("ARRAY") {
            return None;
        }
        self.bump();
        let start = self.bump().start;
        let open = self.here();
        let mut dimensions = Vec::new();
        if self.expect(Tok::LBracket, say!("`[` and the least index")) {
            loop {
                let least = self.expr();
                self.expect(Tok::DotDot, say!("`..` and the greatest index"));
                dimensions.push((least, self.expr()));
                if !self.eat(Tok::Comma) {
                    break;
                }
            }
            self.close(Tok::RBracket, say!("`]`"), open);
        }
        if !self.eat_st(St::Of) {
            self.expected(say!("`OF` and the type of the elements"));
        }
        Some(Box::new(Array { dimensions, at: self.since(start).into() }))
    }

    /// `:= [1, 2, 4(0)]`, the values of an array.
    fn values(&mut self) -> Option<Expr> {
        if !matches!(self.cur.kind, Tok::Assign | Tok::Eq) {
            return None;
        }
        self.assign_sign();
        if !self.at(Tok::LBracket) {
            let value = self.expr();
            let at = value.at.0;
            self.slip(at, say!("the values of an array stand in brackets"), say!("write `[1, 2, 4(0)]`"));
            return Some(value);
        }
        Some(self.list())
    }

    /// `[1, 2, 4(0)]`; the bracket is in hand.
    pub(super) fn list(&mut self) -> Expr {
        let open = self.here();
        self.bump();
        let mut values = Vec::new();
        loop {
            values.push(self.repeated());
            if !self.eat(Tok::Comma) {
                break;
            }
        }
        self.close(Tok::RBracket, say!("`]`"), open);
        Expr { kind: ExprKind::List(values), at: self.since(open.start).into() }
    }

    /// `4(0)`, or one value.
    fn repeated(&mut self) -> (u32, Expr) {
        let next = self.peek();
        if !self.at(Tok::Int) || next.kind != Tok::LParen || next.newline {
            return (1, self.value_or_fields());
        }
        let count = self.integer_if(u64::from(u32::MAX)).and_then(|n| u32::try_from(n).ok());
        let open = self.here();
        self.bump();
        let value = self.value_or_fields();
        self.close(Tok::RParen, say!("`)`"), open);
        (count.unwrap_or(1), value)
    }

    /// `:= expr`, if it stands here; `=` is taken for it.
    pub(super) fn initial_value(&mut self) -> Option<Expr> {
        if !matches!(self.cur.kind, Tok::Assign | Tok::Eq) {
            return None;
        }
        self.assign_sign();
        let value = self.value_or_fields();
        self.decimal_comma();
        Some(value)
    }

    /// Tells of `1,5`, and passes it.
    fn decimal_comma(&mut self) {
        let (whole, comma) = (self.prev, self.cur);
        if whole.kind != Tok::Int || comma.kind != Tok::Comma || comma.start != whole.end {
            return;
        }
        let part = self.peek();
        if part.kind == Tok::Int && part.start == comma.end {
            self.bump();
            self.bump();
            let at = self.since(whole.start);
            let text = format!("{}.{}", self.slice(whole), self.slice(part));
            self.slip_to(at, say!("a number has a decimal point"), &text);
        }
    }

    fn known_type(&self) -> Option<Type> {
        constant::type_named(self.word())
    }

    /// A type; BOOL where none can be read.
    pub(super) fn ty(&mut self) -> Type {
        let Some(ty) = self.known_type() else {
            self.unknown_type();
            return Type::Bool;
        };
        self.bump();
        let bracketed = matches!(self.cur.kind, Tok::LParen | Tok::LBracket) && !self.cur.newline;
        if !bracketed || !matches!(ty, Type::String(_)) {
            return ty;
        }
        let open = self.here();
        let (close, sign) =
            if self.at(Tok::LParen) { (Tok::RParen, say!("`)`")) } else { (Tok::RBracket, say!("`]`")) };
        self.bump();
        let length = self.integer_if(u64::from(u16::MAX));
        if length.is_none() {
            self.expected(say!("the number of bytes of the text"));
        }
        self.close(close, sign, open);
        Type::String(length.and_then(|n| u16::try_from(n).ok()).unwrap_or(80))
    }

    fn unknown_type(&mut self) {
        if !self.at(Tok::Word) || words::is_reserved(self.word()) {
            self.expected_help(say!("a type"), Some(say!("for example BOOL, INT, REAL, TIME or TON")));
            return;
        }
        let word = self.word();
        let at = self.here();
        let names: Vec<&str> = Type::names().collect();
        let upper = word.to_ascii_uppercase();
        let composed = matches!(&*upper, "ARRAY" | "STRUCT");
        let other = usual_type(word);
        self.report(at, || {
            let problem = Problem::new(&codes::UNKNOWN_WORD, at, say!("there is no type `{word}`"));
            if let Some(other) = other {
                return meant(problem, other.name());
            }
            problem.help(match (&*upper, words::similar(word, &names)) {
                ("ARRAY", _) => say!("an array is declared in a chart or in the file"),
                ("STRUCT", _) => say!("a structure has a name: `struct Motor {{ speed : REAL }}`"),
                (_, Some(near)) => say!("did you mean `{near}`?"),
                // All others can be of a type of the file.
                _ => say!(
                    "constants and states of a plant have a type of the language: {}",
                    Said::foreign(names.join(", "))
                ),
            })
        });
        self.bump();
        // The rest of the type.
        while composed
            && !matches!(self.cur.kind, Tok::Line | Tok::Semi | Tok::Comment | Tok::RBrace | Tok::End)
        {
            self.bump();
        }
    }

    /// `(a : INT, b : REAL)`.
    pub(super) fn params(&mut self) -> Vec<Param> {
        let open = self.here();
        let mut params = Vec::new();
        if !self.expect(Tok::LParen, say!("`(`")) {
            return params;
        }
        while !matches!(self.cur.kind, Tok::RParen | Tok::End) {
            let start = self.cur.start;
            let name = self.name(say!("the name of a parameter"));
            let ty = self.value_type();
            params.push(Param { name, ty });
            if !self.eat(Tok::Comma) && !self.eat(Tok::Semi) || self.cur.start == start {
                break;
            }
        }
        self.close(Tok::RParen, say!("`)`"), open);
        params
    }
}
