//! All that the editor of a plant's picture needs to know: the picture with its bindings as the text has them, and what can
//! be bound to an element.

use g7_edit::Bound;
use g7_ide::File;
use g7_model::{Document, Expr, Item, Plant, PlantItem, Said, Span, StateVar, Type, VarDecl, VarKind, say};
use serde::Serialize;

/// The picture of a plant, and the names that it can show.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(optional_fields))]
pub(crate) struct PlantPicture {
    /// The SVG file, if the plant has a picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    bindings: Vec<Bound>,
    names: Vec<PictureName>,
}

/// A state, a constant or a queue of the plant, an output or an input of the charts.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(optional_fields))]
pub(crate) struct PictureName {
    name: String,
    role: NameRole,
    #[serde(rename = "type")]
    ty: NameType,
    /// The value of a binding to it: the name, or what the plant drives an input with. Empty if a picture cannot show it.
    value: String,
    /// True if a part of the picture can turn it.
    hand: bool,
    /// The limits of a state as written.
    #[serde(skip_serializing_if = "Option::is_none")]
    limits: Option<[String; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    comment: Option<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "lowercase")]
enum NameRole {
    State,
    Const,
    Parts,
    Output,
    Input,
}

/// How a value is shown; an enumeration and what has a type of the file's own is `other`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "lowercase")]
enum NameType {
    Bool,
    Int,
    Real,
    Text,
    Other,
}

/// The picture of the plant of this name.
pub(crate) fn picture(file: &File, plant: &str) -> Result<PlantPicture, Said> {
    let readable = file.drawn();
    let document = readable.document;
    let own = document.items.iter().find_map(|i| match i {
        Item::Plant(p) if *p.name.text == *plant => Some(p),
        _ => None,
    });
    let plant = own.ok_or_else(|| say!("this file has no plant `{plant}`"))?;
    let words = |at: Span| readable.words(at);
    let view = plant.view();
    let bound = |b: &g7_model::Binding| Bound {
        element: b.element.text.to_string(),
        attribute: b.attribute.text.to_string(),
        value: words(b.value.at.0),
    };
    Ok(PlantPicture {
        file: view.map(|v| v.file.to_string()),
        bindings: view.iter().flat_map(|v| &v.bindings).map(bound).collect(),
        names: names(document, plant, &words),
    })
}

fn names(document: &Document, plant: &Plant, words: &dyn Fn(Span) -> String) -> Vec<PictureName> {
    let mut out: Vec<PictureName> = plant.items.iter().flat_map(|i| of_plant(i, words)).collect();
    // The file's own variables, and those of the files that it uses.
    for item in &document.items {
        let Item::Var(v) = item else { continue };
        match v.kind {
            VarKind::Output => out.extend(variables(v, NameRole::Output, |name| (show(name), false))),
            VarKind::Input => out.extend(variables(v, NameRole::Input, |name| match driven(plant, name) {
                Some(value) => (words(value.at.0), false),
                None => (String::new(), true),
            })),
            VarKind::Var | VarKind::Const => {}
        }
    }
    out
}

fn show(name: &str) -> String {
    g7_syntax::show_name(name)
}

fn of_plant(item: &PlantItem, words: &dyn Fn(Span) -> String) -> Vec<PictureName> {
    let row = |name: &str, role, ty: Type| PictureName {
        name: name.to_owned(),
        role,
        ty: kind(ty),
        value: show(name),
        hand: role == NameRole::State && ty == Type::Bool,
        limits: None,
        comment: None,
    };
    match item {
        PlantItem::State(StateVar { names, ty, limits, comment, .. }) => names
            .iter()
            .map(|n| PictureName {
                limits: limits.as_ref().map(|(a, b)| [words(a.at.0), words(b.at.0)]),
                comment: comment.as_deref().map(str::to_owned),
                ..row(&n.text, NameRole::State, *ty)
            })
            .collect(),
        PlantItem::Const { names, ty, .. } => {
            names.iter().map(|n| row(&n.text, NameRole::Const, *ty)).collect()
        }
        PlantItem::Parts(p) => vec![PictureName {
            name: format!("{}.count", p.name.text),
            value: format!("{}.count", show(&p.name.text)),
            limits: Some(["0".to_owned(), p.max.to_string()]),
            ..row(&p.name.text, NameRole::Parts, Type::Dint)
        }],
        _ => Vec::new(),
    }
}

fn variables(v: &VarDecl, role: NameRole, value: impl Fn(&str) -> (String, bool)) -> Vec<PictureName> {
    if v.array.is_some() {
        return Vec::new();
    }
    let ty = if v.of.is_some() { NameType::Other } else { kind(v.ty) };
    let row = |name: &str| {
        let (value, free) = value(name);
        PictureName {
            name: name.to_owned(),
            role,
            ty,
            value,
            hand: free && ty == NameType::Bool,
            limits: None,
            comment: v.comment.as_deref().map(str::to_owned),
        }
    };
    v.names.iter().map(|n| row(&n.text)).collect()
}

/// The value with which the plant drives an input.
fn driven<'p>(plant: &'p Plant, name: &str) -> Option<&'p Expr> {
    plant.items.iter().find_map(|i| match i {
        PlantItem::Drive(d) if d.input.kind.variable().as_deref() == Some(name) => Some(&d.value),
        _ => None,
    })
}

fn kind(ty: Type) -> NameType {
    match ty {
        Type::Bool => NameType::Bool,
        Type::Real | Type::Lreal => NameType::Real,
        Type::String(_) => NameType::Text,
        Type::Time | Type::Moment(_) | Type::Fb(_) => NameType::Other,
        _ => NameType::Int,
    }
}
