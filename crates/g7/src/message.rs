//! Messages for the user, on the standard error, in the language of this run.
//!
//! Every command talks through here, so that the standard output holds data alone.

use std::fmt::Display;

use g7_model::{Said, say};

use crate::failure::Failure;
use crate::style;
use crate::tongue::language;

/// Prints a message to the standard error; a closed standard error is ignored. The words of this program are
/// told by [`tell`]; this prints what is in a language already, and what a controller says while it runs.
macro_rules! talk {
    ($($arg:tt)*) => {{
        use std::io::Write as _;
        writeln!(anstream::stderr(), $($arg)*).ok();
    }};
}

pub(crate) use talk;

/// Prints a sentence.
#[allow(clippy::needless_pass_by_value, reason = "callers make the sentence here")]
pub(crate) fn tell(what: Said) {
    talk!("{}", told(&what));
}

/// A text in the language of this run.
pub(crate) fn told(what: &Said) -> String {
    what.in_language(language())
}

/// Tells that a file was written.
pub(crate) fn wrote(what: impl Display) {
    done(&say!("wrote"), what);
}

/// Prints a finished action and its object: `wrote chart.svg`.
pub(crate) fn done(word: &Said, what: impl Display) {
    talk!("{}{}{:#} {what}", style::GOOD, told(word), style::GOOD);
}

/// Prints a note.
#[allow(clippy::needless_pass_by_value, reason = "callers make the sentence here")]
pub(crate) fn note(what: Said) {
    talk!("{}{}:{:#} {}", style::WARN, told(&say!("note")), style::WARN, told(&what));
}

/// Prints why a command could not be carried out.
pub(crate) fn error(why: &Failure) {
    talk!("{}{}:{:#} {why}", style::BAD, told(&say!("error")), style::BAD);
}
