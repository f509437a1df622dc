//! The files that open texts use: those that the editor has open as they are there, others from the disk.

use std::path::Path;
use std::str::FromStr;
use std::sync::Arc;

use g7_ide::{File, Texts};
use lsp_types::Uri;

use super::places;
use crate::used;

/// Most rounds in which a file shows others that it uses.
const ROUNDS: usize = 1000;

/// Lends a file the texts of those that it uses. `open` gives the text of a file that is open.
pub(super) fn lend(file: &mut File, uri: &Uri, open: &dyn Fn(&Uri) -> Option<String>) {
    if file.uses.is_empty() {
        return;
    }
    let folder = places::path(uri).and_then(|p| p.parent()?.canonicalize().ok());
    let root = folder.as_deref().and_then(|folder| used::root(folder).ok());
    let read = |name: &str| -> Option<Arc<str>> {
        let path = folder.as_ref()?.join(name);
        if let Some(text) = address(&path).and_then(|uri| open(&uri)) {
            return Some(text.into());
        }
        let bytes = used::within(root.as_ref()?, &path).ok()?;
        String::from_utf8(bytes).ok().map(Arc::from)
    };
    for _ in 0..ROUNDS {
        let texts: Texts = file.uses.iter().map(|name| (name.clone(), read(name))).collect();
        if !file.lend(&Arc::new(texts)) {
            return;
        }
    }
}

/// The address of a file that another one uses, by its name there.
pub(super) fn beside(uri: &Uri, name: &str) -> Option<Uri> {
    address(&places::path(uri)?.parent()?.join(name))
}

/// The address of a path, without `..` in it.
fn address(path: &Path) -> Option<Uri> {
    let uri = crate::sarif::artifact(used::plain(path).to_str()?);
    Uri::from_str(uri["uri"].as_str()?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_comes_back_from_its_address() {
        let there = Path::new("/plant/é x/a%b.g7");
        let uri = address(there).expect("it is UTF-8");
        assert_eq!(uri.as_str(), "file:///plant/%C3%A9%20x/a%25b.g7");
        assert_eq!(places::path(&uri).as_deref(), Some(there));
        assert_eq!(beside(&uri, "../b.g7").expect("it is there").as_str(), "file:///plant/b.g7");
        let untitled = Uri::from_str("untitled:a").expect("an address");
        assert_eq!(places::path(&untitled), None);
    }
}
