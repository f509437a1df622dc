//! IEC 60848 charts as EMF/XMI instances of the AGRAFE meta-model, read and written.
//!
//! # Where this sits
//!
//! ```text
//! bytes -> xml -> refs, read (plan) -> names -> arcs, terms, actions -> build (Document)
//!                                                     Document -> write -> text
//! ```
//!
//! - `refs` resolves positional references (`//@partialGrafcets.0/@steps.1`): what
//!   a name does elsewhere, the place in the file does here.
//! - `read` lists the charts, steps, variables and actions of the file with their
//!   attributes, and names what the meta-model does not have.
//! - `names` gives each of them the name that it has in the document; identifiers
//!   of the file need not be unique.
//! - `arcs` follows arcs through synchronisations to the steps of a transition.
//! - `terms` and `actions` turn terms into expressions and action types into actions.
//! - `write` goes the other way.
//!
//! # What must hold
//!
//! - Nothing here panics or fails: what cannot be carried is a [`Problem`] with
//!   its place, never dropped in silence.
//! - A reference that leads nowhere, or to something of the wrong kind, is told
//!   with what stands in its place; nested charts never form a circle.
//! - What is written and read again is the same document, or a problem says what
//!   the meta-model cannot hold.

mod actions;
mod arcs;
mod build;
mod names;
mod nesting;
mod read;
mod refs;
mod terms;
mod write;

use g7_model::{Document, FileId, Problem};

use crate::report::Report;
use crate::xml;

pub(crate) use write::export;

/// Whether a file with this first element is one of the meta-model's.
pub(crate) fn is_root(name: &str) -> bool {
    name == "Grafcet" || name.ends_with(":Grafcet")
}

/// Reads an instance of the meta-model.
///
/// Always gives a document, as much of one as could be read, and what is wrong
/// or was not carried over, in the order of the file.
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
