//! Copies of unsaved work: they survive a crash of the page or the server.
//!
//! They are stored outside the user's folder, in the system's place for such data, in one folder
//! for each served folder. A copy is deleted when its file is saved.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use axum::http::StatusCode;
use g7_model::{Said, say};
use serde::{Deserialize, Serialize};

use super::file_names;
use super::fingerprint;
use super::refusal::Refusal;

/// Greatest number of copies for a folder.
const MOST: usize = 200;
/// Greatest size of all copies together, in bytes on the disk.
const LARGEST: u64 = 64 << 20;

/// The copies of one folder.
#[derive(Debug)]
pub(super) struct Drafts {
    folder: PathBuf,
    turn: Mutex<()>,
}

/// A copy: the name of the file, and the text to be saved.
#[derive(Debug, Deserialize, PartialEq, Eq, Serialize)]
pub(super) struct Draft {
    pub(super) path: String,
    pub(super) text: String,
}

impl Drafts {
    /// The copies for a folder, below the system's place for data of programs.
    pub(super) fn of(root: &Path, state: Option<&Path>) -> Drafts {
        let folder = match state {
            Some(state) => {
                let name = root.file_name().unwrap_or_default().to_string_lossy();
                let plain: String =
                    name.chars().filter(|c| c.is_ascii_alphanumeric() || *c == '-').take(40).collect();
                let hash = fingerprint::hash(root.as_os_str().as_encoded_bytes());
                state.join("g7").join("drafts").join(format!("{plain}-{hash}"))
            }
            None => root.join(".g7").join("drafts"),
        };
        Drafts { folder, turn: Mutex::new(()) }
    }

    /// Stores a copy and replaces the previous one.
    pub(super) fn keep(&self, path: &str, text: String) -> Result<(), Refusal> {
        file_names::path(path).map_err(Refusal::bad)?;
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        let place = self.place(path);
        let draft = Draft { path: path.to_owned(), text };
        let bytes = serde_json::to_vec(&draft).map_err(|e| Refusal::bad(Said::foreign(e.to_string())))?;
        let others: Vec<u64> = self
            .entries()
            .filter(|p| *p != place)
            .filter_map(|p| Some(fs::metadata(p).ok()?.len()))
            .collect();
        if others.len() >= MOST || others.iter().sum::<u64>() + bytes.len() as u64 > LARGEST {
            let text = say!("there are too many unsaved copies: save or close a file");
            return Err(Refusal::new(StatusCode::INSUFFICIENT_STORAGE, text));
        }
        self.make_folder()
            .and_then(|()| g7_host::write_whole(&place, &bytes))
            .map_err(|e| Refusal::io(path, &e))
    }

    /// All copies, ordered by name.
    pub(super) fn list(&self) -> Vec<Draft> {
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        let readable = |p: PathBuf| serde_json::from_slice::<Draft>(&fs::read(p).ok()?).ok();
        let mut drafts: Vec<Draft> = self.entries().filter_map(readable).collect();
        drafts.retain(|d| file_names::path(&d.path).is_ok());
        drafts.sort_by(|a, b| a.path.cmp(&b.path));
        drafts
    }

    /// Deletes a copy.
    pub(super) fn drop(&self, path: &str) -> Result<(), Refusal> {
        file_names::path(path).map_err(Refusal::bad)?;
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        match fs::remove_file(self.place(path)) {
            Err(e) if e.kind() != io::ErrorKind::NotFound => Err(Refusal::io(path, &e)),
            _ => Ok(()),
        }
    }

    fn place(&self, path: &str) -> PathBuf {
        self.folder.join(format!("{}.json", fingerprint::hash(path.as_bytes())))
    }

    /// The copies on the disk, without the remains of an interrupted write.
    fn entries(&self) -> impl Iterator<Item = PathBuf> {
        let entries = fs::read_dir(&self.folder).into_iter().flatten();
        let paths = entries.filter_map(|e| Some(e.ok()?.path()));
        paths.filter(|p| {
            p.extension().is_some_and(|e| e == "json") && fs::symlink_metadata(p).is_ok_and(|m| m.is_file())
        })
    }

    /// The texts may be private: only their owner may read them.
    fn make_folder(&self) -> io::Result<()> {
        let mut builder = fs::DirBuilder::new();
        builder.recursive(true);
        #[cfg(unix)]
        {
            use std::os::unix::fs::DirBuilderExt as _;
            builder.mode(0o700);
        }
        builder.create(&self.folder)
    }
}

/// The system's place for data that programs keep.
pub(super) fn state_folder() -> Option<PathBuf> {
    let var = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|p| p.is_absolute());
    if let Some(state) = var("XDG_STATE_HOME") {
        return Some(state);
    }
    if cfg!(windows) {
        var("LOCALAPPDATA")
    } else if cfg!(target_os = "macos") {
        Some(var("HOME")?.join("Library").join("Application Support"))
    } else {
        Some(var("HOME")?.join(".local").join("state"))
    }
}
