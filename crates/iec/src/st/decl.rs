//! Declarations of variables.

use g7_model::codes;
use g7_model::{Expr, ExprKind, Name, Path, Place, Problem, Type, VarDecl, VarKind, say};

use super::lex::Kind;
use super::parse::Parser;
use super::types::{Shape, Types};

/// The kind of section in which a variable is declared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Section {
    Local,
    Input,
    Output,
    InOut,
    Temp,
    External,
    Global,
}

/// A declared variable.
#[derive(Clone, Debug)]
pub(crate) struct Variable {
    pub(crate) section: Section,
    /// The declaration, with one name. Inputs and outputs of the plant are those of the program, or
    /// variables with an address.
    pub(crate) decl: VarDecl,
    /// The name of the type if it is unknown: a function block of the file.
    pub(crate) unknown: Option<Name>,
}

/// The words at the head of a section.
#[derive(Clone, Copy)]
struct Head {
    section: Section,
    /// The direction of global variables, if the name of their list tells it.
    channel: Option<VarKind>,
    constant: bool,
    retain: bool,
}

impl Parser<'_> {
    /// Reads one section of declarations; returns false if none stands here.
    pub(crate) fn declarations(&mut self, types: &Types, found: &mut Vec<Variable>) -> bool {
        let at = self.here();
        let section = match self.word().as_str() {
            "VAR" => Section::Local,
            "VAR_INPUT" => Section::Input,
            "VAR_OUTPUT" => Section::Output,
            "VAR_IN_OUT" => Section::InOut,
            "VAR_TEMP" => Section::Temp,
            "VAR_EXTERNAL" => Section::External,
            "VAR_GLOBAL" => Section::Global,
            "VAR_STAT" | "VAR_INST" => Section::Local,
            "VAR_ACCESS" | "VAR_CONFIG" => {
                let what = say!("a section `{}` is left out", self.word());
                self.say(&codes::LEFT_OUT, &at, what);
                self.skip_to(&["END_VAR"]);
                self.bump();
                return true;
            }
            _ => return false,
        };
        self.bump();
        let mut head = Head { section, channel: None, constant: false, retain: false };
        loop {
            match self.word().as_str() {
                "CONSTANT" => head.constant = true,
                "RETAIN" | "PERSISTENT" => head.retain = true,
                "NON_RETAIN" | "PUBLIC" | "PRIVATE" | "PROTECTED" | "INTERNAL" => {}
                _ => break,
            }
            if self.ahead_is(1, ":") || self.ahead_is(1, ",") {
                break;
            }
            self.bump();
        }
        // Names of lists of global variables say nothing about their use, except for the lists that
        // we write.
        if section == Section::Global {
            head.channel = match self.comment_behind().as_deref() {
                Some("inputs") => Some(VarKind::Input),
                Some("outputs") => Some(VarKind::Output),
                _ => None,
            };
        }
        while !self.at_end() && !self.at_word("END_VAR") {
            let before = self.mark();
            if !self.declaration(head, types, found) || self.mark() == before {
                self.next_declaration();
            }
        }
        self.expect_word("END_VAR");
        self.eat(";");
        true
    }

    /// Skips to the next `;` after a problem.
    fn next_declaration(&mut self) {
        while !self.at_end() && !self.at_word("END_VAR") && !self.at(";") {
            self.bump();
        }
        self.eat(";");
    }

    /// Reads `a, b AT %I0.0 : BOOL R_EDGE := TRUE;`; returns false if it could not be read.
    fn declaration(&mut self, head: Head, types: &Types, found: &mut Vec<Variable>) -> bool {
        let start = self.token().start;
        let mut names = Vec::new();
        loop {
            if self.at_word("AT") && self.ahead(1).kind == Kind::Direct {
                break;
            }
            match self.name(say!("the name of a variable")) {
                Some(name) => names.push((name, None)),
                None => return false,
            }
            if let Some(last) = names.last_mut() {
                last.1 = self.address();
            }
            if !self.eat(",") {
                break;
            }
        }
        // A variable without a name is known by its address.
        if names.is_empty() {
            let address = self.address();
            if let Some(address) = address {
                names.push((address.clone(), Some(address)));
            }
        }
        if !self.expect(":") {
            return false;
        }
        let shape = self.shape(types);
        self.edge_inputs(&names);
        let init = if self.eat(":=") { Some(self.initial()) } else { None };
        self.arguments();
        let ended = self.eat(";");
        if !ended {
            self.expected(say!("`;`"));
        }
        let at = self.since(start).into();
        let comment = self.comment_behind();
        for (name, address) in names {
            let mut maker = Maker { head, address, comment: comment.clone(), at, found };
            let problem = maker.make(&name, &shape, init.as_ref());
            if let Some(problem) = problem {
                self.report.put(problem);
            }
        }
        ended
    }

    /// `AT %I0.0`.
    fn address(&mut self) -> Option<Name> {
        if !self.at_word("AT") || self.ahead(1).kind != Kind::Direct {
            return None;
        }
        self.bump();
        let token = self.bump();
        Some(Name::new(self.slice(token).to_ascii_uppercase(), self.span_of(token)))
    }

    /// Handles `BOOL R_EDGE`: the input is an edge.
    fn edge_inputs(&mut self, names: &[(Name, Option<Name>)]) {
        if !self.at_word("R_EDGE") && !self.at_word("F_EDGE") {
            return;
        }
        let at = self.here();
        let word = self.word();
        let first = names.first().map_or("", |(n, _)| &*n.text);
        let sign = if word == "R_EDGE" { "↑" } else { "↓" };
        let what = say!("`{first}` is the level here, not its edge; write `{sign}{first}` where it is read");
        self.say(&codes::NOT_CARRIED, &at, what);
        self.bump();
    }

    /// Skips arguments, which CODESYS allows: `fb : F(a, b)`.
    fn arguments(&mut self) {
        if self.at("(") {
            let at = self.here();
            self.say(&codes::NOT_CARRIED, &at, say!("arguments of a declaration have no counterpart"));
            self.args();
        }
    }

    fn initial(&mut self) -> Initial {
        let start = self.token().start;
        if self.at("[") {
            return self.array_value(start, "[", "]");
        }
        let named = self.at("(") && self.ahead(1).kind == Kind::Word && self.ahead_is(2, ":=");
        if named {
            return self.struct_value();
        }
        Initial::One(self.expr())
    }

    /// `[1, 2, 3(0)]`.
    fn array_value(&mut self, start: u32, open: &str, close: &str) -> Initial {
        let mut list = Vec::new();
        if !self.enter() {
            return Initial::One(self.bad(start));
        }
        self.expect(open);
        while !self.at_end() && !self.at(close) {
            let token = self.token();
            let times = self.slice(token).parse::<usize>().ok();
            if let Some(times) = times.filter(|_| token.kind == Kind::Number && self.ahead_is(1, "(")) {
                self.bump();
                self.bump();
                let value = self.initial();
                self.expect(")");
                list.extend(std::iter::repeat_n(value, times.min(2000)));
            } else {
                list.push(self.initial());
            }
            if !self.eat(",") || list.len() > 10_000 {
                break;
            }
        }
        self.expect(close);
        self.leave();
        Initial::List(list)
    }

    /// `(a := 1, b := 2)`.
    fn struct_value(&mut self) -> Initial {
        let mut fields = Vec::new();
        if !self.enter() {
            return Initial::Fields(fields);
        }
        self.bump();
        while let Some(name) = self.name(say!("the name of an element")) {
            self.expect(":=");
            fields.push((name, self.initial()));
            if !self.eat(",") {
                break;
            }
        }
        self.expect(")");
        self.leave();
        Initial::Fields(fields)
    }

    /// The comment behind the declaration on the same line.
    fn comment_behind(&self) -> Option<Box<str>> {
        let end = self.behind();
        let index = self.comments.partition_point(|c| c.start < end);
        let comment = self.comments.get(index)?;
        let between = self.text.get(end..comment.start)?;
        if !between.trim().is_empty() || between.contains('\n') {
            return None;
        }
        let text = self.text.get(comment.clone())?;
        let text = text.trim_start_matches(['(', '*', '/']).trim_end_matches(['*', ')', '/']);
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        (!text.is_empty()).then(|| text.into())
    }
}

