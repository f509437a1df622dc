//! Reads the SFC routines of projects of Studio 5000 Logix Designer (`.L5X`) into a [`Document`].
//!
//! # Where this sits
//!
//! ```text
//! bytes -> xml -> chart (steps, transitions, branches of one routine; text -> iec)
//!              -> dialect (step members, `[:=]`, JSR)
//!              -> tags (the names of the charts: types, aliases, values)
//!              -> build (Document)
//! ```
//!
//! Tags that no chart names, and routines in other languages, are left out.

mod build;
mod chart;
mod dialect;
mod tags;

use g7_model::{Document, FileId, Problem};

use g7_iec::report::Report;
use g7_iec::xml;

/// True if the first element is the root of such a file.
pub(crate) fn fits(_: &str, root: Option<&str>, _: &[u8]) -> bool {
    root == Some("RSLogix5000Content")
}

/// Reads a project, program or routine.
pub(crate) fn import(bytes: &[u8], file: FileId) -> (Document, Vec<Problem>) {
    let mut report = Report::new(file);
    let document = xml::text(bytes, &mut report)
        .and_then(|text| xml::tree(text, &mut report))
        .map(|tree| build::document(tree.root_element(), &mut report))
        .unwrap_or_default();
    (document, report.finish())
}
