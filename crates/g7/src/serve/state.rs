//! The system's place for what the server keeps of a folder: unsaved copies, and the tokens of its pages. It lies
//! outside the folder, so that nothing of it is shared with the charts.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::fingerprint;

/// The system's place for data that programs keep.
pub(super) fn folder() -> Option<PathBuf> {
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

/// A name for a folder by its whole path, which tells folders apart that are named alike.
pub(super) fn name_of(root: &Path) -> String {
    let name = root.file_name().unwrap_or_default().to_string_lossy();
    let plain: String = name.chars().filter(|c| c.is_ascii_alphanumeric() || *c == '-').take(40).collect();
    format!("{plain}-{}", fingerprint::hash(root.as_os_str().as_encoded_bytes()))
}

/// Makes a folder that only its owner may read: what is in it may be private.
pub(super) fn make(folder: &Path) -> io::Result<()> {
    let mut builder = fs::DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::DirBuilderExt as _;
        builder.mode(0o700);
    }
    builder.create(folder)
}

/// True if a folder is no link, and if only its owner may read and change it. On a system without such modes any folder
/// counts: the rights of the user's own place protect it.
pub(super) fn is_private(folder: &Path) -> bool {
    let Ok(meta) = fs::symlink_metadata(folder) else { return false };
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        meta.is_dir() && meta.permissions().mode() & 0o077 == 0
    }
    #[cfg(not(unix))]
    meta.is_dir()
}
