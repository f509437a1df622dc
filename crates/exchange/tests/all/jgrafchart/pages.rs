//! Each code of imported files has a page, and the examples of the page are as
//! wrong as they say.
#![allow(clippy::disallowed_methods, reason = "the pages are read")]

use crate::support;
use std::path::PathBuf;

use g7_model::{FileId, codes};

/// The codes that a piece of XML gives; a fragment stands in a workspace.
fn reported(xml: &str) -> Vec<&'static str> {
    let whole = ["<GCDocument", "<Project"].iter().any(|root| xml.starts_with(root));
    let file = if whole { xml.to_string() } else { format!("<GCDocument name='J1'>{xml}</GCDocument>") };
    let (_, problems) = support::import("jgrafchart", file.as_bytes(), FileId(0));
    problems.iter().map(|p| p.code.id).collect()
}

/// The XML blocks of a page; true before those that are wrong.
fn blocks(page: &str) -> Vec<(bool, &str)> {
    let mut blocks = Vec::new();
    for piece in page.split("\n```xml").skip(1) {
        let (fence, rest) = piece.split_once('\n').expect("a line behind the fence");
        let text = rest.split("\n```").next().expect("a block");
        blocks.push((fence == ",wrong", text));
    }
    blocks
}

#[test]
fn each_code_of_imported_files_has_a_page_that_holds() {
    for code in codes::ALL.iter().filter(|c| c.id.starts_with("G06")) {
        let file: PathBuf =
            [env!("CARGO_MANIFEST_DIR"), "..", "..", "docs", "book", "src", "problems"].iter().collect();
        let page = std::fs::read_to_string(file.join(format!("{}.md", code.id))).expect(code.id);
        assert!(page.starts_with(&format!("# {}: {}\n", code.id, code.title)), "{}: heading", code.id);
        assert!(page.contains(code.source), "{}: source", code.id);
        let blocks = blocks(&page);
        assert!(blocks.iter().any(|(wrong, _)| *wrong), "{}: no example", code.id);
        for (wrong, xml) in blocks {
            assert_eq!(reported(xml).contains(&code.id), wrong, "{}: {xml}\n{:?}", code.id, reported(xml));
        }
    }
}
