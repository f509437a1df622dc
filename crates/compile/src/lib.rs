//! From a document to a program.
//!
//! ```text
//! model::Document -> resolve (names, types) -> ir::Unit -> check (rules of GRAFCET and SFC)
//!                                                       -> lower -> engine::Program + Symbols
//! ```
//!
//! A mistake of the author is a [`Problem`], never an `Err` and never a panic. All problems of a
//! document are reported, not only the first.
#![forbid(unsafe_code)]

mod allow;
pub mod check;
mod circles;
mod held;
pub mod ir;
pub mod lower;
pub mod plant;
pub mod references;
pub mod resolve;
mod stages;
pub mod symbols;
pub mod tree;

use g7_model::{Document, Problem, Span, codes, say};

pub use held::Held;
pub use references::{Definition, References, references};
pub use stages::{Compiled, compile, compile_as, compile_with, is_part};

/// Returns the problems of a document and of its plants, in the order of the text. Plants are
/// checked only if the charts that they drive compile.
pub fn check(doc: &Document) -> Vec<Problem> {
    let (charts, mut problems) = compile(doc);
    if let Some(charts) = charts {
        for plant in plant::plants(doc) {
            problems.extend(plant::compile_plant(doc, plant, &charts, &[]).1);
        }
    }
    if problems.is_empty() {
        problems.extend(empty(doc));
    }
    stages::sorted(problems)
}

/// The problem of a document with nothing in it but notes.
pub fn empty(doc: &Document) -> Option<Problem> {
    let file = doc.notes.first().map(|n| n.at.file).unwrap_or_default();
    let what = say!("there is nothing in this file");
    let help = say!("a chart begins with `chart Main {{ … }}`; `g7 new` writes one");
    let problem = || Problem::new(&codes::EMPTY_FILE, Span { file, start: 0, end: 0 }, what).help(help);
    doc.items.is_empty().then(problem)
}
