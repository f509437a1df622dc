//! Reads the types of a file: elementary ones and those that it declares.

use g7_model::codes;
use g7_model::{Composed, Expr, Name, Place, Type, VarDecl, say};

use super::initial::{Initial, declared};
use super::lex::Kind;
use super::parse::Parser;
use super::shape::{Shape, Types, no_array};

/// An elementary type or standard function block by its name in capitals.
pub fn elementary(upper: &str) -> Option<Type> {
    match upper {
        "WSTRING" => Some(text(80, true)),
        _ => Type::named(upper),
    }
}

/// The type of a text of so many characters. One of a WSTRING has up to three bytes in UTF-8 (decision 68).
pub(crate) fn text(length: u16, wide: bool) -> Type {
    Type::String(if wide { length.saturating_mul(3) } else { length })
}

/// True for a type that the numbers of an enumeration can have.
pub(crate) fn is_base(ty: Type) -> bool {
    ty.is_integer() || ty.is_bits() && ty != Type::Bool
}

impl Parser<'_> {
    /// Reads `TYPE … END_TYPE`; returns false if it does not stand here.
    pub(crate) fn type_block(&mut self, types: &mut Types) -> bool {
        if !self.eat_word("TYPE") {
            return false;
        }
        while !self.at_end() && !self.at_word("END_TYPE") {
            let before = self.mark();
            let Some(name) = self.name(say!("the name of a type")) else {
                self.skip_to(&["END_TYPE"]);
                break;
            };
            if self.eat_word("EXTENDS") {
                let at = self.here();
                self.say(&codes::NOT_CARRIED, &at, say!("a type that extends another one"));
                self.bump();
            }
            self.expect(":");
            types.declaring = Some(name.clone());
            let mut shape =
                if self.at_word("STRUCT") { self.structure(&name, types) } else { self.shape(&name, types) };
            types.declaring = None;
            let start = self.token().start;
            if self.eat(":=") {
                let init = self.initial();
                shape = shape.starting_with(init).unwrap_or_else(|shape| {
                    let what = say!("initial values of a structure's or array's type are not carried over");
                    let at = self.since(start);
                    self.report.put(g7_model::Problem::new(&codes::NOT_CARRIED, at, what));
                    shape
                });
            }
            self.eat(";");
            types.add(&name, shape);
            if self.mark() == before {
                self.bump();
            }
        }
        self.expect_word("END_TYPE");
        true
    }

    /// Skips to one of the words.
    pub(crate) fn skip_to(&mut self, words: &[&str]) {
        while !self.at_end() && !words.contains(&self.word().as_str()) {
            self.bump();
        }
    }

    /// Reads the type of a variable, or that of a type with this name.
    pub(crate) fn shape(&mut self, of: &Name, types: &mut Types) -> Shape {
        if !self.enter() {
            return Shape::Simple(Type::Bool, None);
        }
        let shape = self.shape_of(of, types);
        self.leave();
        shape
    }

    fn shape_of(&mut self, of: &Name, types: &mut Types) -> Shape {
        let at = self.here();
        let upper = self.word();
        match upper.as_str() {
            "ARRAY" => return self.array(of, types),
            "STRUCT" => {
                let name = types.free(of);
                return self.structure(&name, types);
            }
            "POINTER" | "REF_TO" | "REFERENCE" => {
                self.say(&codes::NOT_CARRIED, &at, say!("there are no pointers"));
                self.bump();
                self.eat_word("TO");
                return self.shape(of, types);
            }
            _ => {}
        }
        if self.at("(") {
            return self.enumeration(of, None, types);
        }
        let Some(name) = self.name(say!("a type")) else { return Shape::Simple(Type::Bool, None) };
        match elementary(&upper) {
            Some(Type::String(_)) => Shape::Simple(text(self.length(), upper == "WSTRING"), None),
            // Values with a type: `INT (Off := 0, Hand := 2)`; `INT (Least..7)` is a subrange.
            Some(ty)
                if is_base(ty)
                    && self.at("(")
                    && self.ahead(1).kind == Kind::Word
                    && !self.ahead_is(2, "..") =>
            {
                self.enumeration(of, Some(ty), types)
            }
            // `R_EDGE` and `F_EDGE` can stand behind BOOL; `declaration` reads them.
            Some(ty) => match self.subrange() {
                Some(limits) => Shape::Range(ty, Box::new(limits), None),
                None => Shape::Simple(ty, None),
            },
            None => types.get(&name.text).cloned().unwrap_or(Shape::Unknown(name)),
        }
    }

    /// `(0..10)` behind a type: the least and the greatest value (IEC 61131-3:2003, 2.3.3.1).
    fn subrange(&mut self) -> Option<(Expr, Expr)> {
        if !self.at("(") || self.ahead_is(1, ")") {
            return None;
        }
        self.bump();
        let least = self.expr();
        let limits = self.expect("..").then(|| (least, self.expr()));
        if !self.expect(")") {
            self.skip_to(&["END_VAR", "END_TYPE", "END_STRUCT"]);
        }
        limits
    }

    /// `STRING(20)`, `STRING[20]`.
    fn length(&mut self) -> u16 {
        let close = if self.eat("(") {
            ")"
        } else if self.eat("[") {
            "]"
        } else {
            return 80;
        };
        let token = self.token();
        let length = self.slice(token).parse::<u16>().ok().filter(|_| token.kind == Kind::Number);
        if length.is_none() {
            self.expected(say!("the length of a string"));
        }
        self.bump();
        self.expect(close);
        length.unwrap_or(80)
    }

    /// `(Off, Auto := 5, Hand)`. CODESYS and TwinCAT write the type of the numbers behind it.
    fn enumeration(&mut self, of: &Name, base: Option<Type>, types: &mut Types) -> Shape {
        self.bump();
        let mut values = Vec::new();
        while let Some(name) = self.name(say!("a value of the enumeration")) {
            let number = if self.eat(":=") { Some(self.expr()) } else { None };
            values.push((name, number));
            if !self.eat(",") {
                break;
            }
        }
        self.expect(")");
        let behind = elementary(&self.word()).filter(|ty| base.is_none() && is_base(*ty));
        if behind.is_some() {
            self.bump();
        }
        types.enumeration(of, base.or(behind).unwrap_or(Type::Int), values, self.report)
    }

    fn array(&mut self, of: &Name, types: &mut Types) -> Shape {
        self.bump();
        self.expect("[");
        let mut bounds = Vec::new();
        loop {
            let from = self.expr();
            if !self.expect("..") {
                self.skip_to(&["OF"]);
                break;
            }
            bounds.push((from, self.expr()));
            if !self.eat(",") {
                self.expect("]");
                break;
            }
        }
        self.expect_word("OF");
        let element = self.shape(of, types);
        Shape::array(bounds, element).unwrap_or_else(|element| {
            let at = self.here();
            self.say(&codes::NOT_CARRIED, &at, no_array());
            element
        })
    }

    /// Reads a structure, and declares its type.
    fn structure(&mut self, name: &Name, types: &mut Types) -> Shape {
        let start = self.bump().start;
        let mut members: Vec<VarDecl> = Vec::new();
        while !self.at_end() && !self.at_word("END_STRUCT") {
            let mut names = Vec::new();
            let from = self.token().start;
            while let Some(name) = self.name(say!("the name of an element")) {
                names.push(name);
                if !self.eat(",") {
                    break;
                }
            }
            let Some(first) = names.first().cloned() else { break };
            self.expect(":");
            let shape = self.shape(&first, types);
            let init: Option<Initial> = self.eat(":=").then(|| self.initial());
            self.eat(";");
            let at: Place = self.since(from).into();
            let comment = self.comment_behind();
            for name in names {
                let (mut member, problem) = declared(&name, &shape, init.as_ref(), at);
                member.comment.clone_from(&comment);
                problem.into_iter().for_each(|p| self.report.put(p));
                members.push(member);
            }
        }
        self.expect_word("END_STRUCT");
        let at = self.since(start).into();
        let name = name.clone();
        types.add(&name, Shape::Struct(name.clone()));
        let made = Composed {
            name: name.clone(),
            comment: None,
            members,
            inouts: Vec::new(),
            block: false,
            body: None,
            at,
        };
        types.structures.push(made);
        Shape::Struct(name)
    }
}
