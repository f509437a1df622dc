//! Gives elements the names of TC6 XML, whichever edition wrote them.
//!
//! IEC 61131-10 capitalises the same names (`ConnectionPointIn`) and writes the objects of a
//! drawing as `<SfcObject xsi:type="Step">`; [`tag`] maps both to one name.

use std::ops::Range;

use crate::nodes::line;
use crate::xml::attr::{self, Text};

/// An element.
pub(super) type Xml<'a> = roxmltree::Node<'a, 'a>;

/// The name space of `xsi:type`.
const INSTANCE: &str = "http://www.w3.org/2001/XMLSchema-instance";

/// The name of an element in TC6 XML.
pub(super) fn tag(node: Xml) -> String {
    let kind = node.attribute((INSTANCE, "type")).filter(|_| {
        let name = node.tag_name().name();
        name.ends_with("Object")
            || matches!(name, "BodyContent" | "UserDefinedTypeSpec" | "InstantlyDefinedType")
    });
    let name = kind.unwrap_or(node.tag_name().name());
    let name = name.rsplit(':').next().unwrap_or(name);
    match name {
        "DataSource" => "inVariable".into(),
        "DataSink" => "outVariable".into(),
        "MainBody" => "body".into(),
        "Parameters" => "interface".into(),
        "ResultType" => "returnType".into(),
        "Vars" => "localVars".into(),
        "StructTypeSpec" => "struct".into(),
        "ArrayTypeSpec" => "array".into(),
        "EnumTypeSpec" | "EnumTypeWithNamedValueSpec" => "enum".into(),
        "SubrangeTypeSpec" => "subrangeSigned".into(),
        "Member" => "variable".into(),
        "Enumerator" => "value".into(),
        "IndexRange" => "dimension".into(),
        "InputVariable" | "OutputVariable" | "InOutVariable" if kind.is_none() => "variable".into(),
        _ => lower(name),
    }
}

/// The name with a small first letter, unless the second is a capital too (`ST`, `BOOL`).
fn lower(name: &str) -> String {
    let mut rest = name.chars();
    match (rest.next(), rest.clone().next()) {
        (Some(first), Some(second)) if first.is_uppercase() && second.is_lowercase() => {
            first.to_lowercase().chain(rest).collect()
        }
        _ => name.to_string(),
    }
}

/// The direct children that are elements.
pub(super) fn kids(node: Xml<'_>) -> impl Iterator<Item = Xml<'_>> {
    node.children().filter(|n| n.is_element())
}

/// The first direct child with this name.
pub(super) fn kid<'a>(node: Xml<'a>, name: &str) -> Option<Xml<'a>> {
    kids(node).find(|n| tag(*n) == name)
}

/// An attribute, whether its name begins with a small letter or a capital.
pub(super) fn text(node: Xml, name: &str) -> Option<Text> {
    attr::text(node, name)
}

/// An attribute without surrounding blanks; None if it is empty.
pub(super) fn word<'a>(node: Xml<'a>, name: &str) -> Option<&'a str> {
    node.attribute(name).map(str::trim).filter(|w| !w.is_empty())
}

/// True if an attribute says yes.
pub(super) fn flag(node: Xml, name: &str) -> bool {
    matches!(word(node, name), Some("true" | "1" | "TRUE"))
}

/// The start tag, which messages underline.
pub(super) fn head(node: Xml) -> Range<usize> {
    attr::head(node)
}

/// A coordinate of the drawing, in tenths of its unit.
fn tenths(word: Option<&str>) -> Option<i32> {
    let value: f64 = word?.parse().ok()?;
    let tenths = (value * 10.0).round();
    // Beyond this no drawing is real, and the coordinates are useless.
    if !(-1e7..=1e7).contains(&tenths) {
        return None;
    }
    format!("{tenths:.0}").parse().ok()
}

/// The place of an object: the middle of its upper side, in tenths of a unit.
pub(super) fn place(node: Xml) -> Option<(i32, i32)> {
    let position = kid(node, "position").or_else(|| kid(node, "relPosition"))?;
    let x = tenths(word(position, "x"))?;
    let y = tenths(word(position, "y"))?;
    let size = kid(node, "size").and_then(|s| tenths(word(s, "x")));
    let width = tenths(word(node, "width")).or(size).unwrap_or(0);
    Some((x.saturating_add(width / 2), y))
}

/// The documentation of an element.
pub(super) fn documentation(node: Xml) -> Option<String> {
    let at = kid(node, "documentation")?;
    let text = attr::content(at).text;
    let clean = text.split_whitespace().collect::<Vec<_>>().join(" ");
    (!clean.is_empty()).then_some(clean)
}

/// The languages that a body can be written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Language {
    /// Structured Text.
    St,
    /// Instruction List.
    Il,
    /// Ladder Diagram.
    Ld,
    /// Function Block Diagram, also the free one of CODESYS.
    Fbd,
    /// Sequential Function Chart.
    Sfc,
}

/// The body within an element (`pou`, `action`, `transition`, `inline`, `macroStep`).
pub(super) fn body(node: Xml<'_>) -> Option<(Language, Xml<'_>)> {
    let of = |n: Xml| match tag(n).as_str() {
        "ST" => Some(Language::St),
        "IL" => Some(Language::Il),
        "LD" => Some(Language::Ld),
        "FBD" | "CFC" => Some(Language::Fbd),
        "SFC" => Some(Language::Sfc),
        _ => None,
    };
    let direct = kids(node).find_map(|n| of(n).map(|l| (l, n)));
    direct.or_else(|| kids(node).filter(|n| tag(*n) == "body").find_map(body))
}

/// The name of an element, fit for a name of the document.
pub(super) fn name_of(node: Xml) -> Option<String> {
    let name = line(&text(node, "name")?.text);
    (!name.is_empty()).then_some(name)
}
