//! The files of the repository, for the tests that read them.
#![allow(clippy::disallowed_methods, reason = "it reads the sources")]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// The root of the repository.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The files of the repository, relative to its root: those git knows, or all
/// where there is no git (an unpacked archive).
///
/// # Panics
///
/// If git or the folder cannot be read.
pub fn files() -> Vec<PathBuf> {
    let listed = std::process::Command::new("git").args(["ls-files", "-z"]).current_dir(root()).output();
    let mut files: Vec<PathBuf> = match listed {
        Ok(out) if out.status.success() && !out.stdout.is_empty() => {
            out.stdout.split(|b| *b == 0).map(|p| PathBuf::from(&*String::from_utf8_lossy(p))).collect()
        }
        _ => {
            let mut all = Vec::new();
            walk(&root(), &mut all);
            all.iter().filter_map(|p| p.strip_prefix(root()).ok().map(Path::to_path_buf)).collect()
        }
    };
    // One that was deleted a moment ago is still listed.
    files.retain(|f| root().join(f).is_file());
    assert!(files.len() > 100, "only {} files found", files.len());
    files
}

fn walk(folder: &Path, all: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() && !name.starts_with('.') && name != "target" && name != "node_modules" {
            walk(&path, all);
        } else if path.is_file() {
            all.push(path);
        }
    }
}

/// True if a file name ends in one of these extensions.
pub fn ends_in(file: &Path, endings: &[&str]) -> bool {
    file.extension().is_some_and(|e| endings.iter().any(|x| e == *x))
}

/// The text of a file, by its path from the root.
///
/// # Panics
///
/// If it cannot be read.
pub fn read(file: impl AsRef<Path>) -> String {
    let path = root().join(file.as_ref());
    let bytes = std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Fails with everything found, not only the first.
///
/// # Panics
///
/// If anything was found.
pub fn none(found: &[String], rule: &str) {
    let mut text = String::new();
    found.iter().for_each(|f| {
        let _ = writeln!(text, "  {f}");
    });
    assert!(found.is_empty(), "{rule}:\n{text}");
}
