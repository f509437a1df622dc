//! A folder for files that one command needs while it runs: sources to compile, an unpacked FMU.

use std::path::{Path, PathBuf};

use g7_model::say;

use crate::failure::{Failure, raw};

/// The folder, with all that is in it. It is deleted at the end.
pub(crate) struct Scratch(PathBuf);

impl Scratch {
    /// Makes an empty folder, which nobody else uses, among the temporary files.
    ///
    /// # Errors
    ///
    /// The system gives no random numbers, or the folder cannot be made.
    pub(crate) fn new() -> Result<Scratch, Failure> {
        let mut bytes = [0; 8];
        getrandom::fill(&mut bytes)
            .map_err(|e| Failure::Usage(say!("no random numbers: {e}", e = raw(e))))?;
        let folder = std::env::temp_dir().join(format!("g7-{:016x}", u64::from_le_bytes(bytes)));
        std::fs::create_dir(&folder).map_err(|e| Failure::Write(folder.clone(), e))?;
        Ok(Scratch(folder))
    }

    /// Where it is.
    pub(crate) fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // If this fails, the folder stays: it is one of the temporary files, which the system deletes some day.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
