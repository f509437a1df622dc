//! Reads files of Control Expert and Unity Pro into a [`Document`]: `.XSF` with one chart, `.XEF`
//! or the content of `.ZEF` with an application. Writes a document as `.XSF`.
//!
//! # Where this sits
//!
//! ```text
//! bytes -> xml -> read (sheets with their objects)   -> grid (lines) -> build (Document)
//!              -> declarations (variables, structures) --------------^
//! ```
//!
//! - `write` goes the other way.
//! - `read` lists the objects of each chart with their places on the grid.
//! - `grid` finds out which of them touch. The file has no other connections except jumps and drawn
//!   links.
//! - `declarations` reads variables; a structure becomes one variable for each member.
//! - `build` makes charts, named actions and transition sections. Their Structured Text is read by
//!   `iec`; `dialect` rewrites the words that only Control Expert has.

mod build;
mod declarations;
mod dialect;
mod grid;
mod read;
mod write;

use g7_model::{Document, FileId, Problem, codes, say};

use g7_iec::report::Report;
use g7_iec::xml;

pub(crate) use write::export;

/// True if the first element is the root of such a file.
pub(crate) fn fits(_: &str, root: Option<&str>, _: &[u8]) -> bool {
    let roots = [
        "SFCExchangeFile",
        "FEFExchangeFile",
        "FEXExchangeFile",
        "PRGExchangeFile",
        "SFCProgram",
        "SFCContent",
        "SFCSource",
        "chartSource",
        "networkSFC",
    ];
    root.is_some_and(|root| roots.contains(&root))
}

/// Reads a chart, or an application with charts.
pub(crate) fn import(bytes: &[u8], file: FileId) -> (Document, Vec<Problem>) {
    let mut report = Report::new(file);
    let document = xml::text(bytes, &mut report)
        .and_then(|text| xml::tree(text, &mut report))
        .map(|tree| {
            let root = tree.root_element();
            let sheets = read::sheets(root, &mut report);
            if sheets.is_empty() {
                let what = say!("there is no chart in the file: no `networkSFC`");
                report.say(&codes::NOT_JGRAFCHART, &xml::attr::head(root), what);
                return Document::default();
            }
            build::document(root, &sheets, &mut report)
        })
        .unwrap_or_default();
    (document, report.finish())
}
