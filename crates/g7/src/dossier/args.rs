//! The arguments of `g7 dossier`.

use std::path::PathBuf;

use clap::ValueEnum;
use g7_dossier::Part;
use g7_model::Nanos;

use crate::draw::{Heading, PaperName};
use crate::values;

const EXAMPLES: &str = "\
Examples:
  g7 dossier tank -o tank.pdf           everything about the chart
  g7 dossier tank -o tank.pdf --lang fr --title \"Tank 4\" --author \"A. Martin\" --date 2026-03-01
  g7 dossier tank -o tank.pdf --paper a3-landscape
  g7 dossier tank -o tank.pdf --part charts,io
  g7 dossier tank -o tank.pdf --no-prove

Exit codes:
  0  fine; a test that fails and a claim that is refuted are told in the dossier
  1  the chart cannot be read
  2  bad usage, or something outside the chart: no such file, a full disk";

/// The arguments of `g7 dossier`.
#[derive(clap::Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Dossier {
    /// A .g7 file, a file of another tool, or a folder with a chart.g7.
    #[arg(default_value = ".")]
    pub(super) file: PathBuf,
    /// The PDF to write [default: the standard output].
    #[arg(long, short, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
    /// The sheets.
    #[arg(long, value_enum, default_value_t = PaperName::default(), value_name = "PAPER")]
    pub(super) paper: PaperName,
    /// Only these parts, separated by commas.
    #[arg(long, value_enum, value_delimiter = ',', value_name = "PARTS")]
    pub(super) part: Vec<PartName>,
    #[command(flatten)]
    pub(super) heading: Heading,
    /// Ask no questions about all runs.
    #[arg(long)]
    pub(super) no_prove: bool,
    /// Run no tests.
    #[arg(long)]
    pub(super) no_tests: bool,
    /// The time in which the questions are answered.
    #[arg(long, value_parser = values::duration, value_name = "TIME", default_value = "30s")]
    pub(super) time: Nanos,
    /// The time that one test may take.
    #[arg(long, value_parser = values::duration, value_name = "TIME", default_value = "60s")]
    pub(super) timeout: Nanos,
    /// Draw actions with qualifier boxes, as in IEC 61131-3.
    #[arg(long)]
    pub(super) sfc: bool,
    /// Replace an output that is there and that g7 did not write; never the chart itself.
    #[arg(long)]
    pub(super) force: bool,
}

/// A part of the dossier.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum PartName {
    /// Charts, expansions and tasks.
    Charts,
    /// Inputs and outputs.
    Io,
    /// Variables and constants.
    Variables,
    /// Cross references.
    References,
    /// Actions, functions and processing.
    Bodies,
    /// Plants with their pictures.
    Plants,
    /// Tests with their chronograms.
    Tests,
    /// Questions with their answers.
    Proofs,
    /// Problems and warnings.
    Problems,
}

impl PartName {
    pub(super) fn part(self) -> Part {
        match self {
            PartName::Charts => Part::Charts,
            PartName::Io => Part::Signals,
            PartName::Variables => Part::Variables,
            PartName::References => Part::References,
            PartName::Bodies => Part::Bodies,
            PartName::Plants => Part::Plants,
            PartName::Tests => Part::Tests,
            PartName::Proofs => Part::Proofs,
            PartName::Problems => Part::Problems,
        }
    }
}
