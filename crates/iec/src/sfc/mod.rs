//! IEC 61131-3 in text: sequential function charts with Structured Text and Instruction List.
//!
//! # Where this sits
//!
//! ```text
//! bytes -> st (lexer, parser) -> read (units) -> programs, resources, enabled, functions, inouts, instances, blocks -> build (Document)
//!                                                                                      -> st::settle
//! Document -> write -> text
//! ```
//!
//! - `read` turns the file into program organisation units and configurations.
//! - `programs` makes a unit of each program that the configuration runs, and connects its parameters.
//! - `enabled` and `functions` rewrite calls with `EN`, and functions with more than one elementary result.
//! - `instances` makes a unit of each instance of a block with a chart.
//! - `blocks` replaces calls of the file's own function blocks by their bodies.
//! - `build` makes a chart of each unit with steps, assigns globals, addresses and intervals of the
//!   configuration, and reports those that have no place.
//! - `write` prints a document. The text reads back as an equal document where the standard has a
//!   form for it.

mod blocks;
mod build;
mod called;
mod enabled;
mod functions;
mod inouts;
mod instances;
mod programs;
mod read;
mod resources;
mod singles;
mod unit;
mod write;

use g7_model::codes;
use g7_model::{Document, FileId, Item, Problem, say};

use crate::report::Report;
use crate::st::Parser;
use crate::xml;

pub(crate) use build::function;
pub(crate) use called::in_receptivity;
pub(crate) use unit::{Part, Source, Unit, UnitKind};
pub use write::export;

/// The endings of such files, without the dot.
pub const ENDINGS: &[&str] = &["st", "sfc", "iec", "exp", "il"];

/// The words with which such a file begins.
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
/// The number of bytes that are inspected to recognise a file.
const HEAD: usize = 1 << 16;

/// True if a file is such text, judged by its first word, otherwise by the ending of its name.
pub fn fits(name: &str, _: Option<&str>, bytes: &[u8]) -> bool {
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
    begins(text) || ENDINGS.contains(&ending.as_str())
}

/// True if the first word begins a unit.
fn begins(text: &str) -> bool {
    let mut report = Report::new(FileId(0));
    let place = |r| r;
    let parser = Parser::new(text, &place, &mut report);
    let word = parser.word();
    // In a function of the .g7 language the inputs follow its name.
    FIRST.contains(&word.as_str()) && !parser.ahead_is(1, "{")
        || word == "FUNCTION" && parser.ahead_is(2, ":")
}

/// Reads a file. Always returns a document with everything that could be read.
pub fn import(bytes: &[u8], file: FileId) -> (Document, Vec<Problem>) {
    let mut report = Report::new(file);
    let Some(text) = xml::text(bytes, &mut report) else { return (Document::default(), report.finish()) };
    let place = |r| r;
    let mut parser = Parser::new(text, &place, &mut report);
    let mut source = read::source(&mut parser);
    programs::expand(&mut source, &mut report);
    resources::expand(&mut source, &mut report);
    if source.units.is_empty() && source.globals.is_empty() {
        let what = say!("no PROGRAM, FUNCTION_BLOCK, FUNCTION or CONFIGURATION stands in this file");
        let end = text.len().min(1);
        report.say(&codes::NOT_JGRAFCHART, &(0..end), what);
        return (Document::default(), report.finish());
    }
    rewrite(&mut source, &mut report);
    instances::expand(&mut source, &mut report);
    blocks::expand(&mut source, &mut report);
    let document = build::document(source, text.len(), &mut report);
    (document, report.finish())
}

/// Rewrites calls with `EN`, functions, and in-outs in the forms that a document has for them.
pub(crate) fn rewrite(source: &mut Source, report: &mut Report) {
    enabled::expand(source, report);
    functions::expand(source, report);
    inouts::expand(source, report);
}

/// Takes the function blocks that are used out of the list of units. Gives the enumerations, the structures, and these
/// function blocks.
pub(crate) fn types(source: &mut Source, report: &mut Report) -> Vec<Item> {
    blocks::expand(source, report);
    build::types(source).collect()
}
