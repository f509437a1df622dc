//! IEC 61131-3 text becomes documents that mean the same, and comes of them.
//!
//! The files stand in `tests/interchange/iectext`; what is expected of them is
//! written here from the standard, not from a run.
#![allow(
    clippy::disallowed_methods,
    reason = "the tests read the files that they are about, and mind the time of hostile ones"
)]

mod carried;
mod corpus;
mod enumerations;
mod functions;
mod hostile;
mod instances;
mod problems;
mod programs;
mod types;
pub(crate) mod written;

use crate::support;

use std::path::Path;

use g7_model::{Document, FileId, Problem, Severity};

/// The bytes of a file of the project's own.
fn file(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/interchange/iectext").join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn import(text: &str) -> (Document, Vec<Problem>) {
    support::import("sfc", text.as_bytes(), FileId(0))
}

/// The document of a text without problems, as .g7 text.
#[track_caller]
fn carried(text: &str) -> String {
    let (document, problems) = import(text);
    assert_eq!(problems, []);
    g7_syntax::print(&document, None)
}

fn errors(problems: &[Problem]) -> Vec<&str> {
    problems.iter().filter(|p| p.severity() == Severity::Error).map(|p| &*p.what).collect()
}
