//! Files of the project, and problems as short lines to compare with.

use crate::support;
use std::path::PathBuf;

use g7_model::{Document, FileId, Problem};

/// The bytes of a file of `tests/interchange/xmi`.
pub(crate) fn bytes(name: &str) -> Vec<u8> {
    let path: PathBuf =
        [env!("CARGO_MANIFEST_DIR"), "..", "..", "tests", "interchange", "xmi", name].iter().collect();
    std::fs::read(path).expect("the file is part of the repository")
}

/// The result of an instance.
pub(crate) fn import(bytes: &[u8]) -> (Document, Vec<Problem>) {
    support::import("xmi", bytes, FileId(0))
}

/// A .g7 text without mistakes.
pub(crate) fn read(text: &str) -> Document {
    let (document, problems) = g7_syntax::parse(text, FileId(0));
    assert!(problems.is_empty(), "{problems:?}");
    document
}

/// `code line: words` of each problem.
pub(crate) fn lines(bytes: &[u8], problems: &[Problem]) -> Vec<String> {
    let line = |at: u32| 1 + bytes.iter().take(at as usize).filter(|b| **b == b'\n').count();
    problems.iter().map(|p| format!("{} {}: {}", p.code.id, line(p.at.start), p.what)).collect()
}
