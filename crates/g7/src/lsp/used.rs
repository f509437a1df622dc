//! The files that open texts use. A file that is open in the editor counts as it is there, any other one as it is on the
//! disk.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use g7_ide::{File, Texts};
use lsp_types::Uri;

use super::places;
use crate::used;

/// Most rounds: in each, the files that were read may use others.
const ROUNDS: usize = 1000;

/// The reason to read files for another one.
#[derive(Clone, Copy)]
pub(super) enum Why<'p> {
    /// The editor has opened or saved it: all files are read.
    Fresh,
    /// Somebody types in it: only what was not read yet is.
    Typed,
    /// This file has changed in the editor: it alone is read.
    Changed(&'p Path),
}

/// Gives a file the texts of those that it uses. `open` gives the text of a file that is open in the editor.
pub(super) fn lend(file: &mut File, uri: &Uri, why: Why<'_>, open: &dyn Fn(&Path) -> Option<String>) {
    let Some(folder) = folder(uri).filter(|_| !file.uses.is_empty()) else { return };
    let path = |name: &str| used::plain(&folder.join(name));
    let stays = |name: &str| match why {
        Why::Fresh => false,
        Why::Typed => true,
        Why::Changed(changed) => path(name) != changed,
    };
    let mut known: Texts = file
        .lent()
        .filter(|(name, _)| stays(name))
        .map(|(name, text)| (name.clone(), text.clone()))
        .collect();
    for _ in 0..ROUNDS {
        for name in &file.uses {
            let read = || open(&path(name)).or_else(|| on_disk(&folder, name)).map(Arc::from);
            known.entry(name.clone()).or_insert_with(read);
        }
        if !file.lend(known.clone()) {
            return;
        }
    }
}

/// The paths of the files that a file uses.
pub(super) fn paths(file: &File, uri: &Uri) -> Vec<PathBuf> {
    let folder = folder(uri);
    let path = |name: &String| Some(used::plain(&folder.as_ref()?.join(name)));
    file.uses.iter().filter_map(path).collect()
}

fn folder(uri: &Uri) -> Option<PathBuf> {
    Some(places::path(uri)?.parent()?.to_path_buf())
}

/// The text of a file on the disk by its path from a folder, if a chart of the folder may read it.
pub(super) fn on_disk(folder: &Path, name: &str) -> Option<String> {
    let folder = folder.canonicalize().ok()?;
    let bytes = used::within(&used::root(&folder).ok()?, &folder.join(name)).ok()?;
    String::from_utf8(bytes).ok()
}
