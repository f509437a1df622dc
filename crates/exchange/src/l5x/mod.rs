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

/// The elements that a part of such a file begins with.
const PARTS: [&str; 5] = ["Controller", "Programs", "Program", "Routines", "Routine"];

/// True if the first element is the root of such a file, or of a part of one with a chart in it.
pub(crate) fn fits(_: &str, root: Option<&str>, bytes: &[u8]) -> bool {
    let has_chart = || bytes.windows(CHART.len()).any(|w| w == CHART);
    root == Some("RSLogix5000Content") || root.is_some_and(|r| PARTS.contains(&r)) && has_chart()
}

/// The start of the tag that holds a chart.
const CHART: &[u8] = b"<SFCContent";

/// Reads a project, program or routine.
pub(crate) fn import(bytes: &[u8], file: FileId) -> (Document, Vec<Problem>) {
    let mut report = Report::new(file);
    let document = xml::text(bytes, &mut report)
        .and_then(|text| xml::tree(text, &mut report))
        .map(|tree| build::document(tree.root_element(), &mut report))
        .unwrap_or_default();
    (document, report.finish())
}
