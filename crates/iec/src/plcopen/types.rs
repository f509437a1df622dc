//! Types and initial values of variables.

use std::collections::HashMap;

use g7_model::codes;
use g7_model::{Expr, ExprKind, FbKind, Literal, Span, Type, UnaryOp, say};

use super::read::{duration, type_of};
use super::tree::{Xml, head, kid, kids, tag, word};
use crate::report::Report;
use crate::st::{self, MOST_DIMENSIONS};
use crate::xml::attr;

/// The most names that stand for each other.
const MOST_NAMES: usize = 64;
/// The longest string that a variable may hold.
const MOST_TEXT: u16 = 1024;

/// The meaning of a declared type.
pub(super) enum Known {
    /// A type that G7 has.
    Type(Type),
    /// A name that the file may declare.
    Derived(String),
    /// A type that cannot be carried over.
    None,
}

/// The type of a variable.
pub(super) fn known(variable: Xml) -> Known {
    type_of(variable).map_or(Known::None, of)
}

/// The types of the file, see [`super::read::Project::types`].
pub(super) type Types<'a> = HashMap<String, Xml<'a>>;

/// The type behind the name of a plain type of the file; anything else as it is.
fn resolved<'a>(mut node: Xml<'a>, types: &Types<'a>) -> Xml<'a> {
    for _ in 0..MOST_NAMES {
        let name = kid(node, "derived").and_then(|d| word(d, "name"));
        let Some(meant) = name.and_then(|n| types.get(&n.to_uppercase())) else { break };
        node = *meant;
    }
    node
}

/// The type of a variable that is no array, where the file gives it a name.
pub(super) fn meant<'a>(variable: Xml<'a>, types: &Types<'a>) -> Known {
    type_of(variable).map_or(Known::None, |node| of(resolved(node, types)))
}

/// The bounds of a variable that is an array of a type that G7 has, and the type of its elements.
pub(super) fn array<'a>(
    variable: Xml<'a>,
    types: &Types<'a>,
    report: &mut Report,
) -> Option<(Vec<(Expr, Expr)>, Type)> {
    let (mut bounds, mut node) = (Vec::new(), resolved(type_of(variable)?, types));
    while let Some(array) = kid(node, "array").filter(|_| bounds.len() < MOST_DIMENSIONS) {
        for dimension in kids(array).filter(|n| tag(*n) == "dimension") {
            let mut bound = |name| {
                let text = attr::text(dimension, name)?;
                Some(st::expression(&text.text, &|r| text.place(&r), report))
            };
            bounds.push((bound("lower")?, bound("upper")?));
        }
        node = resolved(kid(array, "baseType")?, types);
    }
    match of(node) {
        Known::Type(ty) if !bounds.is_empty() && is_block(Some(ty)).is_none() => Some((bounds, ty)),
        _ => None,
    }
}

/// The type within a `type`, `returnType` or `baseType`.
pub(super) fn of(node: Xml) -> Known {
    let Some(inner) = kids(node).find(|n| !matches!(tag(*n).as_str(), "addData" | "documentation")) else {
        return Known::None;
    };
    match tag(inner).as_str() {
        "derived" => named(word(inner, "name").unwrap_or("")),
        "typeName" => named(attr::content(inner).text.trim()),
        "string" | "wstring" | "STRING" | "WSTRING" => {
            let length = word(inner, "length").and_then(|l| l.parse().ok()).unwrap_or(80);
            Known::Type(Type::String(length.clamp(1, MOST_TEXT)))
        }
        "subrangeSigned" | "subrangeUnsigned" => kid(inner, "baseType").map_or(Known::None, of),
        other => named(other),
    }
}

fn named(name: &str) -> Known {
    let upper = name.to_ascii_uppercase();
    if let Some((_, length)) = upper.strip_prefix("STRING").and_then(|r| r.split_once(['[', '('])) {
        let length = length.trim_end_matches([']', ')']).trim().parse().unwrap_or(80);
        return Known::Type(Type::String(u16::clamp(length, 1, MOST_TEXT)));
    }
    // Beremiz marks values that are also shown on a screen.
    let upper = upper.strip_prefix("HMI_").unwrap_or(&upper).to_string();
    st::elementary(&upper).map_or_else(|| Known::Derived(name.to_string()), Known::Type)
}

/// Reports the parts of a type that are carried over with a difference or not at all.
pub(super) fn judge(variable: Xml, report: &mut Report) {
    let Some(node) = type_of(variable) else { return };
    for inner in node.descendants().filter(|n| n.is_element()) {
        match tag(inner).as_str() {
            "subrangeSigned" | "subrangeUnsigned" => {
                let what = say!("the range of a variable is left out");
                report.element(&codes::LEFT_OUT, "subrange", &head(inner), what);
            }
            "wstring" | "WSTRING" => {
                let what = say!("a text of wide characters holds UTF-8, its length in bytes");
                report.element(&codes::DIFFERENT, "wstring", &head(inner), what);
            }
            _ => {}
        }
    }
}

/// An initial value; that of an array is a list.
pub(super) fn initial(variable: Xml, ty: Type, report: &mut Report) -> Option<Expr> {
    let value = kid(variable, "initialValue")?;
    if let Some(list) = kid(value, "arrayValue") {
        let mut values = Vec::new();
        elements(list, ty, 1, report, &mut values);
        let at = report.span(&head(list)).into();
        return Some(Expr { kind: ExprKind::List(values), at });
    }
    let Some(simple) = kid(value, "simpleValue") else {
        let what = say!("initial values of structures are not carried over");
        report.say(&codes::NOT_CARRIED, &head(value), what);
        return None;
    };
    one(simple, ty, report)
}

/// The values of the elements of an array; those of rows stand one behind the other.
fn elements(list: Xml, ty: Type, depth: usize, report: &mut Report, values: &mut Vec<(u32, Expr)>) {
    for value in kids(list).filter(|n| tag(*n) == "value") {
        let times = word(value, "repetitionValue").and_then(|n| n.parse::<u32>().ok()).unwrap_or(1);
        if let Some(row) = kid(value, "arrayValue").filter(|_| depth < MOST_DIMENSIONS) {
            let mut inner = Vec::new();
            elements(row, ty, depth + 1, report, &mut inner);
            st::repeat(&inner, times, values);
        } else if let Some(one) = kid(value, "simpleValue").and_then(|simple| one(simple, ty, report)) {
            values.push((times, one));
        } else {
            let what = say!("initial values of structures are not carried over");
            report.element(&codes::NOT_CARRIED, "value", &head(value), what);
        }
    }
}

/// One value.
fn one(simple: Xml, ty: Type, report: &mut Report) -> Option<Expr> {
    let text = attr::text(simple, "value").filter(|t| !t.text.trim().is_empty())?;
    let at = report.span(&text.at);
    let word = text.text.trim();
    if let Some(kind) = spoken(word, ty) {
        return Some(Expr { kind, at: at.into() });
    }
    Some(with_type(st::expression(&text.text, &|r| text.place(&r), report), ty, at))
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

/// The function block, if the type is one that must be called.
pub(super) fn is_block(ty: Option<Type>) -> Option<FbKind> {
    match ty {
        Some(Type::Fb(kind)) => Some(kind),
        _ => None,
    }
}
