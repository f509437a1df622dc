//! Types and initial values of variables, in the forms that the reader of texts has for them.
//!
//! ```text
//! read (Project) -> here (Shapes) -> declare, code
//! ```

use std::collections::HashMap;
use std::ops::Range;

use g7_model::codes;
use g7_model::{Composed, Expr, ExprKind, Literal, Name, Span, Type, UnaryOp, VarDecl, say};
use roxmltree::NodeId;

use super::read::{Project, duration, type_of};
use super::tree::{Xml, documentation, head, kid, kids, name_of, tag, text, word};
use crate::nodes::line;
use crate::report::Report;
use crate::st::{self, Initial, Shape, Types, declared};
use crate::xml::attr::{self, Text};

/// The most types within each other: names that stand for names, arrays of arrays, values within values.
const DEEPEST: u32 = 64;

/// The first look at a declared type.
pub(super) enum Known {
    /// A type that G7 has.
    Type(Type),
    /// A name that the file may declare.
    Derived(String),
    /// Anything else.
    None,
}

/// The type of a variable, unless it is described in place.
pub(super) fn known(variable: Xml) -> Known {
    type_of(variable).and_then(described).map_or(Known::None, plain)
}

/// The element that describes the type within a `type`, `returnType` or `baseType`.
fn described(node: Xml<'_>) -> Option<Xml<'_>> {
    kids(node).find(|n| !matches!(&*tag(*n), "addData" | "documentation" | "initialValue" | "usingDirective"))
}

/// The type that an element names by itself.
pub(super) fn plain(inner: Xml) -> Known {
    match tag(inner).as_str() {
        "derived" => named(word(inner, "name").unwrap_or("")),
        "typeName" => named(attr::content(inner).text.trim()),
        kind @ ("string" | "wstring" | "STRING" | "WSTRING") => {
            let length = word(inner, "length").and_then(|l| l.parse().ok()).unwrap_or(80);
            Known::Type(st::text(length, kind.eq_ignore_ascii_case("wstring")))
        }
        "array" | "struct" | "enum" | "subrangeSigned" | "subrangeUnsigned" | "pointer" => Known::None,
        other => named(other),
    }
}

fn named(name: &str) -> Known {
    let upper = name.to_ascii_uppercase();
    if let Some((kind @ ("STRING" | "WSTRING"), length)) = upper.split_once(['[', '(']) {
        let length = length.trim_end_matches([']', ')']).trim().parse().unwrap_or(80);
        return Known::Type(st::text(length, kind == "WSTRING"));
    }
    // Beremiz marks values that are also shown on a screen.
    let upper = upper.strip_prefix("HMI_").unwrap_or(&upper).to_string();
    st::elementary(&upper).map_or_else(|| Known::Derived(name.to_string()), Known::Type)
}

/// The types of the file.
pub(super) struct Shapes<'a> {
    pub(super) types: Types,
    /// The elements that declare types, by names in upper case.
    nodes: HashMap<String, Xml<'a>>,
    /// The types of the members of each structure; all names in upper case.
    members: HashMap<String, HashMap<String, Shape>>,
    /// The types of variables that were read before.
    of_variables: HashMap<NodeId, Option<Shape>>,
    depth: u32,
}

