//! A mistake of an author, as a value.
//!
//! A check reports facts. The command line, the language server and the canvas present the same
//! value. Wrong input is never an `Err`: a check returns the parts of the chart that it could use
//! *and* the problems, so the rest stays usable.

use crate::{Fix, Said, Severity, Span, codes::Code, say};

/// A mistake in a chart that its author can correct.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Which rule was broken; carries title, severity and source.
    pub code: &'static Code,
    /// The place to underline.
    pub at: Span,
    /// The facts: lower case, no full stop, names in back-ticks.
    pub what: Said,
    /// Other places, each with a description of what stands *there* (not with advice).
    pub related: Vec<(Span, Said)>,
    /// A remedy, if there is one that is very likely right.
    pub help: Option<Said>,
    /// Changes of the text that solve it, the likeliest first; may be empty.
    pub fixes: Vec<Fix>,
}

impl Problem {
    /// A problem with only a place and a message.
    pub fn new(code: &'static Code, at: Span, what: Said) -> Problem {
        Problem { code, at, what, related: Vec::new(), help: None, fixes: Vec::new() }
    }

    /// Adds another place.
    #[must_use]
    pub fn related(mut self, at: Span, there: Said) -> Problem {
        self.related.push((at, there));
        self
    }

    /// Adds a remedy.
    #[must_use]
    pub fn help(mut self, help: Said) -> Problem {
        self.help = Some(help);
        self
    }

    /// Adds a change of the text that solves it.
    #[must_use]
    pub fn fix(mut self, fix: Fix) -> Problem {
        self.fixes.push(fix);
        self
    }

    /// Asks whether another name was meant, and offers it in the place of the problem, if it can be written
    /// there as it is.
    #[must_use]
    pub fn meant(self, near: &str) -> Problem {
        let plain = near.chars().all(|c| c.is_alphanumeric() || c == '_');
        let at = self.at;
        let problem = self.help(say!("did you mean `{near}`?"));
        if plain { problem.fix(Fix::likely(say!("write `{near}`"), at, near)) } else { problem }
    }

    /// Tells whether the chart can still be compiled.
    pub fn severity(&self) -> Severity {
        self.code.severity
    }
}

impl std::fmt::Display for Problem {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.what)
    }
}
