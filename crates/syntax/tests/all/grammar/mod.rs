//! Each construct of the grammar, and what it means as a document.

mod charts;
mod expressions;
mod statements;
mod world;

use g7_model::{Document, FileId};

/// A text without a problem.
fn read(text: &str) -> Document {
    let (document, problems) = g7_syntax::parse(text, FileId(0));
    assert!(problems.is_empty(), "{text}\n{problems:#?}");
    document
}
