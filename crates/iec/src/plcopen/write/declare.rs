//! Declarations of variables.

use g7_model::{Composed, Document, Expr, ExprKind, Item, Name, Type, ValueType, VarDecl, VarKind};

use crate::st::{Known, Writer};
use crate::xml::element::Element;

/// A type of the language.
pub(super) fn type_of(ty: Type) -> Element {
    let inner = match ty {
        Type::String(length) => Element::new("string").with("length", length),
        Type::Fb(kind) => Element::new("derived").with("name", kind.name()),
        other => Element::new(&other.to_string()),
    };
    Element::new("type").child(inner)
}

/// The type of a variable; that of an array has a name.
fn type_of_variable(decl: &VarDecl) -> Element {
    named_or(decl.of.as_deref(), decl.ty)
}

/// The type of a parameter, of a local variable or of a result.
pub(super) fn type_of_value(ty: &ValueType) -> Element {
    named_or(ty.of.as_deref(), ty.base)
}

fn named_or(of: Option<&Name>, ty: Type) -> Element {
    match of {
        Some(of) => Element::new("type").child(Element::new("derived").with("name", &of.text)),
        None => type_of(ty),
    }
}

/// The enumerations, the types of arrays, and the structures.
pub(super) fn data_types(document: &Document) -> Element {
    let types = Known::default();
    let bound = |e: &Expr| Writer { types: &types }.plain(e);
    let dimension = |(low, high): &(Expr, Expr)| {
        Element::new("dimension").with("lower", bound(low)).with("upper", bound(high))
    };
    let named = |name: &Name, base: Element| {
        Element::new("dataType").with("name", &name.text).child(Element::new("baseType").child(base))
    };
    let one = |item: &Item| match item {
        Item::Type(decl) => {
            let base = match &decl.array {
                Some(array) => {
                    let made = Element::new("array").children(array.dimensions.iter().map(dimension));
                    made.child(type_of_variable(decl).renamed("baseType"))
                }
                None => {
                    let value =
                        |(name, _): &(Name, Option<Expr>)| Element::new("value").with("name", &name.text);
                    Element::new("enum")
                        .child(Element::new("values").children(decl.values().iter().map(value)))
                }
            };
            Some(named(decl.names.first()?, base))
        }
        Item::Composed(c) if !c.block => {
            let members = c.members.iter().flat_map(|decl| decl.names.iter().map(move |n| variable(decl, n)));
            let made = named(&c.name, Element::new("struct").children(members));
            Some(match &c.comment {
                Some(comment) => made.child(Element::formatted("documentation", comment)),
                None => made,
            })
        }
        _ => None,
    };
    Element::new("dataTypes").children(document.items.iter().filter_map(one))
}

/// `initialValue`.
pub(super) fn initial(value: &Expr, ty: Type) -> Element {
    Element::new("initialValue").child(initial_value(value, Some(ty)))
}

/// An initial value; `ty` is the type of the elements of an array and unknown for the fields of a structure.
fn initial_value(e: &Expr, ty: Option<Type>) -> Element {
    match &e.kind {
        ExprKind::List(values) => Element::new("arrayValue").children(values.iter().map(|(times, e)| {
            let one = Element::new("value");
            let one = if *times == 1 { one } else { one.with("repetitionValue", times) };
            one.child(initial_value(e, ty))
        })),
        ExprKind::Call(_, fields) => Element::new("structValue").children(fields.iter().map(|f| {
            let value = Element::new("value").with("member", f.name.as_ref().map_or("", |n| &n.text));
            value.child(initial_value(&f.value, None))
        })),
        _ => {
            let types = Known::default();
            let writer = Writer { types: &types };
            let value = ty.map_or_else(|| writer.plain(e), |ty| writer.value(e, ty));
            Element::new("simpleValue").with("value", value)
        }
    }
}

/// The element of a list in a program, the name of a global list, and the test for its variables.
type Sort = (&'static str, &'static str, fn(&VarDecl) -> bool);

