//! What an author can do wrong, as a value.
//!
//! A check reports facts; the command line, the language server and the canvas
//! render the same value. Wrong input is never an `Err`: a check returns what
//! it could make of the chart *and* the problems, so the rest stays usable.

use crate::{Span, codes::Code};

/// How far a chart with this problem may go.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Runs as written, but probably not as meant.
    Warning,
    /// Has no meaning in the standard; cannot be compiled.
    Error,
}

/// Something wrong with a chart that its author can mend.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Which rule was broken; carries title, severity and source.
    pub code: &'static Code,
    /// The place to underline.
    pub at: Span,
    /// What is the case: lower case, no full stop, names in back-ticks.
    pub what: String,
    /// Other places, each with what is *there* (not with advice).
    pub related: Vec<(Span, String)>,
    /// The way out, if there is one we would bet on.
    pub help: Option<String>,
}

impl Problem {
    /// A problem with nothing but a place and a message.
    pub fn new(code: &'static Code, at: Span, what: impl Into<String>) -> Problem {
        Problem { code, at, what: what.into(), related: Vec::new(), help: None }
    }

    /// Adds another place.
    #[must_use]
    pub fn related(mut self, at: Span, there: impl Into<String>) -> Problem {
        self.related.push((at, there.into()));
        self
    }

    /// Adds the way out.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Problem {
        self.help = Some(help.into());
        self
    }

    /// Whether the chart can still be compiled.
    pub fn severity(&self) -> Severity {
        self.code.severity
    }
}

impl std::fmt::Display for Problem {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.what)
    }
}
