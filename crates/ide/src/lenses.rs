//! Offers of an editor above an item: run it, test it, prove it, draw it.

use g7_model::{Item, Span};

use crate::file::Readable;

/// An offer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lens {
    /// The item above which it stands.
    pub at: Span,
    /// Its effect.
    pub work: Work,
}

/// The effect of a lens.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Work {
    /// Runs the file.
    Run,
    /// Shows the drawing of a chart.
    Draw(String),
    /// Runs one test.
    Test(String),
    /// Answers all questions about the file.
    Prove,
}

/// The offers of a file: a chart is run and drawn, a test is run, a property is proved.
pub fn lenses(readable: &Readable<'_>) -> Vec<Lens> {
    let document = readable.document;
    let mut all = Vec::new();
    let mut run = false;
    for item in &document.items {
        match item {
            Item::Chart(c) => {
                if !std::mem::replace(&mut run, true) {
                    all.push(Lens { at: c.at.0, work: Work::Run });
                }
                all.push(Lens { at: c.at.0, work: Work::Draw(c.name.text.to_string()) });
            }
            Item::Test(t) => all.push(Lens { at: t.at.0, work: Work::Test(t.title.to_string()) }),
            Item::Prove(p) => all.push(Lens { at: p.at.0, work: Work::Prove }),
            Item::Profile(_)
            | Item::Cycle(..)
            | Item::Target(..)
            | Item::Use(_)
            | Item::Var(_)
            | Item::Instance(_)
            | Item::Composed(_)
            | Item::Type(_)
            | Item::Action(_)
            | Item::Section(_)
            | Item::Function(_)
            | Item::Pre(..)
            | Item::Post(..)
            | Item::Plant(_)
            | Item::Layout(_) => {}
        }
    }
    all
}
