//! The forms of programs that the writers have.

use std::collections::HashSet;

use crate::words;

/// The kind of program that the format has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    /// Charts with the same period are networks of one program, with expansions in line. If it is `drawn`, tools
    /// make a variable of each step.
    Networks { drawn: bool },
    /// Each chart is a program, with macro-steps.
    Charts,
    /// The same, with the variables of each chart in its program: others use them by its name, as in CODESYS.
    /// Bodies end with their step if those of the document do (`no-final-scan`).
    Codesys { bare: bool },
}

impl Form {
    /// The words that nothing may be called.
    pub(super) fn words(self) -> HashSet<&'static str> {
        if self.is_of_matiec() { words::of_matiec().collect() } else { words::everywhere().collect() }
    }

    /// True if matiec reads what is written, itself or for another tool.
    pub(super) fn is_of_matiec(self) -> bool {
        !matches!(self, Form::Codesys { .. })
    }

    /// True if expansions stand in line, in networks of one program.
    pub(super) fn in_line(self) -> bool {
        matches!(self, Form::Networks { .. })
    }
}
