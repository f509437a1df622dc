//! The tables of variables and steps.

use g7_model::{Document, Type, VarDecl, VarKind};
use serde::Serialize;

use super::definitions::{Meaning, names};
use crate::file::Readable;
use crate::ids;

/// The tables of a file.
#[derive(Debug, Serialize)]
pub(crate) struct Tables {
    stale: bool,
    variables: Vec<Variable>,
    steps: Vec<Step>,
}

#[derive(Debug, Serialize)]
struct Variable {
    name: String,
    class: &'static str,
    #[serde(rename = "type")]
    ty: String,
    init: String,
    address: String,
    inverted: bool,
    retain: bool,
    safe: String,
    comment: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    chart: Option<String>,
    from: usize,
    to: usize,
    /// The number of uses in the text, without the declaration.
    uses: usize,
}

#[derive(Debug, Serialize)]
struct Step {
    id: String,
    name: String,
    chart: String,
    comment: String,
    initial: bool,
    from: usize,
    to: usize,
}

/// The word for a class of variables.
pub(crate) fn class(kind: VarKind) -> &'static str {
    match kind {
        VarKind::Input => "input",
        VarKind::Output => "output",
        VarKind::Var => "var",
        VarKind::Const => "const",
    }
}

/// The tables of a document.
pub(crate) fn tables(readable: &Readable) -> Tables {
    let document: &Document = &readable.document;
    let (mut variables, mut steps) = (Vec::new(), Vec::new());
    let mut counts: std::collections::HashMap<&str, usize> = Default::default();
    for t in g7_syntax::tokens(&readable.text) {
        let word = readable.text.get(t.start..t.end).unwrap_or("").trim_matches('`');
        *counts.entry(word).or_default() += 1;
    }
    for n in names(document) {
        let (from, to) = readable.units(n.name.at.0);
        match n.meaning {
            Meaning::Variable(v, chart) => variables.push(Variable {
                name: n.name.text.to_string(),
                class: class(v.kind),
                ty: v.ty.to_string(),
                init: v.init.as_ref().map_or(String::new(), |e| readable.words(e.at.0)),
                address: v.address.as_ref().map_or(String::new(), |a| a.text.to_string()),
                inverted: v.inverted,
                retain: v.retain,
                safe: v.safe.as_ref().map_or(String::new(), |e| readable.words(e.at.0)),
                comment: v.comment.as_deref().unwrap_or("").to_owned(),
                chart: chart.map(|c| c.name.text.to_string()),
                from,
                to,
                uses: counts.get(&*n.name.text).copied().unwrap_or(0).saturating_sub(1),
            }),
            Meaning::Step(c, s) => steps.push(Step {
                id: ids::step(&c.name.text, &s.name.text),
                name: s.name.text.to_string(),
                chart: c.name.text.to_string(),
                comment: s.comment.as_deref().unwrap_or("").to_owned(),
                initial: s.initial,
                from,
                to,
            }),
            Meaning::Chart(_) | Meaning::Other(..) => {}
        }
    }
    Tables { stale: readable.stale, variables, steps }
}

/// A declaration on one line, as it would stand in the text.
pub(crate) fn declaration(name: &str, v: &VarDecl) -> String {
    let mut line = format!("{} {name} : {}", class(v.kind), v.ty);
    if v.init.is_some() && v.ty != Type::Bool {
        line.push_str(" := …");
    }
    if let Some(a) = &v.address {
        line.push_str(&format!(" at {}", a.text));
    }
    if v.retain {
        line.push_str(" retain");
    }
    line
}
