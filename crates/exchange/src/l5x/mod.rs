//! Projects and parts of projects of Studio 5000 Logix Designer (`.L5X`), read
//! into a [`Document`]: their routines in SFC.
//!
//! # Where this sits
//!
//! ```text
//! bytes -> xml -> chart (steps, transitions, branches of one routine; text -> iec)
//!              -> words (step members, `[:=]`, JSR)
//!              -> tags (what the charts name: types, aliases, values)
//!              -> build (Document)
//! ```
//!
//! Tags that no chart names, and routines in other languages, are left out.

mod build;
mod chart;
mod tags;
mod words;

use g7_model::{Document, FileId, Problem};

use crate::report::Report;
use crate::xml;

/// Whether an element of this name is the root of such a file.
pub(crate) fn is_root(name: &str) -> bool {
    name == "RSLogix5000Content"
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
