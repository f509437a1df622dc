//! PLCopen TC6 XML (2.01 and 2.0, also the first edition) and IEC 61131-10 XML.
//!
//! # Where this sits
//!
//! ```text
//! bytes -> xml -> tree -> read (project) -> types -> code -> units (instances, names)
//!       graph -> flow (steps, transitions), network (values, statements)
//!       -> bodies, actions, declare -> chart -> build (Document)
//! ```
//!
//! - `tree` gives the elements of both standards the same names.
//! - `read` finds the POUs, types, global variables and tasks, wherever a dialect stores them.
//! - `types` and `code` give types, functions, function blocks without a chart and all statements to the passes of
//!   `sfc`, which make of them what they make of those of a text.
//! - `units` makes an instance of each program and of each function block with a chart that is used, with the
//!   meanings of the names in it.
//! - `graph` connects the wires of a drawing, which are stored backwards; `flow` finds the steps
//!   before and behind each transition, `network` computes the values of contacts and blocks.
//! - `bodies` rewrites statements with the names of the document and replaces calls of function blocks with a chart,
//!   or with an instance of one, by their bodies.
//!
//! # What must hold
//!
//! - An element of IEC 61131-3 that G7 does not have is a problem with its place; nothing is
//!   dropped in silence.
//! - Work and size are bounded: wires, visits, instances, statements.

mod actions;
mod addresses;
mod bodies;
mod build;
mod chart;
mod code;
mod condition;
mod declare;
mod dialect;
mod draft;
mod flow;
mod graph;
mod inputs;
mod network;
mod read;
mod tree;
mod types;
mod units;
mod write;

use g7_model::{Document, FileId, Problem};

use crate::report::Report;
use crate::xml;

/// True if a file is of TC6 or IEC 61131-10, judged by its first element and its name space.
pub fn fits(_: &str, root: Option<&str>, bytes: &[u8]) -> bool {
    if !root.is_some_and(|root| matches!(root.rsplit(':').next(), Some("project" | "Project"))) {
        return false;
    }
    let head = bytes.get(..bytes.len().min(1 << 12)).unwrap_or(bytes);
    // A file in UTF-16 is recognised too, so that its reader can report the encoding.
    let narrow: Vec<u8> = head.iter().copied().filter(|b| *b != 0).collect();
    let text = String::from_utf8_lossy(&narrow);
    ["plcopen.org/xml/tc6", "TC65SC65BWG7TF10"].iter().any(|mark| text.contains(mark))
}

pub use dialect::Dialect;

/// Writes a document as a project, in the dialect that most tools read.
pub fn export(document: &Document) -> crate::Written {
    write::export(document, Dialect::USUAL)
}

/// Writes a document as a project for one tool.
pub fn export_for(document: &Document, dialect: Dialect) -> crate::Written {
    write::export(document, dialect)
}

/// Reads a project.
pub fn import(bytes: &[u8], file: FileId) -> (Document, Vec<Problem>) {
    let mut report = Report::new(file);
    let document = xml::text(bytes, &mut report)
        .and_then(|text| xml::tree(text, &mut report))
        .map(|tree| {
            let project = read::project(&tree, &mut report);
            build::document(&project, tree.root_element(), &mut report)
        })
        .unwrap_or_default();
    let mut problems = report.finish();
    // A problem in a block occurs in each of its instances; it is reported once.
    problems.dedup_by(|a, b| a.code == b.code && a.at == b.at && a.what == b.what);
    (document, problems)
}
