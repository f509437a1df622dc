//! Declarations of variables.

use g7_model::codes;
use g7_model::{Expr, Limits, Name, Problem, Type, VarDecl, VarKind, say};

use super::initial::declared;
use super::lex::Kind;
use super::parse::Parser;
use super::shape::Types;

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
    /// The name of the type if it is not declared before: that of a function block of the file.
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
    pub(crate) fn declarations(&mut self, types: &mut Types, found: &mut Vec<Variable>) -> bool {
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

    /// Reads the type behind the name of a function: the declaration of its result.
    pub(crate) fn result(&mut self, function: &Name, types: &mut Types) -> Option<Variable> {
        let start = self.token().start;
        let shape = self.shape(function, types);
        let (decl, _) = declared(function, &shape, None, self.since(start).into());
        Some(Variable { section: Section::Output, decl, unknown: shape.unknown().cloned() })
    }

    /// Skips to the next `;` after a problem.
    fn next_declaration(&mut self) {
        while !self.at_end() && !self.at_word("END_VAR") && !self.at(";") {
            self.bump();
        }
        self.eat(";");
    }

    /// Reads `a, b AT %I0.0 : BOOL R_EDGE := TRUE;`; returns false if it could not be read.
    fn declaration(&mut self, head: Head, types: &mut Types, found: &mut Vec<Variable>) -> bool {
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
        let Some((first, _)) = names.first().cloned() else { return false };
        let shape = self.shape(&first, types);
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
            let (mut decl, problem) = declared(&name, &shape, init.as_ref(), at);
            problem.into_iter().for_each(|p| self.report.put(p));
            let unknown = shape.unknown().cloned();
            decl.kind = kind(head, &decl, address.as_ref());
            decl.address = address;
            if !(self.of_function && head.section == Section::Input) {
                fit(&mut decl).into_iter().for_each(|p| self.report.put(p));
            }
            decl.retain = head.retain && decl.kind == VarKind::Var;
            decl.comment.clone_from(&comment);
            found.push(Variable { section: head.section, decl, unknown });
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

    /// The comment behind the declaration on the same line.
    pub(super) fn comment_behind(&self) -> Option<Box<str>> {
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

/// Gives a declaration the form that its kind asks for: a constant has a value and no address, an input no limits.
pub(crate) fn fit(decl: &mut VarDecl) -> Option<Problem> {
    if decl.kind == VarKind::Const {
        decl.address = None;
        if decl.init.is_none() && decl.array.is_none() && decl.of.is_none() {
            decl.init = Some(Expr::zero(decl.ty, decl.at));
        }
    }
    decl.limits.take_if(|l| decl.kind == VarKind::Input && matches!(**l, Limits::Range(..)))?;
    let name = decl.names.first()?;
    let what = say!("the limits of the input `{}` are not checked", name.text);
    Some(Problem::new(&codes::LEFT_OUT, decl.at.0, what))
}

/// The kind of a variable, from its section or its address.
fn kind(head: Head, decl: &VarDecl, address: Option<&Name>) -> VarKind {
    if head.constant {
        return VarKind::Const;
    }
    if matches!(decl.ty, Type::Fb(_)) {
        return VarKind::Var;
    }
    if let Some(kind) = head.channel {
        return kind;
    }
    let address = address.map_or("", |a| &*a.text);
    match head.section {
        Section::Input => VarKind::Input,
        Section::Output => VarKind::Output,
        _ if address.starts_with("%I") => VarKind::Input,
        _ if address.starts_with("%Q") => VarKind::Output,
        _ => VarKind::Var,
    }
}
