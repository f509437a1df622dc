//! The parts of arguments that several commands share: the form of the output, and the exit codes for the help.

use clap::ValueEnum;

/// The exit codes, for the help of most commands.
pub(crate) const EXIT_CODES: &str = "\
Exit codes:
  0  fine
  1  problems were found, or a test failed
  2  bad usage, or something outside the chart: no such file, a full disk";

/// The format of the output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// For people.
    Text,
    /// For programs: one JSON object.
    Json,
}