impl<'a> Shapes<'a> {
    /// Reads the types that the file declares.
    pub(super) fn new(project: &Project<'a>, report: &mut Report) -> Shapes<'a> {
        let mut shapes = Shapes {
            types: Types::default(),
            nodes: HashMap::new(),
            members: HashMap::new(),
            of_variables: HashMap::new(),
            depth: 0,
        };
        let mut own = Vec::new();
        for node in &project.types {
            let Some(name) = name(*node, report) else { continue };
            if shapes.nodes.insert(name.text.to_uppercase(), *node).is_some() {
                let what = say!("`{}` is declared twice", name.text);
                report.put(g7_model::Problem::new(&codes::TWICE, name.at.0, what));
                continue;
            }
            // A structure is known before its members are, whose types may come later in the file.
            if structure(*node).is_some() {
                shapes.types.add(&name, Shape::Struct(name.clone()));
            }
            own.push((*node, name));
        }
        for (node, name) in &own {
            match structure(*node) {
                Some(inner) => shapes.know_members(inner, name, report),
                None => _ = shapes.declare(*node, name, report),
            }
        }
        for (node, name) in &own {
            let Some(inner) = structure(*node) else { continue };
            if let Some(value) = kid(*node, "initialValue") {
                not_carried(value, report);
            }
            shapes.structure(inner, name, documentation(*node), report);
        }
        shapes
    }

    /// Declares a type that is not a structure.
    fn declare(&mut self, node: Xml<'a>, name: &Name, report: &mut Report) -> Option<Shape> {
        if let Some(known) = self.types.get(&name.text) {
            return Some(known.clone());
        }
        let before = self.types.declaring.replace(name.clone());
        let shape = self.of(kid(node, "baseType").unwrap_or(node), name, report);
        self.types.declaring = before;
        let shape = shape?;
        let shape = match kid(node, "initialValue").and_then(|v| self.initial(v, &shape, report)) {
            Some(init) => shape.starting_with(init).unwrap_or_else(|shape| {
                not_carried(node, report);
                shape
            }),
            None => shape,
        };
        self.types.add(name, shape.clone());
        Some(shape)
    }

    /// The type within a `type`, `returnType` or `baseType`. `of` is the type or variable that is declared. None if it
    /// has no counterpart.
    fn of(&mut self, node: Xml<'a>, of: &Name, report: &mut Report) -> Option<Shape> {
        let inner = described(node)?;
        if self.depth >= DEEPEST {
            report.say(&codes::TOO_DEEP, &head(inner), say!("types within types without end"));
            return None;
        }
        self.depth += 1;
        let shape = self.of_inner(inner, of, report);
        self.depth -= 1;
        shape
    }

    fn of_inner(&mut self, inner: Xml<'a>, of: &Name, report: &mut Report) -> Option<Shape> {
        match tag(inner).as_str() {
            "array" => self.array(inner, of, report),
            "struct" => {
                let name = self.types.free(of);
                self.know_members(inner, &name, report);
                self.structure(inner, &name, None, report);
                Some(Shape::Struct(name))
            }
            "enum" => {
                let (ty, values) = enumeration(inner, report);
                Some(self.types.enumeration(of, ty, values, report))
            }
            "subrangeSigned" | "subrangeUnsigned" => self.subrange(inner, of, report),
            "pointer" => {
                report.say(&codes::NOT_CARRIED, &head(inner), say!("there are no pointers"));
                None
            }
            kind => {
                if kind.eq_ignore_ascii_case("wstring") {
                    let what = say!("a text of wide characters holds UTF-8, its length in bytes");
                    report.element(&codes::DIFFERENT, "wstring", &head(inner), what);
                }
                match plain(inner) {
                    Known::Type(ty) => Some(Shape::Simple(ty, None)),
                    Known::Derived(name) => {
                        self.derived(&Name::new(line(&name), report.span(&head(inner))), report)
                    }
                    Known::None => None,
                }
            }
        }
    }

    /// The type of this name; a function block of the file, or nothing, is an unknown type.
    fn derived(&mut self, name: &Name, report: &mut Report) -> Option<Shape> {
        if let Some(known) = self.types.get(&name.text) {
            return Some(known.clone());
        }
        match self.nodes.get(&name.text.to_uppercase()).copied() {
            Some(node) => {
                let own = self::name(node, report)?;
                self.declare(node, &own, report)
            }
            None => Some(Shape::Unknown(name.clone())),
        }
    }

    fn array(&mut self, array: Xml<'a>, of: &Name, report: &mut Report) -> Option<Shape> {
        let mut bounds = Vec::new();
        for dimension in array.descendants().filter(|n| n.is_element() && tag(*n) == "dimension") {
            // The dimensions of an array within it are read with that.
            let parent = dimension.parent_element();
            let own = parent.is_some_and(|p| p == array || p.parent_element() == Some(array));
            if own {
                bounds.push(range(dimension, report)?);
            }
        }
        let element = self.of(kid(array, "baseType")?, of, report)?;
        let shape = Shape::array(bounds, element);
        if shape.is_err() {
            report.say(&codes::NOT_CARRIED, &head(array), st::no_array());
        }
        shape.ok()
    }

    fn subrange(&mut self, inner: Xml<'a>, of: &Name, report: &mut Report) -> Option<Shape> {
        let limits = range(kid(inner, "range")?, report)?;
        match self.of(kid(inner, "baseType")?, of, report)? {
            Shape::Simple(ty, init) | Shape::Range(ty, _, init) => {
                Some(Shape::Range(ty, Box::new(limits), init))
            }
            _ => None,
        }
    }

    /// Keeps the types of the members of a structure.
    fn know_members(&mut self, inner: Xml<'a>, name: &Name, report: &mut Report) {
        let mut members = HashMap::new();
        for variable in kids(inner).filter(|n| tag(*n) == "variable") {
            let Some(member) = self::name(variable, report) else { continue };
            let shape = type_of(variable).and_then(|t| self.of(t, &member, report));
            let Some(shape) = shape else {
                no_counterpart(&member, variable, report);
                continue;
            };
            members.insert(member.text.to_uppercase(), shape);
        }
        self.members.insert(name.text.to_uppercase(), members);
    }

    /// Declares a structure whose members are known.
    fn structure(&mut self, inner: Xml<'a>, name: &Name, comment: Option<String>, report: &mut Report) {
        let mut members = Vec::new();
        for variable in kids(inner).filter(|n| tag(*n) == "variable") {
            let Some(member) = self::name(variable, report) else { continue };
            let known = self.members.get(&name.text.to_uppercase());
            let Some(shape) = known.and_then(|m| m.get(&member.text.to_uppercase())).cloned() else {
                continue;
            };
            members.push(self.declaration(variable, &member, &shape, report));
        }
        self.types.add(name, Shape::Struct(name.clone()));
        self.types.structures.push(Composed {
            name: name.clone(),
            comment: comment.map(Into::into),
            members,
            inouts: Vec::new(),
            block: false,
            body: None,
            at: report.span(&head(inner)).into(),
        });
    }

    /// The type of a variable or result; None, with a problem, if it has no counterpart.
    pub(super) fn shape(&mut self, node: Xml<'a>, name: &Name, report: &mut Report) -> Option<Shape> {
        if let Some(known) = self.of_variables.get(&node.id()) {
            return known.clone();
        }
        let wrapper = if tag(node) == "returnType" { Some(node) } else { type_of(node) };
        let shape = wrapper.and_then(|t| self.of(t, name, report));
        if shape.is_none() {
            no_counterpart(name, node, report);
        }
        self.of_variables.insert(node.id(), shape.clone());
        shape
    }

    /// The declaration of a variable, with its initial value and its comment.
    pub(super) fn declaration(
        &self,
        variable: Xml,
        name: &Name,
        shape: &Shape,
        report: &mut Report,
    ) -> VarDecl {
        let init = kid(variable, "initialValue").and_then(|v| self.initial(v, shape, report));
        let at = report.span(&head(variable)).into();
        let (decl, problem) = declared(name, shape, init.as_ref(), at);
        problem.into_iter().for_each(|p| report.put(p));
        VarDecl { comment: documentation(variable).map(Into::into), ..decl }
    }

    /// An initial value.
    fn initial(&self, value: Xml, shape: &Shape, report: &mut Report) -> Option<Initial> {
        self.value(value, shape.element(), 0, report)
    }

    /// A value of an array has the type of its elements.
    fn value(&self, value: Xml, element: &Shape, depth: u32, report: &mut Report) -> Option<Initial> {
        if depth > DEEPEST {
            report.say(&codes::TOO_DEEP, &head(value), say!("values within values without end"));
            return None;
        }
        if let Some(list) = kid(value, "arrayValue") {
            let mut own = Vec::new();
            for v in values(list) {
                let times = repetitions(v, report);
                own.extend(self.value(v, element, depth + 1, report).map(|one| (times, one)));
            }
            return Some(Initial::List(own));
        }
        if let Some(fields) = kid(value, "structValue") {
            let members = match element {
                Shape::Struct(of) => self.members.get(&of.text.to_uppercase()),
                _ => None,
            };
            let mut own = Vec::new();
            for v in values(fields) {
                let Some(written) = text(v, "member") else {
                    no_member(v, report);
                    continue;
                };
                let name = Name::new(line(&written.text), report.span(&written.at));
                let unknown = Shape::Unknown(name.clone());
                let member = members.and_then(|m| m.get(&name.text.to_uppercase())).unwrap_or(&unknown);
                let one = self.value(v, member.element(), depth + 1, report);
                own.extend(one.map(|one| (name, one)));
            }
            let empty = own.is_empty();
            // At the top it says as much as no value; in a list it would shift the values behind it.
            if empty && depth > 0 {
                no_member(fields, report);
            }
            return Some(Initial::Fields(own)).filter(|_| !empty);
        }
        match kid(value, "simpleValue") {
            Some(simple) => one(simple, element, report),
            None => {
                not_carried(value, report);
                None
            }
        }
    }
}

/// The name of a declared element; None, with a problem, if it has none.
pub(super) fn name(node: Xml, report: &mut Report) -> Option<Name> {
    let Some(name) = name_of(node) else {
        report.say(&codes::LEFT_OUT, &head(node), say!("a variable without a name; it is left out"));
        return None;
    };
    let at = text(node, "name").map_or_else(|| head(node), |t| t.at);
    Some(Name::new(name, report.span(&at)))
}

fn no_counterpart(name: &Name, node: Xml, report: &mut Report) {
    let what = say!("`{}` is of a type that has no counterpart", name.text);
    report.say(&codes::NOT_CARRIED, &head(node), what);
}

fn not_carried(node: Xml, report: &mut Report) {
    let what = say!("initial values of a structure's or array's type are not carried over");
    report.say(&codes::NOT_CARRIED, &head(node), what);
}

fn no_member(node: Xml, report: &mut Report) {
    report.say(&codes::BAD_VALUE, &head(node), say!("the value of a structure that names no member"));
}

/// The element with the members of a type that is a structure.
fn structure(node: Xml<'_>) -> Option<Xml<'_>> {
    described(kid(node, "baseType").unwrap_or(node)).filter(|n| tag(*n) == "struct")
}

/// The least and the greatest value of a dimension or subrange.
fn range(node: Xml, report: &mut Report) -> Option<(Expr, Expr)> {
    let mut bound = |name| {
        let text = attr::text(node, name)?;
        Some(st::expression(&text.text, &|r| text.place(&r), report))
    };
    Some((bound("lower")?, bound("upper")?))
}

/// How often a value of a list stands there.
fn repetitions(value: Xml, report: &mut Report) -> u32 {
    let Some(written) = text(value, "repetitionValue") else { return 1 };
    written.text.trim().parse().unwrap_or_else(|_| {
        let what = say!("`{}` is not a number of repetitions", line(&written.text));
        report.say(&codes::BAD_VALUE, &written.at, what);
        1
    })
}

/// The type of the numbers of an enumeration, and its values.
fn enumeration(inner: Xml, report: &mut Report) -> (Type, st::Values) {
    let base = kid(inner, "baseType").and_then(described);
    let ty = match base.map(plain) {
        Some(Known::Type(ty)) if st::is_base(ty) => Some(ty),
        _ => None,
    };
    if let Some(base) = base.filter(|_| ty.is_none()) {
        report.element(
            &codes::DIFFERENT,
            "baseType",
            &head(base),
            say!("the values of an enumeration are INT here"),
        );
    }
    let mut found = Vec::new();
    for value in values(kid(inner, "values").unwrap_or(inner)) {
        let Some(name) = name(value, report) else { continue };
        let number = text(value, "value").filter(|t| !t.text.trim().is_empty());
        let number = number.map(|t| st::expression(&t.text, &|r| t.place(&r), report));
        found.push((name, number));
    }
    (ty.unwrap_or(Type::Int), found)
}

fn values(node: Xml<'_>) -> impl Iterator<Item = Xml<'_>> {
    kids(node).filter(|n| tag(*n) == "value")
}

/// One value.
fn one(simple: Xml, element: &Shape, report: &mut Report) -> Option<Initial> {
    let text = attr::text(simple, "value").filter(|t| !t.text.trim().is_empty())?;
    let at = report.span(&text.at);
    let word = text.text.trim();
    let ty = match element {
        Shape::Simple(ty, _) | Shape::Range(ty, ..) => Some(*ty),
        _ => None,
    };
    if let Some(kind) = ty.and_then(|ty| spoken(word, ty)) {
        return Some(Initial::One(Expr { kind, at: at.into() }));
    }
    Some(match (written(&text, report), ty) {
        (Initial::One(e), Some(ty)) => Initial::One(with_type(e, ty, at)),
        (other, _) => other,
    })
}

/// A value as Structured Text: some tools write `[1, 2]` and `(a := 1)` here.
fn written(text: &Text, report: &mut Report) -> Initial {
    let place = |r: Range<usize>| text.place(&r);
    st::Parser::new(&text.text, &place, report).whole_initial()
}

/// Values whose meaning depends on the type: `1` of a BOOL, strings without quotes.
fn spoken(word: &str, ty: Type) -> Option<ExprKind> {
    let quoted = word.starts_with(['\'', '"']);
    Some(ExprKind::Literal(match (ty, word.to_ascii_uppercase().as_str()) {
        (Type::Bool, "1" | "BOOL#1" | "BOOL#TRUE" | "TRUE") => Literal::Bool(true),
        (Type::Bool, "0" | "BOOL#0" | "BOOL#FALSE" | "FALSE") => Literal::Bool(false),
        (Type::String(_), _) if !quoted => Literal::Str(word.into()),
        (Type::Time, upper) if upper.contains('#') && !upper.contains('-') => Literal::Time(duration(word)?),
        _ => return None,
    }))
}

/// A whole number where a real one is expected: `0` becomes `0.0`.
fn with_type(expr: Expr, ty: Type, at: Span) -> Expr {
    match (&expr.kind, ty) {
        (ExprKind::Literal(Literal::Int(n, None)), Type::Real | Type::Lreal) => {
            Expr { kind: ExprKind::Literal(Literal::Real(format!("{n}.0").into(), None)), at: at.into() }
        }
        (ExprKind::Unary(UnaryOp::Neg, inner), Type::Real | Type::Lreal) => {
            let inner = with_type((**inner).clone(), ty, at);
            Expr { kind: ExprKind::Unary(UnaryOp::Neg, Box::new(inner)), at: expr.at }
        }
        _ => expr,
    }
}
