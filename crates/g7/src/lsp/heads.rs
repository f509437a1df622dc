//! The files of a project that can name what a file declares: for a new name.
//!
//! These are the .g7 files of the project folder; where no project file marks it, those of the folder of the chart and below.
//! Files that the editor has open and that use the file count as well, wherever they lie. The text in the editor counts
//! before that on the disk.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use g7_ide::File;
use g7_model::{Said, say};
use g7_rig::Source;
use lsp_types::Uri;

use super::open::Open;
use super::places;
use crate::failure::raw;
use crate::files::{self, Met};
use crate::used;

/// Most entries of folders that are looked at.
const MOST: usize = 20_000;

/// The files of a project.
pub(super) struct Heads<'o> {
    /// Those that use others, and the one that was asked for, which comes first. Each is linked to the files that it uses, and
    /// its name is its path.
    pub(super) sources: Vec<Source>,
    /// The open files by their paths without links.
    open: BTreeMap<PathBuf, (&'o Uri, &'o File)>,
}

impl Heads<'_> {
    /// All heads of the project of a file.
    pub(super) fn of<'o>(open: &'o Open, uri: &Uri) -> Result<Heads<'o>, Said> {
        let known = open.all().filter_map(|(uri, file)| Some((real(&places::path(uri)?)?, (uri, file))));
        let mut heads = Heads { sources: Vec::new(), open: known.collect() };
        let Some(own) = places::path(uri).and_then(|path| real(&path)) else { return Ok(heads) };
        let mut paths: BTreeSet<PathBuf> = heads.open.keys().cloned().collect();
        if let Some(root) = own.parent().and_then(|folder| used::root(folder).ok()) {
            charts(&root, &mut paths)?;
        }
        paths.remove(&own);
        let others = paths.iter().filter_map(|path| heads.head(path, false));
        heads.sources = heads.head(&own, true).into_iter().chain(others).collect();
        Ok(heads)
    }

    /// The address of a file by its name here: that which the editor has for it, if it is open.
    pub(super) fn address(&self, name: &str) -> Option<Uri> {
        let path = Path::new(name);
        self.open.get(path).map(|(uri, _)| (*uri).clone()).or_else(|| places::uri(path))
    }

    /// A file with what it uses; `None` if it cannot be read, or if it uses nothing and is not the one that is asked for.
    fn head(&self, path: &Path, always: bool) -> Option<Source> {
        let folder = path.parent()?;
        let text = self.text(folder, path.file_name()?.to_str()?)?;
        // Most files of a large folder use nothing and need not be parsed.
        if !always && !text.contains("use ") {
            return None;
        }
        let mut source = Source::native(&name(path), text.into_bytes(), 0);
        source.link(&mut |used| {
            let text = self.text(folder, used).map(String::into_bytes);
            text.ok_or_else(|| say!("there is no such file"))
        });
        Some(source)
    }

    /// The text of a file by its path from a folder: as the editor has it, else as the disk has it if a chart of the folder
    /// may read it.
    fn text(&self, folder: &Path, name: &str) -> Option<String> {
        let open = real(&used::plain(&folder.join(name))).and_then(|path| self.open.get(&path));
        open.map(|(_, file)| file.text().to_owned()).or_else(|| super::used::on_disk(folder, name))
    }
}

/// The path of a file without links to its folder.
fn real(path: &Path) -> Option<PathBuf> {
    Some(path.parent()?.canonicalize().ok()?.join(path.file_name()?))
}

/// The name of a file for messages and for the paths of those that it uses: its path with `/` between the parts.
fn name(path: &Path) -> String {
    path.to_string_lossy().replace('\\', "/")
}

/// The .g7 files of a folder and below.
fn charts(root: &Path, found: &mut BTreeSet<PathBuf>) -> Result<(), Said> {
    let mut folders = vec![root.to_path_buf()];
    let mut left = MOST;
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).into_iter().flatten().flatten() {
            let Some(rest) = left.checked_sub(1) else {
                let folder = raw(root.display());
                return Err(say!(
                    "{folder} has too many files to look for the name in them; a file `g7.toml` marks the folder of a project"
                ));
            };
            left = rest;
            let path = entry.path();
            match files::met(&path) {
                Met::Folder => folders.push(path),
                Met::Chart => _ = found.insert(path),
                Met::Other => {}
            }
        }
    }
    Ok(())
}
