//! The two ends of a gesture: the file it is given, and the change of the text or the refusal that
//! comes out.
//!
//! It stands below the draft, the gestures and the difference, which all use these types, and above ids
//! and splices.
//!
//! # What must hold
//!
//! A refused gesture leaves nothing but a sentence for the user.

use std::ops::Range;

use g7_model::{Document, Language, Problem, Said, Severity};
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
    /// The marks of the text, with which a change of it reads only a part; none: it reads all.
    pub marks: Option<&'a Marks>,
}

impl Source<'_> {
    /// True if the text has no syntax errors.
    pub(crate) fn is_clean(&self) -> bool {
        self.errors().next().is_none()
    }

    fn errors(&self) -> impl Iterator<Item = &Problem> {
        self.problems.iter().filter(|p| p.severity() == Severity::Error)
    }

    /// True if no syntax error stands in the items of the file that these bytes touch, or between them and
    /// the items that follow.
    pub fn reads_cleanly(&self, bytes: Range<usize>) -> bool {
        if self.is_clean() {
            return true;
        }
        let starts: Vec<usize> = self.document.items.iter().map(|i| i.at().bytes().start).collect();
        // The numbers of the parts of the text, each from the start of an item to that of the next one.
        let parts = |bytes: Range<usize>| {
            let first = starts.partition_point(|start| *start < bytes.start);
            first..=starts.partition_point(|start| *start <= bytes.end)
        };
        let mine = parts(bytes);
        self.errors().map(|p| parts(p.at.bytes())).all(|p| p.end() < mine.start() || mine.end() < p.start())
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
    pub told: Vec<Said>,
    /// The text after the change with all that was read of it, if it was read.
    pub read: Option<Box<Tree>>,
}

/// The reason why a gesture was refused: a sentence for the user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal(Said);

impl Refusal {
    pub(crate) fn new(why: Said) -> Refusal {
        Refusal(why)
    }

    /// The sentence in a language.
    pub fn in_language(&self, language: Language) -> String {
        self.0.in_language(language)
    }
}

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Refusal {}

impl From<Refusal> for Said {
    fn from(refusal: Refusal) -> Said {
        refusal.0
    }
}

/// Refuses a gesture.
pub(crate) fn refuse<T>(why: Said) -> Result<T, Refusal> {
    Err(Refusal::new(why))
}

/// The places of symbols on the drawing, in hundredths of its unit: the middle of the upper edge of
/// a step, the middle of the bar of a transition.
pub type Anchors<'a> = &'a dyn Fn(&ItemId) -> Option<(i32, i32)>;
