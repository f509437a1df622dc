//! Problems in the form that the page shows.

use g7_ide::File;
use g7_ide::ids;
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
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
struct Fix {
    title: String,
    splices: Vec<Change>,
}

/// Number of problems for which gestures are tried as fixes; each costs a check of the whole file.
const SOME: usize = 8;

#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
struct Related {
    from: usize,
    to: usize,
    what: String,
}

/// The problems of a file, with fixes.
pub(crate) fn rows(file: &File) -> Vec<Row> {
    let small = file.text().len() < 100_000;
    file.problems.iter().enumerate().map(|(i, p)| whole_row(file, p, small && i < SOME)).collect()
}

/// One problem, with only those fixes that need no check of the file.
pub(crate) fn row(file: &File, p: &Problem) -> Row {
    whole_row(file, p, false)
}

fn whole_row(file: &File, p: &Problem, time: bool) -> Row {
    let (from, to) = file.units(p.at);
    let byte = file.source.range(p.at).start;
    let (line, column) = file.positions.line_column(file.text(), byte);
    let related = p.related.iter().map(|(at, what)| {
        let (from, to) = file.units(*at);
        Related { from, to, what: what.in_language(file.language) }
    });
    let fixes = g7_ide::fixes::fixes(file, p, time);
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
            .map(|f| Fix { splices: outward(file, &f.splices), title: f.title })
            .collect(),
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