/// An initial value as written.
#[derive(Clone, Debug)]
enum Initial {
    One(Expr),
    List(Vec<Initial>),
    Fields(Vec<(Name, Initial)>),
}

/// Makes the variables that belong to one declared name.
struct Maker<'f> {
    head: Head,
    address: Option<Name>,
    comment: Option<Box<str>>,
    at: Place,
    found: &'f mut Vec<Variable>,
}

impl Maker<'_> {
    fn make(&mut self, name: &Name, shape: &Shape, init: Option<&Initial>) -> Option<Problem> {
        match shape {
            Shape::Simple(ty, default) => self.one(name, *ty, default.as_ref(), init, None),
            Shape::Enum(values, default) => {
                let at = name.at;
                let first = values.first().map(|v| path(&v.text, at));
                let default = default.clone().or(first);
                self.one(name, Type::Int, default.as_ref(), init, None)
            }
            Shape::Unknown(ty) => self.one(name, Type::Bool, None, init, Some(ty.clone())),
            Shape::Struct(fields) => self.structure(name, fields, init),
            Shape::Array(bounds, element) => self.array(name, bounds, element, init),
        }
    }

    fn one(
        &mut self,
        name: &Name,
        ty: Type,
        default: Option<&Expr>,
        init: Option<&Initial>,
        unknown: Option<Name>,
    ) -> Option<Problem> {
        let mut problem = None;
        let mut value = default.cloned();
        match init {
            Some(Initial::One(e)) if e.kind != ExprKind::Bad => value = Some(e.clone()),
            Some(Initial::One(_)) | None => {}
            Some(_) => {
                let what = say!(
                    "the initial values of `{}` do not fit its type, or cannot be carried over",
                    name.text
                );
                problem = Some(Problem::new(&codes::NOT_CARRIED, self.at.0, what));
            }
        }
        let kind = self.kind(ty);
        if kind == VarKind::Const && value.is_none() && unknown.is_none() {
            value = Some(Expr::zero(ty, self.at));
        }
        let decl = VarDecl {
            init: value,
            address: self.address.clone().filter(|_| kind != VarKind::Const),
            retain: self.head.retain && kind == VarKind::Var,
            comment: self.comment.clone(),
            ..VarDecl::new(kind, vec![name.clone()], ty, self.at)
        };
        self.found.push(Variable { section: self.head.section, decl, unknown });
        problem
    }

    /// The kind of a variable, from its section or its address.
    fn kind(&self, ty: Type) -> VarKind {
        if self.head.constant {
            return VarKind::Const;
        }
        if matches!(ty, Type::Fb(_)) {
            return VarKind::Var;
        }
        if let Some(kind) = self.head.channel {
            return kind;
        }
        let address = self.address.as_ref().map_or("", |a| &*a.text);
        match self.head.section {
            Section::Input => VarKind::Input,
            Section::Output => VarKind::Output,
            _ if address.starts_with("%I") => VarKind::Input,
            _ if address.starts_with("%Q") => VarKind::Output,
            _ => VarKind::Var,
        }
    }

    fn structure(
        &mut self,
        name: &Name,
        fields: &[(Name, Shape)],
        init: Option<&Initial>,
    ) -> Option<Problem> {
        let mut problem = None;
        for (field, shape) in fields {
            let value = match init {
                Some(Initial::Fields(values)) => {
                    values.iter().find(|(n, _)| n.text.eq_ignore_ascii_case(&field.text)).map(|(_, v)| v)
                }
                _ => None,
            };
            let name = Name { text: format!("{}.{}", name.text, field.text).into(), at: name.at };
            problem = self.make(&name, shape, value).or(problem);
        }
        problem
    }

    fn array(
        &mut self,
        name: &Name,
        bounds: &[(i64, i64)],
        element: &Shape,
        init: Option<&Initial>,
    ) -> Option<Problem> {
        let mut problem = None;
        let mut index: Vec<i64> = bounds.iter().map(|b| b.0).collect();
        let mut number = 0;
        loop {
            let text = index.iter().map(i64::to_string).collect::<Vec<_>>().join(",");
            let value = match init {
                Some(Initial::List(values)) => values.get(number),
                other => other,
            };
            let name = Name { text: format!("{}[{text}]", name.text).into(), at: name.at };
            problem = self.make(&name, element, value).or(problem);
            number += 1;
            // The last index runs fastest.
            let mut place = index.len();
            loop {
                let Some(before) = place.checked_sub(1) else { return problem };
                place = before;
                let (Some(i), Some((from, to))) = (index.get_mut(place), bounds.get(place)) else {
                    return problem;
                };
                if *i < *to {
                    *i += 1;
                    break;
                }
                *i = *from;
            }
        }
    }
}

fn path(name: &str, at: Place) -> Expr {
    Expr { kind: ExprKind::Path(Path { names: vec![Name { text: name.into(), at }] }), at }
}
