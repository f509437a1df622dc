//! Problems in the form that the page shows.

use g7_ide::fixes::{Fixes, carried};
use g7_ide::undeclared::Undeclared;
use g7_ide::{File, ids};
use g7_model::{Document, Problem, Severity};
use serde::Serialize;

use crate::places::{Change, outward};

/// One problem.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "Problem", optional_fields))]
pub(crate) struct Row {
    code: &'static str,
    title: String,
    severity: Grave,
    what: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    help: Option<String>,
    from: usize,
    to: usize,
    line: usize,
    column: usize,
    related: Vec<Related>,
    /// The ids of the symbols that it marks.
    items: Vec<String>,
    fixes: Vec<Fix>,
    /// The name whose declaration solves the problem. The first fix without splices declares it in the likely way.
    #[serde(skip_serializing_if = "Option::is_none")]
    declares: Option<String>,
}

/// How grave a problem is.
#[derive(Clone, Copy, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "Severity"))]
#[serde(rename_all = "snake_case")]
enum Grave {
    Error,
    Warning,
}

/// A change that fixes a problem.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(optional_fields))]
struct Fix {
    title: String,
    /// The change of the text. A fix that is a gesture has none; the message `mend` executes it.
    #[serde(skip_serializing_if = "Option::is_none")]
    splices: Option<Vec<Change>>,
}

/// A name that nothing declares, with the declaration that its uses ask for.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "Undeclared"))]
pub(crate) struct NewName {
    name: String,
    /// `input`, `output` or `var`.
    class: &'static str,
    #[serde(rename = "type")]
    ty: String,
    /// The ids of the symbols that use it.
    items: Vec<String>,
}

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
struct Related {
    from: usize,
    to: usize,
    what: String,
}

/// The problems of a file, with fixes, and the names that nothing declares.
pub(crate) fn rows(file: &File) -> (Vec<Row>, Vec<NewName>) {
    let known = Fixes::of(file);
    let rows = file.problems.iter().map(|p| whole_row(file, p, known.fixes(p))).collect();
    (rows, names(&file.source.document, known.undeclared()))
}

/// One problem that the overview of the file does not have, with only those fixes that it carries.
pub(crate) fn row(file: &File, p: &Problem) -> Row {
    whole_row(file, p, carried(file, p))
}

/// Names that nothing declares, with the symbols of a document.
pub(crate) fn names(document: &Document, undeclared: &[Undeclared]) -> Vec<NewName> {
    let one = |u: &Undeclared| {
        let mut items: Vec<String> =
            u.uses.iter().filter_map(|at| ids::at(document, *at)).map(ids::Thing::id).collect();
        items.dedup();
        NewName { name: u.name.clone(), class: u.class, ty: u.ty.clone(), items }
    };
    undeclared.iter().map(one).collect()
}

fn whole_row(file: &File, p: &Problem, fixes: Vec<g7_ide::fixes::Fix>) -> Row {
    let (from, to) = file.units(p.at);
    let byte = file.source.range(p.at).start;
    let (line, column) = file.positions.line_column(file.text(), byte);
    let related = p.related.iter().map(|(at, what)| {
        let (from, to) = file.units(*at);
        Related { from, to, what: what.in_language(file.language) }
    });
    Row {
        code: p.code.id,
        title: p.code.title_in(file.language),
        severity: match p.severity() {
            Severity::Warning => Grave::Warning,
            Severity::Error => Grave::Error,
        },
        what: p.what.in_language(file.language),
        help: p.help.as_ref().map(|h| h.in_language(file.language)),
        from,
        to,
        line,
        column,
        related: related.collect(),
        items: items(&file.source.document, p),
        fixes: fixes
            .into_iter()
            .map(|f| Fix { splices: f.splices().map(|s| outward(file, s)), title: f.title })
            .collect(),
        declares: g7_ide::undeclared::unknown(file.text(), p).map(str::to_owned),
    }
}

/// The ids of the symbols that a problem marks: the one that contains it, and those at the related
/// places.
fn items(document: &Document, p: &Problem) -> Vec<String> {
    let mut items: Vec<String> = Vec::new();
    for at in std::iter::once(p.at).chain(p.related.iter().map(|(at, _)| *at)) {
        if let Some(thing) = ids::at(document, at) {
            let id = thing.id();
            if !items.contains(&id) {
                items.push(id);
            }
        }
    }
    items
}
