//! Reads the files that a chart uses from its project folder, and from nowhere else.
//!
//! The folder is the nearest one above the chart that holds a project file, `g7.toml`; where there is none, that of
//! the chart. A link that leads out of it is not followed.

use std::fs;
use std::path::{Component, Path, PathBuf};

use g7_model::{Said, say};
use g7_rig::Source;

use crate::failure::raw;
use crate::files;
use crate::project::{self, Project};

/// Links a chart to the files that it uses.
pub(crate) fn link(source: &mut Source, path: &Path) {
    let path = if path == Path::new("-") { Path::new("") } else { path };
    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_path_buf());
    let root = root(&folder);
    source.link(&mut |used| within(root.as_deref().map_err(Clone::clone)?, &folder.join(used)));
}

/// The folder of the project to which a folder belongs.
///
/// # Errors
///
/// The project file has a mistake.
pub(crate) fn root(folder: &Path) -> Result<PathBuf, Said> {
    let whole = folder.canonicalize().unwrap_or_else(|_| folder.to_path_buf());
    let Some(project) = whole.ancestors().find(|f| f.join(project::FILE).is_file()) else { return Ok(whole) };
    Project::of(project)?;
    Ok(project.to_path_buf())
}

/// The bytes of a file that lies in a folder.
pub(crate) fn within(root: &Path, path: &Path) -> Result<Vec<u8>, Said> {
    let told = |e: &std::io::Error| match e.kind() {
        std::io::ErrorKind::NotFound => say!("there is no such file"),
        _ => raw(e),
    };
    let outside = || {
        let folder = raw(root.display());
        say!("it lies outside of the folder {folder}; a file `g7.toml` marks the folder of a project")
    };
    // Before the system is asked, so that a chart learns nothing of what lies elsewhere.
    if !plain(path).starts_with(root) {
        return Err(outside());
    }
    let whole = path.canonicalize().map_err(|e| told(&e))?;
    if !whole.starts_with(root) {
        return Err(outside());
    }
    // A pipe or a device could keep the reader waiting.
    if !fs::metadata(&whole).map_err(|e| told(&e))?.is_file() {
        return Err(say!("it is no file"));
    }
    files::read(&whole).map_err(raw)
}

/// A path without `.` and `..` in it.
pub(crate) fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => _ = plain.pop(),
            Component::CurDir => {}
            part => plain.push(part),
        }
    }
    plain
}
