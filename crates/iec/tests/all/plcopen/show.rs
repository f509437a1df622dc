//! Files, and documents to compare with.

use crate::support;
use crate::support::recognise;
use std::path::PathBuf;

use g7_model::{Document, FileId, Item, Problem, Severity};

/// A file of `tests/interchange/plcopen`.
pub(crate) fn bytes(name: &str) -> Vec<u8> {
    let folder = [env!("CARGO_MANIFEST_DIR"), "..", "..", "tests", "interchange", "plcopen"];
    std::fs::read(folder.iter().collect::<PathBuf>().join(name)).expect("the file is part of the repository")
}

/// Its result.
pub(crate) fn import(name: &str) -> (Document, Vec<Problem>) {
    let bytes = bytes(name);
    assert_eq!(recognise("", &bytes), Some("plcopen"), "{name}");
    support::import("plcopen", &bytes, FileId(0))
}

/// A document from its text, which has to be without errors.
pub(crate) fn document(text: &str) -> Document {
    let (document, problems) = g7_syntax::parse(text, FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    document
}

/// The text of a document without its places.
pub(crate) fn text(document: &Document) -> String {
    let items = document.items.iter().filter(|i| !matches!(i, Item::Layout(_))).cloned().collect();
    g7_syntax::print(&Document { items, notes: Vec::new() }, None)
}

/// `code line` of each problem.
pub(crate) fn places(bytes: &[u8], problems: &[Problem]) -> Vec<String> {
    let line = |at: u32| 1 + bytes.iter().take(at as usize).filter(|b| **b == b'\n').count();
    problems.iter().map(|p| format!("{} {}", p.code.id, line(p.at.start))).collect()
}

/// The errors, in words.
pub(crate) fn errors(problems: &[Problem]) -> Vec<&str> {
    problems.iter().filter(|p| p.severity() == Severity::Error).map(|p| &*p.what).collect()
}

/// True if it can be run.
pub(crate) fn compiles(document: &Document) {
    let (compiled, problems) = g7_compile::compile(document);
    assert!(compiled.is_some(), "{:?}", errors(&problems));
}
