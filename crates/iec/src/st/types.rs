//! The types of a file: elementary ones and those that it declares.

use std::collections::HashMap;
use std::ops::Range;

use g7_model::codes;
use g7_model::{Expr, Name, Type, say};

use super::lex::Kind;
use super::parse::Parser;

/// The most elements of one array or structure, at all levels together.
const MOST_ELEMENTS: usize = 2000;

/// An elementary type or standard function block by its name in capitals.
pub fn elementary(upper: &str) -> Option<Type> {
    match upper {
        "LTIME" => Some(Type::Time),
        "WSTRING" => Some(Type::STRING),
        _ => Type::named(upper),
    }
}

/// The structure of a type.
#[derive(Clone, Debug)]
pub(crate) enum Shape {
    Simple(Type, Option<Expr>),
    /// The names of its values, numbered from 0, and its initial value.
    Enum(Vec<Name>, Option<Expr>),
    Struct(Vec<(Name, Shape)>),
    Array(Vec<(i64, i64)>, Box<Shape>),
    /// An unknown function block or type.
    Unknown(Name),
}

/// The types that a file declares, by their names in upper case.
#[derive(Clone, Debug, Default)]
pub(crate) struct Types {
    shapes: HashMap<String, Shape>,
    /// The values of all enumerations, with their numbers.
    pub(crate) values: Vec<(Name, i128)>,
}

impl Types {
    /// Adds a type, and its values if it is an enumeration.
    pub(crate) fn add(&mut self, name: &Name, shape: Shape) {
        if let Shape::Enum(names, _) = &shape {
            self.values.extend(names.iter().cloned().zip(0..));
        }
        self.shapes.insert(name.text.to_ascii_uppercase(), shape);
    }

    fn get(&self, name: &str) -> Option<&Shape> {
        self.shapes.get(&name.to_ascii_uppercase())
    }
}

