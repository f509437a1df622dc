//! The problem codes: one row each, never reused.
//!
//! `G00xx` files and words, `G01xx` structure, `G02xx` names and types, `G03xx`
//! evolution and actions, `G04xx` limits of a target PLC, `G05xx` plants and
//! tests, `G06xx` imported files. Each has a page `docs/book/src/problems/<id>.md`
//! and a case in `tests/check`; a test holds us to both.

use crate::Severity;

/// A problem code.
#[derive(Debug, PartialEq, Eq)]
pub struct Code {
    /// What users search for and suppress: `G0123`.
    pub id: &'static str,
    /// How far a chart with it may go.
    pub severity: Severity,
    /// A few words: the heading of its page.
    pub title: &'static str,
    /// The rule behind it.
    pub source: &'static str,
}

macro_rules! codes {
    ($($name:ident = $id:literal $severity:ident $title:literal $source:literal;)*) => {
        $(#[doc = $title] pub static $name: Code =
            Code { id: $id, severity: Severity::$severity, title: $title, source: $source };)*
        /// Every code, by number.
        pub static ALL: &[&Code] = &[$(&$name),*];
    };
}

codes! {
    // Files and words
    BAD_ENCODING = "G0001" Error "not UTF-8 text" "the .g7 format";
    BAD_CHARACTER = "G0002" Error "a character that has no meaning here" "the .g7 format";
    UNCLOSED = "G0003" Error "a bracket, text or note that is never closed" "the .g7 format";
    EXPECTED = "G0004" Error "something else was expected here" "the .g7 format";
    BAD_NUMBER = "G0005" Error "a number that cannot be read" "IEC 61131-3:2003, 2.2.1";
    BAD_DURATION = "G0006" Error "a duration that cannot be read" "IEC 61131-3:2003, 2.2.3";
    TOO_DEEP = "G0007" Error "nested too deeply" "the .g7 format";
    TOO_LARGE = "G0008" Error "the file is too large" "the .g7 format";
    UNKNOWN_WORD = "G0009" Error "a word the language does not have" "the .g7 format";
    TOO_MANY_PROBLEMS = "G0010" Error "too many problems to list" "the .g7 format";
}

/// The code with this id (`G0101`, in any case), if there is one.
pub fn find(id: &str) -> Option<&'static Code> {
    ALL.iter().copied().find(|c| c.id.eq_ignore_ascii_case(id))
}
