//! Failures of the environment, one line each; exit code 2.

use std::io;
use std::path::{Path, PathBuf};

use g7_model::{Said, say};

use crate::tongue::language;

/// Why a command could not be executed.
#[derive(Debug)]
pub(crate) enum Failure {
    /// A file that cannot be read.
    Read(PathBuf, io::Error),
    /// A file that cannot be written.
    Write(PathBuf, io::Error),
    /// The standard output cannot be written.
    Output(io::Error),
    /// A file that is no chart: its name, and why.
    Form { name: String, why: Said },
    /// An error that the user can correct.
    Usage(Said),
}

impl Failure {
    /// The line, for each language.
    pub(crate) fn said(&self) -> Said {
        match self {
            Failure::Read(path, e) => say!("cannot read {}: {}", show(path), plain(e)),
            Failure::Write(path, e) => {
                say!("cannot write {}: {}; nothing was changed", show(path), plain(e))
            }
            Failure::Output(e) => say!("cannot write to the standard output: {}", plain(e)),
            Failure::Form { name, why } => say!("{}: {why}", raw(name)),
            Failure::Usage(what) => what.clone(),
        }
    }
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.said().in_language(language()))
    }
}

impl std::error::Error for Failure {}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Failure {
        Failure::Output(error)
    }
}

impl From<g7_rig::Error> for Failure {
    fn from(error: g7_rig::Error) -> Failure {
        Failure::Usage(match error {
            g7_rig::Error::SeveralPlants { file, there } => {
                say!(
                    "{} has several plants: choose with --plant one of {}, or none",
                    raw(file),
                    raw(there.join(", "))
                )
            }
            other @ g7_rig::Error::NoPlant { .. } => other.said(),
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
fn show(path: &Path) -> Said {
    let plain: String =
        path.display().to_string().chars().map(|c| if c.is_control() { '?' } else { c }).collect();
    raw(plain)
}

/// A name, a number or the message of another program among the words of a sentence.
pub(crate) fn raw(what: impl std::fmt::Display) -> Said {
    Said::foreign(what.to_string())
}

/// The message of the system, without its error number.
pub(crate) fn plain(error: &io::Error) -> Said {
    let text = error.to_string();
    let end = text.find(" (os error").unwrap_or(text.len());
    let text = text.get(..end).unwrap_or(&text);
    let mut letters = text.chars();
    let text: String =
        letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect());
    // The usual messages of a system are told in each language; the others stay as the system has them.
    match text.as_str() {
        "no such file or directory" | "entity not found" => say!("no such file or directory"),
        "permission denied" => say!("permission denied"),
        "is a directory" => say!("is a directory"),
        "not a directory" => say!("not a directory"),
        "address already in use" => say!("address already in use"),
        "no space left on device" => say!("no space left on device"),
        "read-only file system" => say!("read-only file system"),
        _ => raw(text),
    }
}

/// The system has no resources for a thread or a connection.
pub(crate) fn refused(error: io::Error) -> Failure {
    Failure::Usage(say!("the system refuses: {}", plain(&error)))
}

/// The deeds of people at a machine from elsewhere are written down, and there is no log for that.
pub(crate) fn unlogged(at: &dyn std::fmt::Display) -> Said {
    say!(
        "{} is reached from other machines: what people do at a machine from there is written down; name a \
         `log` in [controller] of the io file",
        raw(at)
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