impl Shape {
    /// The number of variables that it stands for.
    pub(super) fn size(&self) -> usize {
        match self {
            Shape::Struct(fields) => fields.iter().fold(0, |n: usize, (_, f)| n.saturating_add(f.size())),
            Shape::Array(bounds, element) => {
                let length = |(from, to): &(i64, i64)| {
                    usize::try_from(to.saturating_sub(*from).saturating_add(1)).unwrap_or(usize::MAX)
                };
                bounds.iter().map(length).fold(element.size(), usize::saturating_mul)
            }
            _ => 1,
        }
    }
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
            let mut shape = self.shape(types);
            if self.eat(":=") {
                let init = self.expr();
                shape = match shape {
                    Shape::Simple(ty, _) => Shape::Simple(ty, Some(init)),
                    Shape::Enum(names, _) => Shape::Enum(names, Some(init)),
                    other => {
                        let at = init.at.0;
                        let what =
                            say!("initial values of a structure's or array's type are not carried over");
                        self.report.put(g7_model::Problem::new(&codes::NOT_CARRIED, at, what));
                        other
                    }
                };
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

    /// Reads a type.
    pub(crate) fn shape(&mut self, types: &Types) -> Shape {
        let start = self.token().start;
        if !self.enter() {
            return Shape::Simple(Type::Bool, None);
        }
        let shape = self.shape_of(types);
        self.leave();
        if shape.size() > MOST_ELEMENTS {
            let at = self.range(start as usize, self.behind());
            let what = say!("an array or structure of more than {MOST_ELEMENTS} elements");
            self.say(&codes::NOT_CARRIED, &at, what);
            return Shape::Simple(Type::Bool, None);
        }
        shape
    }

    fn shape_of(&mut self, types: &Types) -> Shape {
        let at = self.here();
        let upper = self.word();
        match upper.as_str() {
            "ARRAY" => return self.array(types),
            "STRUCT" => return self.structure(types),
            "POINTER" | "REF_TO" | "REFERENCE" => {
                self.say(&codes::NOT_CARRIED, &at, say!("there are no pointers"));
                self.bump();
                self.eat_word("TO");
                return self.shape(types);
            }
            "DATE" | "DT" | "DATE_AND_TIME" | "TOD" | "TIME_OF_DAY" | "LDT" | "LTOD" | "LDATE" => {
                self.say(&codes::NOT_CARRIED, &at, say!("there are no dates and times of day"));
                self.bump();
                return Shape::Simple(Type::Time, None);
            }
            _ => {}
        }
        if self.at("(") {
            return self.enumeration();
        }
        let Some(name) = self.name(say!("a type")) else { return Shape::Simple(Type::Bool, None) };
        match elementary(&upper) {
            Some(Type::String(_)) => Shape::Simple(Type::String(self.length()), None),
            Some(ty) => {
                self.subrange(&at);
                // The declaration reads the direction of an input: `BOOL R_EDGE`.
                Shape::Simple(ty, None)
            }
            None => types.get(&name.text).cloned().unwrap_or(Shape::Unknown(name)),
        }
    }

    /// `INT (0..10)`: the limits are dropped with a report.
    fn subrange(&mut self, at: &Range<usize>) {
        if !self.at("(") || self.ahead_is(1, ")") {
            return;
        }
        self.report.element(
            &codes::LEFT_OUT,
            "subrange",
            at,
            say!("the limits of a subrange are not checked"),
        );
        let mut depth = 0usize;
        while !self.at_end() {
            if self.at("(") {
                depth += 1;
            } else if self.at(")") {
                depth -= 1;
            }
            self.bump();
            if depth == 0 {
                return;
            }
        }
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

    fn enumeration(&mut self) -> Shape {
        self.bump();
        let mut names = Vec::new();
        while let Some(name) = self.name(say!("a value of the enumeration")) {
            if self.at(":=") {
                let at = self.here();
                self.say(
                    &codes::NOT_CARRIED,
                    &at,
                    say!("numbers of an enumeration's values are not carried over"),
                );
                self.bump();
                self.expr();
            }
            names.push(name);
            if !self.eat(",") {
                break;
            }
        }
        self.expect(")");
        Shape::Enum(names, None)
    }

    fn array(&mut self, types: &Types) -> Shape {
        self.bump();
        self.expect("[");
        let mut bounds = Vec::new();
        while let Some(from) = self.bound() {
            self.expect("..");
            let Some(to) = self.bound() else { break };
            bounds.push((from, to.max(from)));
            if !self.eat(",") {
                break;
            }
        }
        self.expect("]");
        self.expect_word("OF");
        let element = self.shape(types);
        Shape::Array(bounds, Box::new(element))
    }

    fn bound(&mut self) -> Option<i64> {
        let negative = self.eat("-");
        let token = self.token();
        let number = self.slice(token).parse::<i64>().ok().filter(|_| token.kind == Kind::Number);
        match number {
            Some(n) => {
                self.bump();
                Some(if negative { -n } else { n })
            }
            None => {
                let at = self.here();
                self.say(&codes::NOT_CARRIED, &at, say!("the limits of an array are written as numbers"));
                self.skip_to(&["OF"]);
                None
            }
        }
    }

    fn structure(&mut self, types: &Types) -> Shape {
        self.bump();
        let mut fields = Vec::new();
        while !self.at_end() && !self.at_word("END_STRUCT") {
            let mut names = Vec::new();
            while let Some(name) = self.name(say!("the name of an element")) {
                names.push(name);
                if !self.eat(",") {
                    break;
                }
            }
            if names.is_empty() {
                break;
            }
            self.expect(":");
            let mut shape = self.shape(types);
            if self.eat(":=") {
                let init = self.expr();
                if let Shape::Simple(_, value) | Shape::Enum(_, value) = &mut shape {
                    *value = Some(init);
                }
            }
            self.eat(";");
            fields.extend(names.into_iter().map(|name| (name, shape.clone())));
        }
        self.expect_word("END_STRUCT");
        self.eat(";");
        Shape::Struct(fields)
    }
}
