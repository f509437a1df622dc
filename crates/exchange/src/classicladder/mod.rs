//! Reads ClassicLadder's projects into a [`Document`].
//!
//! # Where this sits
//!
//! ```text
//! bytes -> read (sections of the file) -> project (steps, rungs, expressions)
//!       -> variables, arith, ladder, blocks -> build (Document)
//! ```
//!
//! - `read` splits a project (`.clp`, `.clprj`), or its `sequential.csv` alone, into the small
//!   files it consists of, each line with its place.
//! - `project` holds the content of these lines, with the numbers of the file.
//! - `variables` finds the meaning of a variable `type/number` and declares the variables that are
//!   used; `tables` handles variables with an index.
//! - `arith` parses the expressions of compare and operate boxes.
//! - `ladder` translates rungs into Structured Text in ClassicLadder's execution order, column by
//!   column; `blocks` translates timers, monostables and counters.
//!
//! # What must hold
//!
//! A chart runs as in ClassicLadder: transitions one after the other in the order of their numbers,
//! repeated until nothing changes, at most 50 rounds.

mod arith;
mod blocks;
mod build;
mod ladder;
mod project;
mod read;
mod tables;
mod variables;

use g7_model::{Document, FileId, Problem};

use g7_iec::report::Report;
use g7_iec::xml;

pub(crate) use read::fits;

/// Reads a project, or its `sequential.csv`.
pub(crate) fn import(bytes: &[u8], file: FileId) -> (Document, Vec<Problem>) {
    let mut report = Report::new(file);
    let document = xml::text(bytes, &mut report)
        .and_then(|text| read::parts(text, &mut report))
        .map(|parts| {
            let plan = project::plan(&parts, &mut report);
            build::document(&plan, &mut report)
        })
        .unwrap_or_default();
    (document, report.finish())
}
