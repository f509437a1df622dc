//! A copy of unsaved work as a file: a line that says what it is, and then the text.
//!
//! The list of all copies reads the first lines alone. Earlier versions wrote path and text as one line of JSON, which
//! is still read: its window is not known, so that it belongs to whoever comes.

use std::fs::File;
use std::io::{self, BufRead as _, BufReader, Read as _, Seek as _};
use std::path::Path;
use std::time::UNIX_EPOCH;

use serde::{Deserialize, Serialize};

/// The longest first line, and the longest copy, in bytes.
const LONGEST: u64 = 16 << 20;

/// The first line.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Eq, Serialize)]
pub(super) struct Head {
    pub(super) path: String,
    #[serde(default)]
    pub(super) person: String,
    #[serde(default)]
    pub(super) window: String,
    /// The server that wrote it.
    #[serde(default)]
    pub(super) server: String,
    /// The time of the last change, in ms since 1970.
    #[serde(default)]
    pub(super) at: u64,
    /// The hash of the file that was changed; `None` for a new file.
    #[serde(default)]
    pub(super) base: Option<String>,
    /// Its owner has closed the file, or has undone the changes.
    #[serde(default)]
    pub(super) closed: bool,
    /// The text, as earlier versions wrote it.
    #[serde(default, skip_serializing)]
    pub(super) text: Option<String>,
}

impl Head {
    /// The bytes of the file.
    pub(super) fn with(&self, text: &str) -> io::Result<Vec<u8>> {
        let mut bytes = serde_json::to_vec(self)?;
        bytes.push(b'\n');
        bytes.extend_from_slice(text.as_bytes());
        Ok(bytes)
    }
}

/// The first line of a copy, and the length of its text.
pub(super) fn head(path: &Path) -> io::Result<(Head, u64)> {
    let mut file = BufReader::new(File::open(path)?);
    let head = first(&mut file, path)?;
    let length = match &head.text {
        Some(text) => text.len() as u64,
        None => file.get_ref().metadata()?.len().saturating_sub(file.stream_position()?),
    };
    Ok((head, length))
}

/// A copy with its text.
pub(super) fn whole(path: &Path) -> io::Result<(Head, String)> {
    let mut file = BufReader::new(File::open(path)?);
    let mut head = first(&mut file, path)?;
    let mut text = head.text.take().unwrap_or_default();
    if text.is_empty() {
        file.take(LONGEST).read_to_string(&mut text)?;
    }
    Ok((head, text))
}

fn first(file: &mut BufReader<File>, path: &Path) -> io::Result<Head> {
    let mut line = Vec::new();
    file.take(LONGEST).read_until(b'\n', &mut line)?;
    let mut head: Head = serde_json::from_slice(&line)?;
    if head.at == 0 {
        let written = path.metadata()?.modified()?.duration_since(UNIX_EPOCH).unwrap_or_default();
        head.at = u64::try_from(written.as_millis()).unwrap_or_default();
    }
    Ok(head)
}
