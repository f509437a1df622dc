//! The folder that clients read and write: files by name, completely or not at all.
//!
//! Nothing outside the folder is read or written, not even through a link; a file that differs from
//! what the client knows is never replaced.

use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use axum::http::StatusCode;
use g7_model::say;

use super::file_names;
use super::fingerprint;
use super::refusal::Refusal;

/// Greatest size of a file that is read or written, in bytes.
pub(super) const LARGEST: usize = 8 << 20;

/// The folder.
#[derive(Debug)]
pub(super) struct Folder {
    /// The canonical path, so that paths below it can be recognized.
    root: PathBuf,
    read_only: bool,
    /// Only one change at a time: between the check and the write no other request writes.
    turn: Mutex<()>,
}

/// The required state of a file before it is replaced.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Wanted {
    /// It does not exist.
    Absent,
    /// It exists and has this hash.
    Hash(String),
    /// It exists.
    Any,
}

/// The result of a write.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Written {
    /// The file was written and has this hash.
    Done(String),
    /// The file has changed: its present bytes, or `None` if it no longer exists.
    Other(Option<Vec<u8>>),
}

impl Folder {
    pub(super) fn new(root: &Path, read_only: bool) -> io::Result<Folder> {
        Ok(Folder { root: fs::canonicalize(root)?, read_only, turn: Mutex::new(()) })
    }

    pub(super) fn root(&self) -> &Path {
        &self.root
    }

    pub(super) fn is_read_only(&self) -> bool {
        self.read_only
    }

    /// The bytes of a file.
    pub(super) fn read(&self, name: &str) -> Result<Vec<u8>, Refusal> {
        let path = self.place(name)?;
        self.bytes(&path, name)?.ok_or_else(|| Refusal::io(name, &io::ErrorKind::NotFound.into()))
    }

    /// Replaces or creates a file.
    pub(super) fn write(&self, name: &str, bytes: &[u8], wanted: &Wanted) -> Result<Written, Refusal> {
        let _turn = self.change()?;
        let path = self.place(name)?;
        let present = self.bytes(&path, name)?;
        let fits = match (wanted, &present) {
            (Wanted::Absent, None) | (Wanted::Any, Some(_)) => true,
            (Wanted::Hash(hash), Some(bytes)) => *hash == fingerprint::hash(bytes),
            (Wanted::Absent, Some(_)) | (Wanted::Hash(_) | Wanted::Any, None) => false,
        };
        if !fits {
            return Ok(Written::Other(present));
        }
        self.make_folders(&path, name)?;
        g7_host::write_whole(&path, bytes).map_err(|e| Refusal::io(name, &e))?;
        Ok(Written::Done(fingerprint::hash(bytes)))
    }

    /// Renames a file; the new name must be free.
    pub(super) fn rename(&self, from: &str, to: &str) -> Result<(), Refusal> {
        let _turn = self.change()?;
        let (old, new) = (self.place(from)?, self.place(to)?);
        if self.bytes(&old, from)?.is_none() {
            return Err(Refusal::io(from, &io::ErrorKind::NotFound.into()));
        }
        self.make_folders(&new, to)?;
        // Creating a link fails if the new name is taken, at any moment; a rename would replace
        // that file.
        match fs::hard_link(&old, &new) {
            Ok(()) => fs::remove_file(&old).map_err(|e| Refusal::io(from, &e)),
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => Err(Refusal::io(to, &e)),
            Err(_) if fs::symlink_metadata(&new).is_ok() => {
                Err(Refusal::io(to, &io::ErrorKind::AlreadyExists.into()))
            }
            Err(_) => fs::rename(&old, &new).map_err(|e| Refusal::io(from, &e)),
        }
    }

    /// Deletes a file; if a hash is given, only a file with that hash.
    pub(super) fn delete(&self, name: &str, hash: Option<&str>) -> Result<(), Refusal> {
        let _turn = self.change()?;
        let path = self.place(name)?;
        let present = self.bytes(&path, name)?;
        let present = present.ok_or_else(|| Refusal::io(name, &io::ErrorKind::NotFound.into()))?;
        if hash.is_some_and(|h| h != fingerprint::hash(&present)) {
            let text = say!("`{name}` was changed outside; it is left as it is");
            return Err(Refusal::new(StatusCode::PRECONDITION_FAILED, text));
        }
        fs::remove_file(&path).map_err(|e| Refusal::io(name, &e))
    }

    /// Takes the lock for a change; refuses if the folder is read-only.
    fn change(&self) -> Result<MutexGuard<'_, ()>, Refusal> {
        if self.read_only {
            return Err(Refusal::read_only());
        }
        Ok(self.turn.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// The path of an existing or new file: inside the folder, with links resolved.
    fn place(&self, name: &str) -> Result<PathBuf, Refusal> {
        let path = self.root.join(file_names::path(name).map_err(Refusal::bad)?);
        let outside =
            || Refusal::forbidden(say!("`{name}` is or goes through a link that leads out of the folder"));
        match fs::canonicalize(&path) {
            Ok(real) if real.starts_with(&self.root) => return Ok(real),
            Ok(_) => return Err(outside()),
            Err(e) if e.kind() == io::ErrorKind::NotFound => {}
            Err(e) => return Err(Refusal::io(name, &e)),
        }
        // A link to a missing file looks absent, but a write through it would create the file
        // elsewhere.
        let mut above = path.as_path();
        loop {
            if fs::symlink_metadata(above).is_ok_and(|m| m.is_symlink()) {
                return Err(outside());
            }
            let Some(parent) = above.parent() else { return Err(outside()) };
            above = parent;
            match fs::canonicalize(above) {
                Ok(real) if real.starts_with(&self.root) => {
                    let rest = path.strip_prefix(above).map_err(|_| outside())?;
                    return Ok(real.join(rest));
                }
                Ok(_) => return Err(outside()),
                Err(e) if e.kind() == io::ErrorKind::NotFound => {}
                Err(e) => return Err(Refusal::io(name, &e)),
            }
        }
    }

    /// The bytes of a file; `None` if there is no file.
    fn bytes(&self, path: &Path, name: &str) -> Result<Option<Vec<u8>>, Refusal> {
        let meta = match fs::metadata(path) {
            Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(None),
            other => other.map_err(|e| Refusal::io(name, &e))?,
        };
        // Opening a pipe or a device might block or have an effect.
        if !meta.is_file() {
            return Err(Refusal::forbidden(say!("`{name}` is not a regular file")));
        }
        let too_large = || {
            let text = say!("`{name}` is larger than {} MB: the editor does not open it", LARGEST >> 20);
            Refusal::new(StatusCode::PAYLOAD_TOO_LARGE, text)
        };
        if meta.len() > LARGEST as u64 {
            return Err(too_large());
        }
        let mut bytes = Vec::new();
        fs::File::open(path)
            .and_then(|f| f.take(LARGEST as u64 + 1).read_to_end(&mut bytes))
            .map_err(|e| Refusal::io(name, &e))?;
        if bytes.len() > LARGEST { Err(too_large()) } else { Ok(Some(bytes)) }
    }

    fn make_folders(&self, path: &Path, name: &str) -> Result<(), Refusal> {
        let Some(folder) = path.parent() else { return Ok(()) };
        fs::create_dir_all(folder).map_err(|e| Refusal::io(name, &e))
    }
}
