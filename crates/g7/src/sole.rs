//! The lock of a file that one controller alone writes: its retained values, its history, its events. A server
//! shows by such a lock that it is there.
//!
//! Two controllers would overwrite each other's values without noticing it. The lock is one of the system on a file
//! beside the file, so it ends with the process, however that ends; the empty file stays.

use std::ffi::OsString;
use std::fs::{File, OpenOptions, TryLockError};
use std::path::{Path, PathBuf};

use g7_model::{Said, say};

use crate::failure::{Failure, plain, raw};

/// A file that no other controller can use as long as this lives.
#[derive(Debug)]
pub(crate) struct Sole {
    _lock: File,
}

/// Takes a file for this controller.
///
/// # Errors
///
/// Another controller uses it, or no file can be made beside it.
pub(crate) fn claim(path: &Path) -> Result<Sole, Failure> {
    let beside = beside(path);
    let cannot = |why: Said| Failure::Usage(say!("cannot use {}: {why}", raw(path.display())));
    let lock = OpenOptions::new().create(true).truncate(false).write(true).open(&beside);
    let lock = lock.map_err(|e| cannot(say!("{} cannot be made: {}", raw(beside.display()), plain(&e))))?;
    match lock.try_lock() {
        Ok(()) => Ok(Sole { _lock: lock }),
        Err(TryLockError::WouldBlock) => Err(cannot(say!(
            "another controller uses it; stop that one, or name another file in the io file"
        ))),
        Err(TryLockError::Error(e)) => Err(cannot(say!("it cannot be locked: {}", plain(&e)))),
    }
}

/// True while a program holds the lock of a file.
pub(crate) fn is_taken(path: &Path) -> bool {
    let lock = File::open(beside(path));
    lock.is_ok_and(|lock| matches!(lock.try_lock(), Err(TryLockError::WouldBlock)))
}

/// The path of the lock of a file.
pub(crate) fn beside(path: &Path) -> PathBuf {
    let mut name = path.file_name().map_or_else(OsString::new, OsString::from);
    name.push(".lock");
    path.with_file_name(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_taken_once_and_free_again_afterwards() {
        let path = std::env::temp_dir().join(format!("g7-sole-{}", std::process::id()));
        let first = claim(&path).expect("nobody has it");
        let second = claim(&path).expect_err("the first has it");
        assert!(second.to_string().contains("another controller uses it"), "{second}");
        assert!(is_taken(&path));
        drop(first);
        assert!(!is_taken(&path));
        claim(&path).expect("it is free again");
        std::fs::remove_file(beside(&path)).expect("it was made");
    }
}
