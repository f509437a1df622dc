//! ClassicLadder's projects, read into a [`Document`].
//!
//! # Where this sits
//!
//! ```text
//! bytes -> read (sections of the file) -> plan (steps, rungs, expressions)
//!       -> vars, arith, ladder, blocks -> build (Document)
//! ```
//!
//! - `read` cuts a project (`.clp`, `.clprj`), or its `sequential.csv` alone,
//!   into the little files it is made of, each line with its place.
//! - `plan` is what these lines say, still with the file's own numbers.
//! - `vars` finds what a variable `type/number` is, and declares what is used;
//!   `tables` are variables by index.
//! - `arith` reads the expressions of compare and operate boxes.
//! - `ladder` turns rungs into Structured Text in ClassicLadder's own order,
//!   column by column; `blocks` are its timers, monostables and counters.
//!
//! # What must hold
//!
//! A chart runs as in ClassicLadder: transitions one after the other in the order
//! of their numbers, again until nothing changes, 50 rounds at most.

mod arith;
mod blocks;
mod build;
mod ladder;
mod plan;
mod read;
mod tables;
mod vars;

use g7_model::{Document, FileId, Problem};

use crate::report::Report;
use crate::xml;

pub(crate) use read::fits;

/// Reads a project, or its `sequential.csv`.
pub(crate) fn import(bytes: &[u8], file: FileId) -> (Document, Vec<Problem>) {
    let mut report = Report::new(file);
    let document = xml::text(bytes, &mut report)
        .and_then(|text| read::parts(text, &mut report))
        .map(|parts| {
            let plan = plan::plan(&parts, &mut report);
            build::document(&plan, &mut report)
        })
        .unwrap_or_default();
    (document, report.finish())
}
