//! What leaves the page: a chart in the form of another tool, or as a picture.

use g7_draw::{Drawing, Options};
use g7_exchange::Outlet;
use g7_model::{Problem, Severity};
use serde::Serialize;

use crate::file::File;
use crate::problems::{Row, row};

/// A form in which a chart can leave.
#[derive(Debug, Serialize)]
pub(crate) struct Form {
    word: &'static str,
    title: &'static str,
    kind: &'static str,
}

/// A chart in another form.
#[derive(Debug, Serialize)]
pub(crate) struct Out {
    files: Vec<OutFile>,
    /// What it does not carry; places are those of the chart.
    problems: Vec<Row>,
    /// It does not mean what the chart means.
    lossy: bool,
}

/// A file that would leave.
#[derive(Debug, Serialize)]
pub(crate) struct OutFile {
    name: String,
    text: String,
    /// What of it belongs to which symbol.
    marks: Vec<Mark>,
}

/// The lines of a text, from 0, that belong to a symbol.
#[derive(Debug, Serialize)]
struct Mark {
    id: String,
    lines: Vec<usize>,
}

/// All forms, in the order in which they are shown.
pub(crate) fn forms() -> Vec<Form> {
    let chart = |o: &Outlet| Form { word: o.word(), title: o.title(), kind: "chart" };
    let picture = Form { word: "svg", title: "SVG", kind: "picture" };
    Outlet::ALL.iter().map(chart).chain([picture]).collect()
}

/// A file in another form.
pub(crate) fn export(name: &str, file: &File, to: &str) -> Result<Out, String> {
    if let Some(first) = file.problems.iter().find(|p| p.severity() == Severity::Error) {
        return Err(format!("the chart has errors: {}", first.what));
    }
    let stem = name.rsplit('/').next().unwrap_or(name);
    let stem = stem.strip_suffix(".g7").unwrap_or(stem);
    if to == "svg" {
        return Ok(out(file, vec![(format!("{stem}.svg"), picture(file))], &[]));
    }
    let outlet =
        Outlet::ALL.iter().find(|o| o.word() == to).ok_or_else(|| format!("there is no form `{to}`"))?;
    let written = g7_exchange::export(*outlet, &file.source.document);
    let name = format!("{stem}.{}", outlet.ending());
    Ok(out(file, vec![(name, written.text)], &written.problems))
}

fn out(file: &File, files: Vec<(String, String)>, problems: &[Problem]) -> Out {
    Out {
        files: files.into_iter().map(|(name, text)| OutFile { name, text, marks: Vec::new() }).collect(),
        lossy: problems.iter().any(|p| p.severity() == Severity::Error),
        problems: problems.iter().map(|p| row(file, p)).collect(),
    }
}

/// All charts on one sheet.
fn picture(file: &File) -> String {
    let options = Options { font: true, ..Options::default() };
    let document = &file.source.document;
    let drawings: Vec<Drawing> = document.charts().map(|c| g7_draw::draw(document, c, &options)).collect();
    match drawings.as_slice() {
        [one] => g7_draw::svg(one, &options),
        several => g7_draw::sheet(document, several, &options),
    }
}
