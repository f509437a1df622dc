//! The arguments of `g7 grade`.

use std::path::PathBuf;

use g7_model::Nanos;

use crate::values;

const EXAMPLES: &str = "\
Examples:
  g7 grade lamp                              checks the exercise itself
  g7 grade lamp handed-in                    a table: a row for each file or folder in it
  g7 grade lamp handed-in --csv marks.csv    for a spreadsheet
  g7 grade lamp handed-in --html report      a page for each student, and one for the teacher
  g7 grade lamp chart.g7                     one submission

Exit codes:
  0  every submission passed; or the exercise is right
  1  a submission did not pass, or the exercise has mistakes
  2  bad usage, or something outside the charts: no such file, a full disk";

/// The arguments of `g7 grade`.
#[derive(clap::Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Grade {
    /// The folder of the exercise; `g7 new exercise` makes one.
    pub(super) exercise: PathBuf,
    /// A folder in which each file and each folder is a submission, or one file. Without it the exercise is checked.
    pub(super) submissions: Option<PathBuf>,
    /// Write the table for a spreadsheet.
    #[arg(long, value_name = "FILE", requires = "submissions")]
    pub(super) csv: Option<PathBuf>,
    /// Write all results for a program.
    #[arg(long, value_name = "FILE", requires = "submissions")]
    pub(super) json: Option<PathBuf>,
    /// Write a page for each submission, and `index.html` for the teacher, to this folder.
    #[arg(long, value_name = "FOLDER", requires = "submissions")]
    pub(super) html: Option<PathBuf>,
    /// Let --csv and --json replace a file that g7 did not write.
    #[arg(long)]
    pub(super) force: bool,
    /// How many submissions are graded at a time [default: as many as there are processors].
    #[arg(long, short, value_name = "NUMBER", value_parser = clap::value_parser!(u16).range(1..=256))]
    pub(super) jobs: Option<u16>,
    /// End a test that takes more real time than this: it has failed.
    #[arg(long, value_parser = values::duration, value_name = "TIME", default_value = "10s")]
    pub(super) timeout: Nanos,
    /// Real time for the questions of a submission; what is not decided by then stays open.
    #[arg(long, value_parser = values::duration, value_name = "TIME", default_value = "10s")]
    pub(super) time: Nanos,
    /// Memory for the questions of a submission, in MiB.
    #[arg(long, value_name = "MIB", default_value_t = 256)]
    pub(super) memory: usize,
}
