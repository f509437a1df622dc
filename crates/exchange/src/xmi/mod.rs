//! Reads and writes IEC 60848 charts as EMF/XMI instances of the AGRAFE meta-model.
//!
//! # Where this sits
//!
//! ```text
//! bytes -> xml -> refs, read (plan) -> naming -> arcs, terms, actions -> build (Document)
//! Document -> write -> text
//! ```
//!
//! - `refs` resolves references by position (`//@partialGrafcets.0/@steps.1`).
//! - `read` lists the charts, steps, variables and actions of the file with their attributes, and
//!   reports elements that the meta-model does not have.
//! - `naming` gives each of them its name in the document; identifiers of the file need not be
//!   unique.
//! - `arcs` follows arcs through synchronisations to the steps of a transition.
//! - `terms` and `actions` turn terms into expressions and action types into actions.
//! - `timed` knows Booleans that are named like a time operator.
//! - `nesting` finds the charts of enclosing steps and macro-steps.
//! - `write` goes the other way.
//!
//! # What must hold
//!
//! - Nothing here panics or fails: an element that cannot be carried over is a [`Problem`] with its
//!   place, never dropped in silence.
//! - A reference that leads nowhere, or to an element of the wrong kind, is reported with its
//!   replacement. Nested charts never form a circle.
//! - A document that is written and read again is the same, or a problem says what the meta-model
//!   cannot hold.

mod actions;
mod arcs;
mod build;
mod naming;
mod nesting;
mod read;
mod refs;
mod terms;
mod timed;
mod write;

use g7_model::{Document, FileId, Problem};

use g7_iec::report::Report;
use g7_iec::xml;

pub(crate) use write::export;

/// True if the first element is one of the meta-model's.
pub(crate) fn fits(_: &str, root: Option<&str>, _: &[u8]) -> bool {
    root.is_some_and(|root| root == "Grafcet" || root.ends_with(":Grafcet"))
}

/// Reads an instance of the meta-model.
///
/// Always returns a document with everything that could be read, and the problems in the order of
/// the file.
pub(crate) fn import(bytes: &[u8], file: FileId) -> (Document, Vec<Problem>) {
    let mut report = Report::new(file);
    let document = xml::text(bytes, &mut report)
        .and_then(|text| xml::tree(text, &mut report))
        .map(|tree| {
            let plan = read::plan(&tree, &mut report);
            build::document(&plan, &mut report)
        })
        .unwrap_or_default();
    (document, report.finish())
}
