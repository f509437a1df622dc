//! JGrafchart's XML files, read into a [`Document`].
//!
//! # Where this sits
//!
//! ```text
//! bytes -> xml -> read (sheets) -> links, names, actions -> build (Document)
//! ```
//!
//! - `xml` refuses what no chart can be: wrong encodings, document types,
//!   elements nested without end, files too large. After it the work is bounded.
//! - `read` turns each workspace of the file into a [`sheet::Sheet`], still with
//!   the file's own names and links.
//! - `names` gives every chart, step and variable the name that it has in the
//!   document and finds what a dotted name in a text stands for.
//! - `links` follows the lines through splits, joins and connection posts.
//! - `lex`, `phrase` read the action language; `express` and `actions` turn it
//!   into typed expressions: there the context decides whether `1` is a number or
//!   TRUE, here the types do.
//!
//! # What must hold
//!
//! - Nothing here panics or fails: what cannot be carried is a [`Problem`] with
//!   its place in the file, never dropped in silence. A warning: the rest runs as
//!   in JGrafchart. An error: it would not.
//! - Every span lies in the XML file, so a message shows the author's own line.

mod actions;
mod build;
mod calls;
mod express;
mod fuse;
mod guards;
mod kinds;
mod lex;
mod links;
mod names;
mod phrase;
mod read;
mod sheet;
mod write;

use g7_model::{Document, FileId, Problem};

use crate::report::Report;
use crate::xml;

pub(crate) use read::is_root;
pub(crate) use write::export;

/// Reads a chart saved by JGrafchart (2.x, `saveVersion` up to 8).
///
/// Always gives a document, as much of one as could be read, and what is wrong
/// or was not carried over, in the order of the file.
pub(crate) fn import(bytes: &[u8], file: FileId) -> (Document, Vec<Problem>) {
    let mut report = Report::new(file);
    let document = xml::text(bytes, &mut report)
        .and_then(|text| xml::tree(text, &mut report))
        .map(|tree| {
            let plan = read::sheets(&tree, &mut report);
            build::document(&plan, &mut report)
        })
        .unwrap_or_default();
    (document, report.finish())
}
