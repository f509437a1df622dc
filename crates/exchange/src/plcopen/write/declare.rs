//! Declarations of variables.

use g7_model::codes;
use g7_model::{Expr, Problem, Type, VarDecl, VarKind};

use super::names::{Names, Scope};
use super::st::Text;
use super::xml::Element;

/// The type of a variable, a parameter or a result.
pub(super) fn type_of(ty: Type) -> Element {
    let inner = match ty {
        Type::String(length) => Element::new("string").with("length", length),
        Type::Fb(kind) => Element::new("derived").with("name", kind.name()),
        other => Element::new(&other.to_string()),
    };
    Element::new("type").child(inner)
}

/// `initialValue`.
pub(super) fn initial(value: &str) -> Element {
    Element::new("initialValue").child(Element::new("simpleValue").with("value", value))
}

/// The element of a list in a program, the name of a global one, and what goes in.
type Sort = (&'static str, &'static str, fn(&VarDecl) -> bool);

/// A list of variables of one sort: `inputVars`, …
pub(super) fn lists(
    variables: &[&VarDecl],
    global: bool,
    names: &mut Names,
    scope: Scope,
    problems: &mut Vec<Problem>,
) -> Vec<Element> {
    let sorts: [Sort; 5] = [
        ("inputVars", "Inputs", |v| v.kind == VarKind::Input),
        ("outputVars", "Outputs", |v| v.kind == VarKind::Output),
        ("localVars", "Variables", |v| v.kind == VarKind::Var && !v.retain),
        ("localVars", "Retained", |v| v.kind == VarKind::Var && v.retain),
        ("localVars", "Constants", |v| v.kind == VarKind::Const),
    ];
    let mut all = Vec::new();
    for (tag, title, fits) in sorts {
        let mut list =
            if global { Element::new("globalVars").with("name", title) } else { Element::new(tag) };
        match title {
            "Retained" => list = list.with("retain", true),
            "Constants" => list = list.with("constant", true),
            _ => {}
        }
        let mut some = false;
        for decl in variables.iter().filter(|v| fits(v)) {
            some = true;
            for variable in variable(decl, names, scope, problems) {
                list.push(variable);
            }
        }
        if some {
            all.push(list);
        }
    }
    all
}

fn variable(decl: &VarDecl, names: &mut Names, scope: Scope, problems: &mut Vec<Problem>) -> Vec<Element> {
    let mut address = None;
    if let Some(at) = &decl.address {
        if at.text.starts_with('%') {
            address = Some(at.text.to_string());
        } else {
            let what = format!("the channel `{}`: IEC 61131-3 has addresses that begin with %", at.text);
            problems.push(Problem::new(&codes::LEFT_OUT, at.at.0, what));
        }
    }
    if decl.inverted {
        let what = "an inverted channel, which IEC 61131-3 does not have";
        problems.push(Problem::new(&codes::NOT_CARRIED, decl.at.0, what));
    }
    if let Some(safe) = &decl.safe {
        let what = "the value of an output after a fault";
        problems.push(Problem::new(&codes::LEFT_OUT, safe.at.0, what));
    }
    let init = decl.init.as_ref().map(|e| value(e, names, scope, problems));
    let one = |name: &g7_model::Name, names: &mut Names| {
        let mut element = Element::new("variable").with("name", names.give(name));
        if let Some(address) = &address {
            element = element.with("address", address);
        }
        element = element.child(type_of(decl.ty));
        if let Some(init) = &init {
            element.push(initial(init));
        }
        if let Some(comment) = &decl.comment {
            element.push(Element::formatted("documentation", comment));
        }
        element
    };
    decl.names.iter().map(|n| one(n, names)).collect()
}

pub(super) fn value(expr: &Expr, names: &mut Names, scope: Scope, problems: &mut Vec<Problem>) -> String {
    Text { names, scope, problems }.expr(expr)
}

/// The same variables as a program announces those of the file.
pub(super) fn external<'v>(
    variables: impl Iterator<Item = &'v VarDecl>,
    names: &mut Names,
) -> Option<Element> {
    let mut list = Element::new("externalVars");
    let mut some = false;
    for decl in variables {
        for name in &decl.names {
            some = true;
            list.push(Element::new("variable").with("name", names.give(name)).child(type_of(decl.ty)));
        }
    }
    some.then_some(list)
}
