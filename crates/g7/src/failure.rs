//! Failures of the environment, one line each; exit code 2.

use std::io;
use std::path::{Path, PathBuf};

/// Why a command could not be executed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    /// A file that cannot be read.
    #[error("cannot read {}: {}", show(.0), plain(.1))]
    Read(PathBuf, io::Error),
    /// A file that cannot be written.
    #[error("cannot write {}: {}; nothing was changed", show(.0), plain(.1))]
    Write(PathBuf, io::Error),
    /// The standard output cannot be written.
    #[error("cannot write to the standard output: {}", plain(.0))]
    Output(#[from] io::Error),
    /// A file that is no chart: its name, and why.
    #[error("{name}: {why}")]
    Form { name: String, why: String },
    /// An error that the user can correct.
    #[error("{0}")]
    Usage(String),
}

impl From<g7_rig::Error> for Failure {
    fn from(error: g7_rig::Error) -> Failure {
        Failure::Usage(match error {
            g7_rig::Error::SeveralPlants { file, there } => {
                format!("{file} has several plants: choose with --plant one of {}, or none", there.join(", "))
            }
            other @ g7_rig::Error::NoPlant { .. } => other.to_string(),
        })
    }
}

impl Failure {
    /// True if the reader of a pipe has closed it; then nothing is printed.
    pub(crate) fn is_quiet(&self) -> bool {
        matches!(self, Failure::Output(e) if e.kind() == io::ErrorKind::BrokenPipe)
    }
}

/// A path as the user wrote it, on one line.
fn show(path: &Path) -> String {
    path.display().to_string().chars().map(|c| if c.is_control() { '?' } else { c }).collect()
}

/// The message of the system, without its error number.
pub(crate) fn plain(error: &io::Error) -> String {
    let text = error.to_string();
    let end = text.find(" (os error").unwrap_or(text.len());
    let text = text.get(..end).unwrap_or(&text);
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
}

/// The system has no resources for a thread or a connection.
pub(crate) fn refused(error: io::Error) -> Failure {
    Failure::Usage(format!("the system refuses: {}", plain(&error)))
}

/// The deeds of people at a machine from elsewhere are written down, and there is no log for that.
pub(crate) fn unlogged(at: &dyn std::fmt::Display) -> String {
    format!(
        "{at} is reached from other machines: what people do at a machine from there is written down; name a \
         `log` in [controller] of the io file"
    )
}

/// The result of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Exit code 0.
    Fine,
    /// Exit code 1: problems were found, or a test failed.
    Found,
    /// Exit code 3: a question is not decided, and nothing worse was found.
    Open,
}
