//! Files of Control Expert and Unity Pro (`.XSF` of one chart, `.XEF` and `.ZEF`'s
//! inside of an application), read into a [`Document`].
//!
//! # Where this sits
//!
//! ```text
//! bytes -> xml -> read (sheets: what stands where) -> grid (lines) -> build (Document)
//!              -> data (variables, structures)     ----------------^
//! ```
//!
//! - `read` lists the objects of each chart with their places on the grid.
//! - `grid` finds which of them touch: the file has no other connections but
//!   jumps and drawn links.
//! - `data` reads the declarations; a structure is one variable for each member.
//! - `build` writes charts, named actions and transition sections; their
//!   Structured Text is read by `iec`.

mod build;
mod data;
mod grid;
mod read;
mod words;

use g7_model::{Document, FileId, Problem, codes};

use crate::report::Report;
use crate::xml;

/// Whether an element of this name is the root of such a file.
pub(crate) fn is_root(name: &str) -> bool {
    matches!(name, "SFCExchangeFile" | "FEFExchangeFile" | "FEXExchangeFile" | "PRGExchangeFile")
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
                let what = "there is no chart in the file: no `SFCProgram` with a `networkSFC`";
                report.say(&codes::NOT_JGRAFCHART, &xml::attr::head(root), what);
                return Document::default();
            }
            build::document(root, &sheets, &mut report)
        })
        .unwrap_or_default();
    (document, report.finish())
}
