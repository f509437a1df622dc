//! IEC 61131-3 in text: sequential function charts with Structured Text and Instruction List.
//!
//! # Where this sits
//!
//! ```text
//! bytes -> iec (lexer, parser) -> read (units) -> build (Document) -> iec::settle
//! Document -> write -> text
//! ```
//!
//! - `read` turns the file into program organisation units and configurations.
//! - `blocks` puts function blocks of the file's own where they are called.
//! - `build` makes a chart of each unit with steps, brings globals, addresses and
//!   intervals of the configuration to their places and tells what has none.
//! - `write` goes the other way; what it writes is read back equal where the
//!   standard has a form for it.

mod blocks;
mod build;
mod read;
mod unit;
mod write;

use g7_model::codes;
use g7_model::{Document, FileId, Problem};

use crate::iec::Parser;
use crate::report::Report;
use crate::xml;

pub(crate) use write::export;

/// The first words of such a file.
const FIRST: [&str; 8] = [
    "PROGRAM",
    "FUNCTION_BLOCK",
    "CONFIGURATION",
    "TYPE",
    "VAR_GLOBAL",
    "INITIAL_STEP",
    "RESOURCE",
    "NAMESPACE",
];
/// How much of a file is looked at to tell what it is.
const HEAD: usize = 1 << 16;

/// Whether a file is such text: by its first word, else by the ending of its name.
pub(crate) fn fits(name: &str, bytes: &[u8]) -> bool {
    let ending = name.rsplit_once('.').map_or("", |(_, e)| e).to_ascii_lowercase();
    if ending == "g7" {
        return false;
    }
    let head = bytes.get(..bytes.len().min(HEAD)).unwrap_or(&[]);
    let head = head.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(head);
    let text = match std::str::from_utf8(head) {
        Ok(text) => text,
        Err(e) => std::str::from_utf8(head.get(..e.valid_up_to()).unwrap_or(&[])).unwrap_or(""),
    };
    begins(text) || matches!(ending.as_str(), "st" | "sfc" | "iec" | "exp" | "il")
}

/// Whether the first word is one that begins a unit.
fn begins(text: &str) -> bool {
    let mut report = Report::new(FileId(0));
    let place = |r| r;
    let parser = Parser::new(text, &place, &mut report);
    let word = parser.word();
    // A function of the .g7 language has its inputs behind its name.
    FIRST.contains(&word.as_str()) && !parser.ahead_is(1, "{")
        || word == "FUNCTION" && parser.ahead_is(2, ":")
}

/// Reads a file. Always gives a document, as much of one as could be read.
pub(crate) fn import(bytes: &[u8], file: FileId) -> (Document, Vec<Problem>) {
    let mut report = Report::new(file);
    let Some(text) = xml::text(bytes, &mut report) else { return (Document::default(), report.finish()) };
    let place = |r| r;
    let mut parser = Parser::new(text, &place, &mut report);
    let mut source = read::source(&mut parser);
    if source.units.is_empty() && source.globals.is_empty() {
        let what = "no PROGRAM, FUNCTION_BLOCK, FUNCTION or CONFIGURATION stands in this file";
        let end = text.len().min(1);
        report.say(&codes::NOT_JGRAFCHART, &(0..end), what);
        return (Document::default(), report.finish());
    }
    blocks::expand(&mut source, &mut report);
    let document = build::document(source, text.len(), &mut report);
    (document, report.finish())
}
