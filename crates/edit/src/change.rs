//! The two ends of a gesture: the file it is given, and the change of the text or the refusal that
//! comes out.
//!
//! It stands below the draft, the gestures and the difference, which all use these types, and above ids
//! and splices.
//!
//! # What must hold
//!
//! A refused gesture leaves nothing but a sentence for the user.

use g7_model::{Document, Problem, Severity};
use g7_syntax::{Marks, Tree};

use crate::id::ItemId;
use crate::splice::Splice;

/// A file: its text and the parsed document.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// The text.
    pub text: &'a str,
    /// Its document, as `g7_syntax::parse` gave it.
    pub document: &'a Document,
    /// The problems of its syntax.
    pub problems: &'a [Problem],
    /// What a change of the text needs in order to read only a part of it.
    pub marks: Option<&'a Marks>,
}

impl Source<'_> {
    /// True if the text has no syntax errors.
    pub(crate) fn is_clean(&self) -> bool {
        self.problems.iter().all(|p| p.severity() != Severity::Error)
    }
}

/// A change of the text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Edit {
    /// The changes in bytes of the text before, in order and without overlap.
    pub splices: Vec<Splice>,
    /// The parts to be selected after the change.
    pub select: Vec<ItemId>,
    /// The part whose field the user fills in next.
    pub begin: Option<ItemId>,
    /// Sentences for the user about the change.
    pub told: Vec<String>,
    /// The text after the change with all that was read of it, if it was read.
    pub read: Option<Box<Tree>>,
}

/// The reason why a gesture was refused: a sentence for the user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal(String);

impl Refusal {
    pub(crate) fn new(why: impl Into<String>) -> Refusal {
        Refusal(why.into())
    }
}

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Refusal {}

/// Refuses a gesture.
pub(crate) fn refuse<T>(why: impl Into<String>) -> Result<T, Refusal> {
    Err(Refusal::new(why))
}

/// The places of symbols on the drawing, in hundredths of its unit: the middle of the upper edge of
/// a step, the middle of the bar of a transition.
pub type Anchors<'a> = &'a dyn Fn(&ItemId) -> Option<(i32, i32)>;
