//! The sheets of paper, and the texts of their title block, as arguments.

use clap::ValueEnum;
use clap::builder::PossibleValue;
use g7_dossier::Head;
use g7_draw::Paper;
use g7_model::say;

use crate::failure::Failure;

/// A sheet of paper, by the name that [`Paper::ALL`] gives it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct PaperName(pub(crate) Paper);

impl ValueEnum for PaperName {
    fn value_variants<'a>() -> &'a [PaperName] {
        const ALL: [PaperName; 4] = {
            let [(_, a), (_, b), (_, c), (_, d)] = Paper::ALL;
            [PaperName(a), PaperName(b), PaperName(c), PaperName(d)]
        };
        &ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        let (name, paper) = Paper::ALL.into_iter().find(|(_, paper)| *paper == self.0)?;
        let how = if paper.landscape { " on its side" } else { ", upright" };
        Some(PossibleValue::new(name).help(format!("{:?}{how}", paper.size)))
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
