//! Reads the templates of `runtime/`: functions and structures in the small part
//! of Rust that [`crate::tree`] is. What depends on the program is a name in
//! capitals, put in and folded while reading: `if HAS_ORDERS { … }` is there or not.

use std::collections::HashMap;

use crate::tree::{Bin, Block, Expr, Field, Function, Module, Stmt, Struct, Ty, Un};

/// What names in capitals stand for.
#[derive(Clone, Debug, Default)]
pub(crate) struct Facts {
    pub(crate) flags: HashMap<&'static str, bool>,
    pub(crate) sizes: HashMap<&'static str, usize>,
}

#[derive(Clone, Debug, PartialEq)]
enum Token {
    Word(String),
    Number(i128, Option<Ty>),
    Sign(&'static str),
    Note(String),
    End,
}

const SIGNS: [&str; 42] = [
    "<<=", ">>=", "->", "=>", "==", "!=", "<=", ">=", "&&", "||", "<<", ">>", "+=", "-=", "|=", "&=", "^=",
    "..", "+", "-", "*", "/", "%", "&", "|", "^", "!", "=", "<", ">", "(", ")", "[", "]", "{", "}", ",", ";",
    ":", ".", "#", "?",
];

fn tokens(text: &str) -> Vec<Token> {
    let mut all = Vec::new();
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        if c.is_whitespace() {
            rest = &rest[c.len_utf8()..];
        } else if let Some(note) = rest.strip_prefix("//") {
            let end = note.find('\n').unwrap_or(note.len());
            all.push(Token::Note(note[..end].trim_start_matches('/').trim().to_owned()));
            rest = &note[end..];
        } else if c.is_ascii_digit() {
            let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
            all.push(number(&rest[..end]));
            rest = &rest[end..];
        } else if c.is_alphabetic() || c == '_' {
            let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
            all.push(Token::Word(rest[..end].to_owned()));
            rest = &rest[end..];
        } else {
            let sign = SIGNS.into_iter().find(|s| rest.starts_with(s)).unwrap_or("?");
            all.push(Token::Sign(sign));
            rest = &rest[sign.len()..];
        }
    }
    all.push(Token::End);
    all
}

fn number(text: &str) -> Token {
    let plain = text.replace('_', "");
    let hex = plain.strip_prefix("0x");
    let digits = plain.find(['u', 'i']).filter(|_| hex.is_none() || plain.contains(['u', 'i']));
    let (value, suffix) = plain.split_at(digits.unwrap_or(plain.len()));
    let value = match hex {
        Some(_) => i128::from_str_radix(value.trim_start_matches("0x"), 16),
        None => value.parse(),
    };
    Token::Number(value.unwrap_or(0), scalar(suffix))
}

fn scalar(word: &str) -> Option<Ty> {
    Some(match word {
        "bool" => Ty::Bool,
        "usize" => Ty::Size,
        "f32" => Ty::Real { bits: 32 },
        "f64" => Ty::Real { bits: 64 },
        _ => {
            let (sign, bits) = word.split_at_checked(1)?;
            let bits = bits.parse().ok()?;
            Ty::Int { signed: sign == "i", bits }
        }
    })
}

/// A template read with the facts of a program. A mistake in a template is one of
/// ours: it shows in the first test.
pub(crate) fn read(text: &str, facts: &Facts) -> Module {
    let mut r = Reader { tokens: tokens(text), at: 0, facts };
    let mut m = Module::default();
    let mut note = String::new();
    loop {
        match r.next() {
            Token::End => return m,
            Token::Note(n) => {
                note += if note.is_empty() { "" } else { "\n" };
                note += &n;
            }
            Token::Word(w) if w == "fn" || w == "pub" => {
                let public = w == "pub";
                if public {
                    r.next();
                }
                m.functions.push(r.function(public, std::mem::take(&mut note)));
            }
            Token::Word(w) if w == "struct" => m.structs.push(r.structure(std::mem::take(&mut note))),
            _ => {}
        }
    }
}

struct Reader<'a> {
    tokens: Vec<Token>,
    at: usize,
    facts: &'a Facts,
}

