//! From arguments to files: folders, the standard input, whole writes.

use std::fs;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use crate::failure::Failure;
use crate::{style, talk};

/// Longest file read; the parser's own limit is below it.
const LONGEST: u64 = 64 << 20;

/// The bytes of a file, or of the standard input for `-`.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    let fail = |e| Failure::Read(path.to_path_buf(), e);
    let mut bytes = Vec::new();
    if path == Path::new("-") {
        io::stdin().lock().take(LONGEST + 1).read_to_end(&mut bytes).map_err(fail)?;
    } else {
        if fs::metadata(path).map_err(fail)?.is_dir() {
            return Err(fail(io::ErrorKind::IsADirectory.into()));
        }
        fs::File::open(path).and_then(|f| f.take(LONGEST + 1).read_to_end(&mut bytes)).map_err(fail)?;
    }
    if bytes.len() as u64 > LONGEST {
        return Err(fail(io::Error::other(format!("longer than {} MiB", LONGEST >> 20))));
    }
    Ok(bytes)
}

/// Replaces a file, whole or not at all.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    g7_host::write_whole(path, bytes).map_err(|e| Failure::Write(path.to_path_buf(), e))
}

/// Says no where an output file is there and may not be replaced.
pub(crate) fn refuse_present(output: Option<&Path>, force: bool) -> Result<(), Failure> {
    match output.filter(|o| o.is_file() && !force) {
        Some(o) => Err(Failure::Usage(format!("{} is there already; --force replaces it", o.display()))),
        None => Ok(()),
    }
}

/// Data to a file, whole or not at all, or to the standard output.
pub(crate) fn deliver(output: Option<&Path>, bytes: &[u8]) -> Result<(), Failure> {
    match output {
        Some(path) => {
            write(path, bytes)?;
            talk!("{}wrote{:#} {}", style::GOOD, style::GOOD, path.display());
        }
        None => {
            // As they are: these may be a picture.
            let mut out = io::stdout().lock();
            out.write_all(bytes)?;
            out.flush()?;
        }
    }
    Ok(())
}

/// The one chart to run: a file, or a folder's `chart.g7` or only `.g7` file.
pub(crate) fn one(path: &Path) -> Result<PathBuf, Failure> {
    let folder = match fs::metadata(path) {
        _ if path == Path::new("-") => return Ok(path.to_path_buf()),
        Ok(meta) => meta.is_dir(),
        Err(e) => return Err(Failure::Read(path.to_path_buf(), e)),
    };
    if !folder {
        return Ok(path.to_path_buf());
    }
    let chart = path.join("chart.g7");
    if chart.is_file() {
        return Ok(chart);
    }
    let mut found: Vec<PathBuf> = list(path)?.into_iter().filter(|p| p.is_file() && is_chart(p)).collect();
    match found.len() {
        1 => Ok(found.remove(0)),
        0 => Err(Failure::Usage(format!("{} has no .g7 file; `g7 new` makes one", path.display()))),
        n => Err(Failure::Usage(format!(
            "{} has {n} .g7 files and none is called chart.g7: name the one you mean",
            path.display()
        ))),
    }
}

/// Every chart meant: files as given, folders with all that is in and below them.
pub(crate) fn all(paths: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
    let mut found = Vec::new();
    for path in paths {
        if path == Path::new("-") {
            found.push(path.clone());
            continue;
        }
        let meta = fs::metadata(path).map_err(|e| Failure::Read(path.clone(), e))?;
        if !meta.is_dir() {
            found.push(path.clone());
            continue;
        }
        let before = found.len();
        walk(path, &mut found, 0)?;
        if found.len() == before {
            return Err(Failure::Usage(format!("{} has no .g7 file", path.display())));
        }
    }
    Ok(found)
}

/// Deepest folder looked into.
const DEEPEST: u32 = 32;

fn walk(folder: &Path, found: &mut Vec<PathBuf>, depth: u32) -> Result<(), Failure> {
    for path in list(folder)? {
        let hidden = path.file_name().is_some_and(|n| n.to_string_lossy().starts_with('.'));
        // A link to a folder is not followed: it may lead back here.
        let folder = fs::symlink_metadata(&path).is_ok_and(|m| m.is_dir());
        if folder && !hidden && depth < DEEPEST {
            walk(&path, found, depth + 1)?;
        } else if is_chart(&path) && path.is_file() {
            found.push(path);
        }
    }
    Ok(())
}

fn list(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let fail = |e| Failure::Read(folder.to_path_buf(), e);
    let entries: io::Result<Vec<_>> = fs::read_dir(folder).map_err(fail)?.collect();
    let mut paths: Vec<PathBuf> = entries.map_err(fail)?.iter().map(fs::DirEntry::path).collect();
    paths.sort();
    Ok(paths)
}

fn is_chart(path: &Path) -> bool {
    path.extension().is_some_and(|e| e == "g7")
}
