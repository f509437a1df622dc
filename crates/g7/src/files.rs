//! Finds, reads and writes the files that the arguments name; a file is written completely or not
//! at all.

use std::collections::HashSet;
use std::fs;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use g7_model::say;

use crate::failure::{Failure, raw};
use crate::message::wrote;
use crate::project::Project;

/// Longest file that is read; the parser's own limit is lower.
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

/// Replaces a file, completely or not at all.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    g7_host::write_whole(path, bytes).map_err(|e| Failure::Write(path.to_path_buf(), e))
}

/// Marks in the files that commands write again and again: pictures, records, reports. A file with one of
/// these is replaced unasked.
const OURS: [&[u8]; 11] = [
    b"<g class=\"g7\">",
    b"<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"g7-graph\"",
    b"<mxfile host=\"g7\">",
    b"$version g7 $end",
    b"g7 tape ",
    b"<testsuites name=\"g7",
    b"tEXtSoftware\0g7",
    b"digraph situations {",
    b"\"tool\": \"g7 graph\"",
    b"\"tool\": \"g7 grade\"",
    GRADES.as_bytes(),
];
/// The first columns of the table of `g7 grade`.
pub(crate) const GRADES: &str = "submission,result,tests passed,";
/// The beginning of a trace.
const TRACE: &[u8] = b"time,";
/// The end of a PDF that G7 wrote; readers of PDF take it as a comment.
pub(crate) const PDF_MARK: &[u8] = b"\n%g7\n";

/// True if a file is empty or was written by one of the commands.
fn is_ours(path: &Path) -> bool {
    let Ok(bytes) = fs::read(path) else { return false };
    // The font of a picture may stand before its mark.
    let has = |mark: &[u8]| bytes.windows(mark.len()).any(|part| part == mark);
    let begins = bytes.starts_with(TRACE) || bytes.ends_with(PDF_MARK);
    bytes.is_empty() || begins || OURS.into_iter().any(has)
}