impl Reader<'_> {
    fn peek(&self) -> &Token {
        self.tokens.get(self.at).unwrap_or(&Token::End)
    }

    fn next(&mut self) -> Token {
        let t = self.peek().clone();
        self.at += 1;
        t
    }

    fn has(&mut self, sign: &str) -> bool {
        let found = matches!(self.peek(), Token::Sign(s) if *s == sign);
        self.at += usize::from(found);
        found
    }

    fn has_word(&mut self, word: &str) -> bool {
        let found = matches!(self.peek(), Token::Word(w) if w == word);
        self.at += usize::from(found);
        found
    }

    fn need(&mut self, sign: &str) {
        let found = self.has(sign);
        debug_assert!(found, "{sign} expected at {:?}", self.tokens.get(self.at..self.at + 8));
        if !found {
            self.at += 1;
        }
    }

    fn word(&mut self) -> String {
        match self.next() {
            Token::Word(w) => w,
            _ => String::new(),
        }
    }

    fn length(&mut self) -> usize {
        match self.next() {
            Token::Number(n, _) => n as usize,
            Token::Word(w) => self.facts.sizes.get(w.as_str()).copied().unwrap_or(0),
            _ => 0,
        }
    }

    fn ty(&mut self) -> Ty {
        if self.has("&") {
            let mutable = self.has_word("mut");
            if self.has("[") {
                let of = self.ty();
                self.need("]");
                return Ty::Slice(mutable, Box::new(of));
            }
            return Ty::Ref(mutable, Box::new(self.ty()));
        }
        if self.has("[") {
            let of = self.ty();
            self.need(";");
            let n = self.length();
            self.need("]");
            return Ty::Array(Box::new(of), n);
        }
        let word = self.word();
        if word == "row" {
            let bits = self.facts.sizes.get("ROW_BITS").copied().unwrap_or(32);
            return Ty::Int { signed: false, bits: bits as u8 };
        }
        scalar(&word).unwrap_or(Ty::Named(word))
    }

    fn structure(&mut self, note: String) -> Struct {
        let name = self.word();
        self.need("{");
        let mut fields = Vec::new();
        let mut about = String::new();
        loop {
            match self.next() {
                Token::Note(n) => about = n,
                Token::Word(name) => {
                    self.need(":");
                    let ty = self.ty();
                    self.has(",");
                    fields.push(Field { name, ty, note: std::mem::take(&mut about), kept: false });
                }
                _ => break,
            }
        }
        Struct { public: true, note, name, fields }
    }

    fn function(&mut self, public: bool, note: String) -> Function {
        let name = self.word();
        self.need("(");
        let mut parameters = Vec::new();
        while !self.has(")") {
            let name = self.word();
            self.need(":");
            parameters.push((name, self.ty()));
            self.has(",");
        }
        let result = self.has("->").then(|| self.ty());
        let body = self.block();
        Function { public, note, name, parameters, result, body }
    }

    fn block(&mut self) -> Block {
        self.need("{");
        let mut all = Block::new();
        while !self.has("}") {
            if *self.peek() == Token::End {
                break;
            }
            self.statement(&mut all);
        }
        // What stands behind a way out that is always taken.
        if let Some(at) = all.iter().position(|s| matches!(s, Stmt::Return(_))) {
            all.truncate(at + 1);
        }
        all
    }

    fn statement(&mut self, all: &mut Block) {
        if let Token::Note(n) = self.peek() {
            let n = n.clone();
            self.at += 1;
            all.push(Stmt::Note(n));
        } else if self.has_word("let") {
            let mutable = self.has_word("mut");
            let name = self.word();
            self.need(":");
            let ty = self.ty();
            self.need("=");
            let value = self.expr(0);
            self.need(";");
            all.push(Stmt::Let { mutable, name, ty, value });
        } else if self.has_word("if") {
            self.alternatives(all);
        } else if self.has_word("while") {
            let c = self.expr(0);
            let body = self.block();
            if c != Expr::Bool(false) {
                all.push(Stmt::While(c, body));
            }
        } else if self.has_word("for") {
            let name = self.word();
            self.has_word("in");
            let from = self.expr(0);
            self.need("..");
            let to = self.expr(0);
            let body = self.block();
            if from != to {
                all.push(Stmt::For(name, from, to, body));
            }
        } else if self.has_word("return") {
            let value = if self.has(";") { None } else { Some(self.expr(0)) };
            if value.is_some() {
                self.need(";");
            }
            all.push(Stmt::Return(value));
        } else if self.has_word("break") {
            self.need(";");
            all.push(Stmt::Break);
        } else {
            let to = self.expr(0);
            all.push(self.assignment(to));
            self.need(";");
        }
    }

    fn assignment(&mut self, to: Expr) -> Stmt {
        let ops = [
            ("=", None),
            ("+=", Some(Bin::Add)),
            ("-=", Some(Bin::Sub)),
            ("|=", Some(Bin::BitOr)),
            ("&=", Some(Bin::BitAnd)),
            ("^=", Some(Bin::BitXor)),
            ("<<=", Some(Bin::Shl)),
            (">>=", Some(Bin::Shr)),
        ];
        for (sign, op) in ops {
            if self.has(sign) {
                return Stmt::Assign(op, to, self.expr(0));
            }
        }
        Stmt::Do(to)
    }

    fn alternatives(&mut self, all: &mut Block) {
        let c = self.expr(0);
        let then = self.block();
        let mut other = Block::new();
        if self.has_word("else") {
            if self.has_word("if") {
                self.alternatives(&mut other);
            } else {
                other = self.block();
            }
        }
        match c {
            Expr::Bool(true) => all.extend(then),
            Expr::Bool(false) => all.extend(other),
            c => all.push(Stmt::If(c, then, other)),
        }
    }

    fn expr(&mut self, least: u8) -> Expr {
        let mut left = self.unary();
        loop {
            if self.has_word("as") {
                left = left.cast(self.ty());
                continue;
            }
            let Token::Sign(sign) = *self.peek() else { return left };
            let Some(op) = operator(sign).filter(|op| op.tightness() > least) else { return left };
            self.at += 1;
            let right = self.expr(op.tightness());
            left = fold(op, left, right);
        }
    }

    fn unary(&mut self) -> Expr {
        if self.has("!") {
            return self.unary().not();
        }
        if self.has("-") {
            return Expr::Un(Un::Neg, Box::new(self.unary()));
        }
        if self.has("*") {
            return Expr::Deref(Box::new(self.unary()));
        }
        if self.has("&") {
            let mutable = self.has_word("mut");
            return Expr::Ref(mutable, Box::new(self.unary()));
        }
        let mut e = self.primary();
        loop {
            if self.has(".") {
                e = e.field(self.word());
            } else if self.has("[") {
                let i = self.expr(0);
                self.need("]");
                e = e.at(i);
            } else {
                return e;
            }
        }
    }

    fn primary(&mut self) -> Expr {
        match self.next() {
            Token::Number(n, ty) => Expr::Int(n, ty),
            Token::Sign("(") => {
                let e = self.expr(0);
                self.need(")");
                e
            }
            Token::Word(w) if w == "true" => Expr::Bool(true),
            Token::Word(w) if w == "false" => Expr::Bool(false),
            Token::Word(w) if self.has("(") => {
                let mut args = Vec::new();
                while !self.has(")") {
                    args.push(self.expr(0));
                    self.has(",");
                }
                Expr::Call(w, args)
            }
            Token::Word(w) => match (self.facts.flags.get(w.as_str()), self.facts.sizes.get(w.as_str())) {
                (Some(b), _) => Expr::Bool(*b),
                (_, Some(n)) => Expr::size(*n),
                _ => Expr::Name(w),
            },
            other => {
                debug_assert!(false, "no expression: {other:?}");
                Expr::Bool(false)
            }
        }
    }
}

