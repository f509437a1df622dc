//! The sheets of paper, and the texts of their title block, as arguments.

use clap::ValueEnum;
use g7_dossier::Head;
use g7_draw::Paper;
use g7_model::say;

use crate::failure::Failure;

/// A sheet of paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PaperName {
    /// A4, upright.
    A4,
    /// A4 on its side.
    A4Landscape,
    /// A3, upright.
    A3,
    /// A3 on its side.
    A3Landscape,
}

impl PaperName {
    pub(crate) fn paper(self) -> Paper {
        let [a4, a4_landscape, a3, a3_landscape] = Paper::ALL.map(|(_, paper)| paper);
        match self {
            PaperName::A4 => a4,
            PaperName::A4Landscape => a4_landscape,
            PaperName::A3 => a3,
            PaperName::A3Landscape => a3_landscape,
        }
    }
}

// The texts of a title block. A comment of documentation here would take the place of the command's own.
#[derive(clap::Args, Clone, Debug, Default)]
pub(crate) struct Heading {
    /// The title in the title block; without it the name of the file.
    #[arg(long, value_name = "TEXT")]
    title: Option<String>,
    /// The author in the title block.
    #[arg(long, value_name = "TEXT")]
    author: Option<String>,
    /// The company in the title block.
    #[arg(long, value_name = "TEXT")]
    company: Option<String>,
    /// The revision in the title block.
    #[arg(long, value_name = "TEXT")]
    revision: Option<String>,
    /// The date in the title block, as it is to be printed.
    #[arg(long, value_name = "TEXT")]
    date: Option<String>,
}

impl Heading {
    pub(crate) fn head(&self) -> Head {
        let text = |given: &Option<String>| given.clone().unwrap_or_default();
        Head {
            title: text(&self.title),
            author: text(&self.author),
            company: text(&self.company),
            revision: text(&self.revision),
            date: text(&self.date),
        }
    }

    /// Refuses texts for a title block where there is none.
    pub(super) fn refuse(&self) -> Result<(), Failure> {
        if self.head() == Head::default() {
            return Ok(());
        }
        Err(Failure::Usage(say!("a title block stands on sheets of paper: add --pages a4 or another sheet")))
    }
}
