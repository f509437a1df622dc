//! Problems as the page shows them.

use g7_model::{Document, Problem, Severity, Span};
use serde::{Deserialize, Serialize};

use crate::file::File;
use crate::fixes::{Fix, SOME, fixes};
use crate::ids;

/// One problem.
#[derive(Debug, Serialize)]
pub(crate) struct Row {
    code: &'static str,
    title: &'static str,
    severity: &'static str,
    what: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    help: Option<String>,
    from: usize,
    to: usize,
    line: usize,
    column: usize,
    related: Vec<Related>,
    items: Vec<String>,
    fixes: Vec<Fix>,
}

#[derive(Debug, Serialize)]
struct Related {
    from: usize,
    to: usize,
    what: String,
}

/// A piece of text in place of another; places in code units.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq, Eq)]
pub(crate) struct Change {
    pub(crate) from: usize,
    pub(crate) to: usize,
    pub(crate) insert: String,
}

/// The problems of a file.
pub(crate) fn rows(file: &File) -> Vec<Row> {
    let small = file.text().len() < 100_000;
    file.problems.iter().enumerate().map(|(i, p)| whole_row(file, p, small && i < SOME)).collect()
}

/// One problem, with the fixes that cost nothing.
pub(crate) fn row(file: &File, p: &Problem) -> Row {
    whole_row(file, p, false)
}

fn whole_row(file: &File, p: &Problem, time: bool) -> Row {
    let (from, to) = units(file, p.at);
    let byte = file.source.range(p.at).start;
    let (line, column) = file.positions.line_column(file.text(), byte);
    let related = p.related.iter().map(|(at, what)| {
        let (from, to) = units(file, *at);
        Related { from, to, what: what.clone() }
    });
    Row {
        code: p.code.id,
        title: p.code.title,
        severity: if p.severity() == Severity::Error { "error" } else { "warning" },
        what: p.what.clone(),
        help: p.help.clone(),
        from,
        to,
        line,
        column,
        related: related.collect(),
        items: items(&file.source.document, p),
        fixes: fixes(file, p, time),
    }
}

/// A place in code units.
pub(crate) fn units(file: &File, at: Span) -> (usize, usize) {
    let range = file.source.range(at);
    let unit = |byte| file.positions.unit(file.text(), byte);
    (unit(range.start), unit(range.end))
}

/// What of the drawing a problem marks: the symbol it stands in, and those of
/// the other places.
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