fn operator(sign: &str) -> Option<Bin> {
    const ALL: [Bin; 18] = [
        Bin::Mul,
        Bin::Div,
        Bin::Rem,
        Bin::Add,
        Bin::Sub,
        Bin::Shl,
        Bin::Shr,
        Bin::BitAnd,
        Bin::BitXor,
        Bin::BitOr,
        Bin::Eq,
        Bin::Ne,
        Bin::Lt,
        Bin::Le,
        Bin::Gt,
        Bin::Ge,
        Bin::And,
        Bin::Or,
    ];
    ALL.into_iter().find(|op| op.text() == sign)
}

/// Leaves out what is known beforehand.
fn fold(op: Bin, left: Expr, right: Expr) -> Expr {
    match (op, &left, &right) {
        (Bin::And, Expr::Bool(true), _) | (Bin::Or, Expr::Bool(false), _) => right,
        (Bin::And, _, Expr::Bool(true)) | (Bin::Or, _, Expr::Bool(false)) => left,
        (Bin::And, Expr::Bool(false), _) | (Bin::And, _, Expr::Bool(false)) => Expr::Bool(false),
        (Bin::Or, Expr::Bool(true), _) | (Bin::Or, _, Expr::Bool(true)) => Expr::Bool(true),
        _ => left.bin(op, right),
    }
}