/// True if two names are of one file.
pub(crate) fn is_same(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

/// Refuses an output that would replace the file it is made of, even with `force`; and without it one that
/// would replace what none of the commands wrote.
pub(crate) fn refuse_foreign(output: Option<&Path>, from: &[&Path], force: bool) -> Result<(), Failure> {
    let Some(output) = output else { return Ok(()) };
    refuse_source(Some(output), from)?;
    if output.is_file() && !force && !is_ours(output) {
        let name = output.display();
        return Err(Failure::Usage(say!(
            "{name} is there, and g7 did not write it; --force replaces it",
            name = raw(&name)
        )));
    }
    Ok(())
}

/// Refuses an output that would replace the file it is made of.
pub(crate) fn refuse_source(output: Option<&Path>, from: &[&Path]) -> Result<(), Failure> {
    let Some(output) = output else { return Ok(()) };
    match from.iter().find(|from| is_same(output, from)) {
        Some(from) => Err(Failure::Usage(say!(
            "{} is {} itself, which the output is made of; nothing was changed",
            raw(output.display()),
            raw(from.display())
        ))),
        None => Ok(()),
    }
}

/// Refuses to overwrite an existing output file without `force`.
pub(crate) fn refuse_present(output: Option<&Path>, force: bool) -> Result<(), Failure> {
    match output.filter(|o| o.is_file() && !force) {
        Some(o) => Err(Failure::Usage(say!("{} already exists; --force replaces it", raw(o.display())))),
        None => Ok(()),
    }
}

/// Writes data to a file, completely or not at all, or to the standard output.
pub(crate) fn deliver(output: Option<&Path>, bytes: &[u8]) -> Result<(), Failure> {
    match output {
        Some(path) => {
            write(path, bytes)?;
            wrote(path.display());
        }
        None => {
            // The bytes are written unchanged, because they may be a picture.
            let mut out = io::stdout().lock();
            out.write_all(bytes)?;
            out.flush()?;
        }
    }
    Ok(())
}

/// The file to run. A file is taken as it is. In a folder it is the first of these that exists:
/// the chart that the project file names; `chart.g7`; the only .g7 file; in the folders below, the only `chart.g7`, or the
/// only .g7 file.
pub(crate) fn one(path: &Path) -> Result<PathBuf, Failure> {
    let folder = match fs::metadata(path) {
        _ if path == Path::new("-") => return Ok(path.to_path_buf()),
        Ok(meta) => meta.is_dir(),
        Err(e) => return Err(Failure::Read(path.to_path_buf(), e)),
    };
    if !folder {
        return Ok(path.to_path_buf());
    }
    let project = Project::of(path).and_then(|p| p.map_or(Ok(None), |p| p.main(path)));
    if let Some(main) = project.map_err(Failure::Usage)? {
        return Ok(path.join(main));
    }
    let chart = path.join("chart.g7");
    if chart.is_file() {
        return Ok(chart);
    }
    let mut found: Vec<PathBuf> = list(path)?.into_iter().filter(|p| p.is_file() && is_chart(p)).collect();
    if found.is_empty() {
        walk(path, &mut found, 0)?;
        let called: Vec<&PathBuf> = found.iter().filter(|p| p.ends_with("chart.g7")).collect();
        if let [only] = called.as_slice() {
            return Ok((*only).clone());
        }
    }
    match found.len() {
        1 => Ok(found.remove(0)),
        0 => Err(Failure::Usage(say!("{} has no .g7 file; `g7 new` makes one", raw(path.display())))),
        n => Err(Failure::Usage(say!(
            "{} has {n} .g7 files and none of its own is called chart.g7: name the one you mean, as in {}",
            raw(path.display()),
            raw(found.first().map_or(path, |p| p).display())
        ))),
    }
}

/// All charts: files as given, and all charts in folders and below; each once, at its first place.
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
            return Err(Failure::Usage(say!("{} has no .g7 file", raw(path.display()))));
        }
    }
    let mut seen = HashSet::new();
    found.retain(|path| {
        let one =
            if path == Path::new("-") { path.clone() } else { path.canonicalize().unwrap_or(path.clone()) };
        seen.insert(one)
    });
    Ok(found)
}

/// Greatest depth of folders that are searched.
const DEEPEST: u32 = 32;

fn walk(folder: &Path, found: &mut Vec<PathBuf>, depth: u32) -> Result<(), Failure> {
    for path in list(folder)? {
        match met(&path) {
            Met::Folder if depth < DEEPEST => walk(&path, found, depth + 1)?,
            Met::Chart => found.push(path),
            Met::Folder | Met::Other => {}
        }
    }
    Ok(())
}

/// The kinds of entries of a folder in which charts are looked for.
pub(crate) enum Met {
    /// A folder to look into.
    Folder,
    /// A .g7 file.
    Chart,
    /// Anything else.
    Other,
}

/// Tells what a search for charts does with an entry of a folder.
pub(crate) fn met(path: &Path) -> Met {
    let hidden = path.file_name().is_some_and(|n| n.to_string_lossy().starts_with('.'));
    // A link to a folder is not followed, because it may lead back here.
    if fs::symlink_metadata(path).is_ok_and(|m| m.is_dir()) {
        return if hidden { Met::Other } else { Met::Folder };
    }
    if is_chart(path) && path.is_file() { Met::Chart } else { Met::Other }
}

/// The entries of a folder, by their names.
pub(crate) fn list(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let fail = |e| Failure::Read(folder.to_path_buf(), e);
    let entries: io::Result<Vec<_>> = fs::read_dir(folder).map_err(fail)?.collect();
    let mut paths: Vec<PathBuf> = entries.map_err(fail)?.iter().map(fs::DirEntry::path).collect();
    paths.sort();
    Ok(paths)
}

/// True for a name of a .g7 file.
pub(crate) fn is_chart(path: &Path) -> bool {
    path.extension().is_some_and(|e| e == "g7")
}
