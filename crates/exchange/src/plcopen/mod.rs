//! PLCopen TC6 XML (2.01 and 2.0, also the first edition) and IEC 61131-10 XML.
//!
//! # Where this sits
//!
//! ```text
//! bytes -> xml -> tree -> read (project) -> units (instances, names)
//!       graph -> flow (steps, transitions), network (values, statements)
//!       -> code, actions, declare -> chart -> build (Document)
//! ```
//!
//! - `tree` gives the elements of both standards one name.
//! - `read` finds the POUs, global variables and tasks, wherever a dialect keeps them.
//! - `units` makes an instance of each program and of each function block that is
//!   used, with what the names in it stand for.
//! - `graph` joins the wires of a drawing, which are stored backwards; `flow` finds
//!   the steps before and behind each transition, `network` the values of contacts
//!   and blocks.
//! - `code` gives names of the document to statements and puts the bodies of the
//!   file's own blocks where they are called.
//!
//! # What must hold
//!
//! - What the language of IEC 61131-3 has and G7 has not is a problem with its
//!   place: nothing is dropped in silence.
//! - Work and size are bounded: wires, visits, instances, statements.

mod actions;
mod build;
mod chart;
mod code;
mod condition;
mod declare;
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

/// Whether a file with this first element may be one: its name space tells the rest.
pub(crate) fn is_root(name: &str) -> bool {
    matches!(name.rsplit(':').next(), Some("project" | "Project"))
}

/// Whether a file is of TC6 or IEC 61131-10.
pub(crate) fn fits(bytes: &[u8]) -> bool {
    let head = bytes.get(..bytes.len().min(1 << 12)).unwrap_or(bytes);
    // Also in UTF-16, so that the reader can say what is wrong with it.
    let narrow: Vec<u8> = head.iter().copied().filter(|b| *b != 0).collect();
    let text = String::from_utf8_lossy(&narrow);
    ["plcopen.org/xml/tc6", "TC65SC65BWG7TF10"].iter().any(|mark| text.contains(mark))
}

/// Writes a document as a project.
pub(crate) fn export(document: &Document) -> crate::Written {
    write::export(document)
}

/// Reads a project.
pub(crate) fn import(bytes: &[u8], file: FileId) -> (Document, Vec<Problem>) {
    let mut report = Report::new(file);
    let document = xml::text(bytes, &mut report)
        .and_then(|text| xml::tree(text, &mut report))
        .map(|tree| {
            let project = read::project(&tree, &mut report);
            build::document(&project, tree.root_element(), &mut report)
        })
        .unwrap_or_default();
    let mut problems = report.finish();
    // What is wrong in a block is wrong in each of its instances; it is said once.
    problems.dedup_by(|a, b| a.code == b.code && a.at == b.at && a.what == b.what);
    (document, problems)
}
