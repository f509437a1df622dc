//! Structures and function blocks of one's own, and variables of these types.

use super::Parser;
use crate::lexer::Tok;
use crate::words;
use g7_iec::constant;
use g7_model::{
    Arg, Body, Composed, Expr, ExprKind, Name, Path, Said, Type, VarDecl, VarKind, codes, say, words as table,
};

impl Parser<'_> {
    /// True if `struct` begins an item here: the name of a variable or step can be the same word.
    pub(super) fn at_structure(&mut self) -> bool {
        let name = self.peek();
        let named = matches!(name.kind, Tok::Word | Tok::Ticked) && !name.newline;
        named && matches!(self.lexer.ahead(name).token().kind, Tok::LBrace | Tok::Comment)
    }

    /// True if the `function` in hand begins a function block: a function can have the name `block`.
    pub(super) fn at_block(&mut self) -> bool {
        let word = self.peek();
        self.slice(word) == "block" && self.lexer.ahead(word).token().kind != Tok::LParen
    }

    /// `struct Motor { speed : REAL … }`.
    pub(super) fn structure(&mut self) -> Composed {
        let start = self.bump().start;
        let mut made = self.composed_head(say!("the name of the structure"), start);
        let open = self.here();
        if self.expect(Tok::LBrace, say!("`{{` and the members of the structure")) {
            while self.more_members() {
                let from = self.cur.start;
                if self.at_name() {
                    let member = self.line(|p| p.declaration(VarKind::Var, from));
                    self.no_values(&member);
                    self.plain_member(&member, false);
                    made.members.push(member);
                } else {
                    self.lost_member(say!("the name of a member and its type"));
                }
                self.past(from);
            }
            self.close(Tok::RBrace, say!("`}}` after the last member"), open);
        }
        made.at = self.since(start).into();
        made
    }

    /// `function block Debounce { input raw : BOOL … body { … } }`.
    pub(super) fn function_block(&mut self) -> Composed {
        let start = self.bump().start;
        self.bump();
        let mut made = self.composed_head(say!("the name of the function block"), start);
        let open = self.here();
        let mut body = None;
        if self.expect(Tok::LBrace, say!("`{{` and the parameters of the function block")) {
            while self.more_members() {
                let from = self.cur.start;
                self.member_of_block(&mut made, &mut body);
                self.past(from);
            }
            self.close(Tok::RBrace, say!("`}}` after the function block"), open);
        }
        made.at = self.since(start).into();
        Composed { block: true, body, ..made }
    }

    fn member_of_block(&mut self, made: &mut Composed, body: &mut Option<Body>) {
        if let Some(kind) = self.var_kind() {
            let member = self.line(|p| p.variable(kind));
            self.plain_member(&member, true);
            return made.members.push(member);
        }
        match self.word() {
            "inout" => {
                let parameter = self.line(|p| p.variable(VarKind::Var));
                self.plain_member(&parameter, false);
                if let Some(value) = &parameter.init {
                    let what = say!("a parameter that stands for a variable has no value of its own");
                    self.problem_help(&codes::EXPECTED, value.at.0, what, say!("leave it out here"));
                }
                made.inouts.push(parameter);
            }
            "body" => {
                let at = self.here();
                self.bump();
                let read = self.body();
                if body.is_some() {
                    let what = say!("a function block has one body");
                    self.problem_help(&codes::EXPECTED, at, what, say!("put the statements into one body"));
                } else {
                    *body = Some(read);
                }
            }
            _ if self.correct(&table::texts(table::BLOCK)) => self.member_of_block(made, body),
            _ => self.lost_member(say!("`input`, `output`, `inout`, `var`, `const` or `body`")),
        }
    }

    fn composed_head(&mut self, what: Said, start: u32) -> Composed {
        let name = self.name(what);
        let comment = self.comment_if();
        let at = self.since(start).into();
        Composed { name, comment, members: Vec::new(), inouts: Vec::new(), block: false, body: None, at }
    }

    fn more_members(&mut self) -> bool {
        self.skip_semis();
        let ends = matches!(self.cur.kind, Tok::RBrace | Tok::End);
        !(ends || self.cur.newline && self.at_file_start())
    }

    fn lost_member(&mut self, what: Said) {
        let start = self.cur.start;
        self.unexpected(what, None);
        if self.cur.start == start {
            self.bump();
        }
        self.recover(|p| p.var_kind().is_some() || p.word() == "body" || p.at_name());
    }

    /// Goes on behind a token that nothing has read.
    fn past(&mut self, from: u32) {
        if self.cur.start == from {
            self.bump();
        }
    }

    /// Addresses, channels and values of a stop belong to variables, not to their types.
    fn plain_member(&mut self, member: &VarDecl, retained: bool) {
        let what = say!("a member has a type, a value and a comment; all else stands at the variable");
        self.type_alone(member, retained, what);
    }

    /// Reports the clauses of a declaration that only a variable has; `what` tells what may stand there.
    pub(super) fn type_alone(&mut self, declared: &VarDecl, retained: bool, what: Said) {
        let at = declared.address.as_ref().map(|a| a.at.0).or(declared.safe.as_ref().map(|s| s.at.0));
        let at = at.or((declared.inverted || declared.retain && !retained).then_some(declared.at.0));
        if let Some(at) = at {
            self.problem_help(&codes::EXPECTED, at, what, say!("leave it out here"));
        }
    }

    /// `: Motor`, or `Motor` behind `ARRAY[…] OF`: the name of a type that the file declares.
    pub(super) fn named_type(&mut self, element: bool) -> Option<Box<Name>> {
        let token = if element { self.cur } else { self.peek() };
        let text = self.slice(token);
        let ticked = token.kind == Tok::Ticked;
        let plain = token.kind == Tok::Word
            && !words::is_reserved(text)
            && constant::type_named(text).is_none()
            && usual_type(text).is_none()
            && !FOREIGN.contains(&&*text.to_ascii_uppercase());
        if token.newline || !ticked && !plain || !element && !self.at(Tok::Colon) {
            return None;
        }
        if !element {
            self.bump();
        }
        Some(Box::new(self.name(say!("the name of a type"))))
    }

    /// A value, or the values of the members of a structure.
    pub(super) fn value_or_fields(&mut self) -> Expr {
        if !self.at(Tok::LParen) || !self.at_field() || !self.enter() {
            return self.expr();
        }
        let open = self.here();
        self.bump();
        let mut fields = Vec::new();
        while self.at_name() {
            let name = Some(self.name(say!("the name of a member")));
            self.assign_sign();
            let value = if self.at(Tok::LBracket) { self.list() } else { self.value_or_fields() };
            fields.push(Arg::input(name, value));
            if !self.eat(Tok::Comma) {
                break;
            }
        }
        self.close(Tok::RParen, say!("`)` after the values"), open);
        self.leave();
        let kind = ExprKind::Call(Path { names: Vec::new() }, fields);
        Expr { kind, at: self.since(open.start).into() }
    }

    /// True if `(name :=` stands here.
    fn at_field(&mut self) -> bool {
        let name = self.peek();
        matches!(name.kind, Tok::Word | Tok::Ticked | Tok::Int)
            && self.lexer.ahead(name).token().kind == Tok::Assign
    }
}

/// Words of IEC 61131-3 that stand for types which this language does not have, or begin a type.
const FOREIGN: [&str; 8] = ["ARRAY", "STRUCT", "DATE", "TOD", "DT", "TIME_OF_DAY", "DATE_AND_TIME", "LTIME"];

/// The type that was probably meant by a word of another language.
pub(super) fn usual_type(word: &str) -> Option<Type> {
    match word.to_ascii_uppercase().as_str() {
        "INTEGER" | "SHORT" => Some(Type::Int),
        "BOOLEAN" | "BIT" => Some(Type::Bool),
        "LONG" => Some(Type::Dint),
        "FLOAT" => Some(Type::Real),
        "DOUBLE" => Some(Type::Lreal),
        "CHAR" | "WSTRING" | "TEXT" => Some(Type::STRING),
        _ => None,
    }
}
