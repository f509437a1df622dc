//! The dialects of PLCopen XML: what the reader of each tool makes of a project.
//!
//! `write` asks here what a project has to look like; the reader takes all dialects at once.

/// The tool for which a project is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dialect {
    /// Beremiz.
    Beremiz,
    /// OpenPLC, whose editor and `xml2st` have the generator of Beremiz.
    OpenPlc,
    /// CODESYS and the tools made from it.
    Codesys,
    /// TC6 XML 2.01 with all that it can say.
    Standard,
}

impl Dialect {
    /// All dialects.
    pub const ALL: [Dialect; 4] = [Dialect::Beremiz, Dialect::OpenPlc, Dialect::Codesys, Dialect::Standard];

    /// The word for it on the command line.
    pub fn word(self) -> &'static str {
        match self {
            Dialect::Beremiz => "beremiz",
            Dialect::OpenPlc => "openplc",
            Dialect::Codesys => "codesys",
            Dialect::Standard => "standard",
        }
    }

    /// The dialect of a file for which none is named.
    pub const USUAL: Dialect = Dialect::Beremiz;

    /// True if the tool gives an instance of a function block of the file its initial values: the generator of Beremiz
    /// leaves them out of its text.
    pub const fn has_initial(self) -> bool {
        matches!(self, Dialect::Codesys | Dialect::Standard)
    }

    /// True if the tool generates text for matiec from the drawing, as Beremiz does.
    ///
    /// Its reader follows a wire over one divergence only, knows no macro-steps, takes a transition
    /// of its own name for an expression, orders the branches behind a step by their priorities
    /// alone, and refuses a program without variables.
    pub(super) fn is_of_matiec(self) -> bool {
        matches!(self, Dialect::Beremiz | Dialect::OpenPlc)
    }
}
