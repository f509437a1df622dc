//! Reads JGrafchart's XML files into a [`Document`] and writes them.
//!
//! # Where this sits
//!
//! ```text
//! bytes -> xml -> read (sheets) -> calls, fuse -> links, naming, actions -> build (Document)
//! Document -> write -> text
//! ```
//!
//! - `read` turns each workspace of the file into a [`sheet::Sheet`], with the names and links of
//!   the file. `calls` copies procedures to the steps that call them, `fuse` merges fused steps.
//! - `naming` gives every chart, step and variable its name in the document and finds the meaning
//!   of dotted names in texts.
//! - `links` follows the lines through splits, joins and connection posts.
//! - `lex` and `phrase` parse the action language; `express` and `actions` turn it into typed
//!   expressions. In JGrafchart the context decides whether `1` is a number or TRUE, here the types
//!   do.
//!
//! # What must hold
//!
//! - Nothing here panics or fails: an element that cannot be carried over is a [`Problem`] with its
//!   place in the file, never dropped in silence. With only warnings the rest runs as in JGrafchart;
//!   with an error it does not.
//! - Every span lies in the XML file, so a message shows the author's own line.

mod actions;
mod build;
mod calls;
mod express;
mod fuse;
mod guards;
mod lex;
mod limits;
mod links;
mod naming;
mod other_elements;
mod phrase;
mod read;
mod sheet;
mod together;
mod values;
mod write;

use g7_model::{Document, FileId, Problem};

use g7_iec::report::Report;
use g7_iec::xml;

pub(crate) use write::export;

/// True if a file is a chart saved by JGrafchart.
pub(crate) fn fits(_: &str, root: Option<&str>, _: &[u8]) -> bool {
    root.is_some_and(read::is_root)
}

/// Reads a chart saved by JGrafchart (2.x, `saveVersion` up to 8).
///
/// Always returns a document with everything that could be read, and the problems in the order of
/// the file.
pub(crate) fn import(bytes: &[u8], file: FileId) -> (Document, Vec<Problem>) {
    let mut report = Report::new(file);
    let document = xml::text(bytes, &mut report)
        .and_then(|text| xml::tree(text, &mut report))
        .map(|tree| {
            let mut reader = read::sheets(&tree, &mut report);
            calls::expand(&mut reader);
            let mut plan = reader.plan;
            fuse::fuse(&mut plan, &mut report);
            let document = build::document(&plan, &mut report);
            together::tell(&document, &mut report);
            document
        })
        .unwrap_or_default();
    (document, report.finish())
}
