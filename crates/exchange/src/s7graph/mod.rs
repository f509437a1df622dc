//! Reads S7-GRAPH blocks, as exported by TIA Portal's Openness, into a [`Document`].
//!
//! # Where this sits
//!
//! ```text
//! bytes -> xml -> read (steps, transitions, branches, connections, interface)
//!              -> network (FlgNet: contacts, boxes, coils -> expressions)
//!              -> actions (tokens -> Structured Text -> iec)
//!              -> build (Document)
//! ```
//!
//! The supervision of a step blocks the transitions behind it. The interlock of a step is the
//! condition of those of its actions that ask for it. The control inputs of the sequencer (modes,
//! acknowledgement) are left out: it runs in automatic mode.

mod actions;
mod build;
mod network;
mod read;

use g7_model::{Document, FileId, Problem, codes, say};

use g7_iec::report::Report;
use g7_iec::xml;

/// The number of bytes in which a block of TIA Portal is recognised.
const HEAD: usize = 1 << 16;

/// True if a file is an export of TIA Portal.
pub(crate) fn fits(_: &str, root: Option<&str>, bytes: &[u8]) -> bool {
    let head = bytes.get(..bytes.len().min(HEAD)).unwrap_or(bytes);
    let has = |word: &[u8]| head.windows(word.len()).any(|w| w == word);
    root == Some("Document") && (has(b"<SW.Blocks.") || has(b"<Engineering "))
}

/// Reads a block in the language GRAPH.
pub(crate) fn import(bytes: &[u8], file: FileId) -> (Document, Vec<Problem>) {
    let mut report = Report::new(file);
    let document = xml::text(bytes, &mut report)
        .and_then(|text| xml::tree(text, &mut report))
        .map(|tree| {
            let root = tree.root_element();
            if !root.descendants().any(|n| n.tag_name().name() == "Graph") {
                let what = say!("there is no block in the language GRAPH in the file");
                report.say(&codes::NOT_JGRAFCHART, &xml::attr::head(root), what);
                return Document::default();
            }
            build::document(root, &mut report)
        })
        .unwrap_or_default();
    (document, report.finish())
}