/// The sorts of lists. Variables with an address are local: the standard has no addresses in the lists of inputs
/// and outputs of a program.
const SORTS: [Sort; 6] = [
    ("inputVars", "Inputs", |v| v.kind == VarKind::Input && v.address.is_none()),
    ("outputVars", "Outputs", |v| v.kind == VarKind::Output && v.address.is_none()),
    ("localVars", "Located", |v| matches!(v.kind, VarKind::Input | VarKind::Output) && v.address.is_some()),
    ("localVars", "Variables", |v| v.kind == VarKind::Var && !v.retain),
    ("localVars", "Retained", |v| v.kind == VarKind::Var && v.retain),
    ("localVars", "Constants", |v| v.kind == VarKind::Const),
];

/// The element of a list.
fn list(tag: &str, title: &str, global: bool) -> Element {
    let list = if global { Element::new("globalVars").with("name", title) } else { Element::new(tag) };
    match title {
        "Retained" => list.with("retain", true),
        "Constants" => list.with("constant", true),
        _ => list,
    }
}

/// A list of variables of each sort: `inputVars`, …
pub(super) fn lists(variables: &[&VarDecl], global: bool) -> Vec<Element> {
    let mut all = Vec::new();
    for (tag, title, fits) in SORTS {
        let mut made = list(tag, title, global);
        let mut some = false;
        for decl in variables.iter().filter(|v| fits(v)) {
            some = true;
            decl.names.iter().for_each(|n| made.push(variable(decl, n)));
        }
        if some {
            all.push(made);
        }
    }
    all
}

/// The lists of a function block of the file.
pub(super) fn parameters(block: &Composed) -> Vec<Element> {
    let mut all = lists(&block.members.iter().collect::<Vec<_>>(), false);
    let mut inouts = Element::new("inOutVars");
    for decl in &block.inouts {
        decl.names.iter().for_each(|n| inouts.push(variable(decl, n)));
    }
    if !block.inouts.is_empty() {
        all.push(inouts);
    }
    all
}

/// Lists of the variables of a program in the order of the document; those that are `given` are inputs.
pub(super) fn in_order<'v>(
    variables: impl Iterator<Item = &'v VarDecl>,
    given: impl Fn(&VarDecl) -> bool,
) -> Vec<Element> {
    let mut all: Vec<(&str, Element)> = Vec::new();
    for decl in variables {
        let found = SORTS.iter().find(|(_, _, fits)| fits(decl)).map(|(tag, title, _)| (*tag, *title));
        let (tag, title) = found.filter(|_| !given(decl)).unwrap_or(("inputVars", "Inputs"));
        if all.last().is_none_or(|(last, _)| *last != title) {
            all.push((title, list(tag, title, false)));
        }
        if let Some((_, made)) = all.last_mut() {
            decl.names.iter().for_each(|n| made.push(variable(decl, n)));
        }
    }
    all.into_iter().map(|(_, made)| made).collect()
}

fn variable(decl: &VarDecl, name: &Name) -> Element {
    let mut element = Element::new("variable").with("name", &name.text);
    if let Some(address) = &decl.address {
        element = element.with("address", &address.text);
    }
    element = element.child(type_of_variable(decl));
    if let Some(init) = &decl.init {
        element.push(initial(init, decl.ty));
    }
    if let Some(comment) = &decl.comment {
        element.push(Element::formatted("documentation", comment));
    }
    element
}

/// The variables of the file, as a program refers to them: those that change, and the constants, which stay
/// constants there.
pub(super) fn external<'v>(variables: impl Iterator<Item = &'v VarDecl> + Clone) -> Vec<Element> {
    let is_constant = |decl: &VarDecl| decl.kind == VarKind::Const;
    [false, true]
        .into_iter()
        .filter_map(|constant| {
            let of_kind = variables.clone().filter(|v| is_constant(v) == constant);
            let list: Vec<Element> = of_kind
                .flat_map(|decl| decl.names.iter().map(move |n| (n, decl)))
                .map(|(name, decl)| {
                    Element::new("variable").with("name", &name.text).child(type_of_variable(decl))
                })
                .collect();
            let mut element = Element::new("externalVars");
            if constant {
                element = element.with("constant", true);
            }
            (!list.is_empty()).then(|| element.children(list))
        })
        .collect()
}
