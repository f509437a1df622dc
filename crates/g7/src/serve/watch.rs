//! Watches the files of the folder by reading it every half second, which works on every disk,
//! including network drives.
//!
//! The cost is bounded even for an endless folder. A change is announced once; a change by a client
//! is announced only after that client has its answer.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

use serde::Serialize;

use super::file_names;
use super::fingerprint;
use super::folder::Folder;

/// Greatest number of files in the list.
const FILES: usize = 5_000;
/// Greatest number of folder entries that are read.
const ENTRIES: usize = 50_000;
/// Number of times that a changed file is read again, because the disk's clock may be coarse.
const UNSURE: u8 = 3;

/// A file of the folder.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(super) struct Row {
    pub(super) path: String,
    pub(super) size: u64,
    pub(super) hash: String,
    /// The first sentence of its first note.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) title: Option<String>,
}

/// A change that is announced to clients; `hash` is empty if the file was deleted.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(super) struct Changed {
    pub(super) path: String,
    pub(super) hash: String,
}

#[derive(Clone, Debug)]
struct Seen {
    row: Row,
    written: Option<SystemTime>,
    unsure: u8,
}

/// The results of the latest search.
#[derive(Debug)]
pub(super) struct Watch {
    folder: Arc<Folder>,
    seen: Mutex<Found>,
}

#[derive(Debug, Default)]
struct Found {
    files: BTreeMap<String, Seen>,
    /// The hash of each file that clients were told last.
    told: BTreeMap<String, String>,
    /// Files that a client has just changed: they are announced at the search after the next.
    late: BTreeMap<String, u8>,
}

impl Watch {
    pub(super) fn new(folder: Arc<Folder>) -> Watch {
        let watch = Watch { folder, seen: Mutex::default() };
        watch.changes();
        watch
    }

    /// The files, by path.
    pub(super) fn rows(&self) -> Vec<Row> {
        let mut found = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        self.look(&mut found);
        found.files.values().map(|s| s.row.clone()).collect()
    }

    /// Delays the announcement of a change, so that the client that makes it is answered first.
    pub(super) fn put_off(&self, path: &str) {
        let mut found = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        found.late.insert(path.to_owned(), 2);
    }

    /// The changes since the last call.
    pub(super) fn changes(&self) -> Vec<Changed> {
        let mut found = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        self.look(&mut found);
        let Found { files, told, late } = &mut *found;
        late.retain(|_, looks| {
            *looks = looks.saturating_sub(1);
            *looks > 0
        });
        let mut changes = Vec::new();
        for (path, seen) in files.iter().filter(|(p, _)| !late.contains_key(*p)) {
            if told.get(path) != Some(&seen.row.hash) {
                told.insert(path.clone(), seen.row.hash.clone());
                changes.push(Changed { path: path.clone(), hash: seen.row.hash.clone() });
            }
        }
        told.retain(|path, _| {
            let stays = files.contains_key(path) || late.contains_key(path);
            if !stays {
                changes.push(Changed { path: path.clone(), hash: String::new() });
            }
            stays
        });
        changes
    }

    fn look(&self, found: &mut Found) {
        let mut walk = Walk { folder: &self.folder, old: &found.files, new: BTreeMap::new(), left: ENTRIES };
        walk.folder(self.folder.root(), "", 0);
        found.files = walk.new;
    }
}

/// One search of the folder.
struct Walk<'a> {
    folder: &'a Folder,
    old: &'a BTreeMap<String, Seen>,
    new: BTreeMap<String, Seen>,
    left: usize,
}

impl Walk<'_> {
    fn folder(&mut self, path: &Path, above: &str, depth: usize) {
        let Ok(entries) = fs::read_dir(path) else { return };
        for entry in entries.filter_map(Result::ok) {
            if self.left == 0 || self.new.len() >= FILES {
                return;
            }
            self.left -= 1;
            let name = entry.file_name();
            let Some(name) = name.to_str().filter(|n| file_names::fault(n).is_none()) else { continue };
            let Ok(kind) = entry.file_type() else { continue };
            let full = format!("{above}{name}");
            if kind.is_dir() {
                // Tools fill these folders with thousands of files, none of which is a chart.
                if depth + 1 < file_names::DEEPEST && name != "target" && name != "node_modules" {
                    self.folder(&entry.path(), &format!("{full}/"), depth + 1);
                }
            } else if file_names::is_served(name) {
                self.file(&entry.path(), full);
            }
        }
    }

    fn file(&mut self, path: &Path, name: String) {
        // Links are followed; a file outside the folder is not read.
        let Ok(meta) = fs::metadata(path) else { return };
        if !meta.is_file() {
            return;
        }
        let (size, written) = (meta.len(), meta.modified().ok());
        let old = self.old.get(&name);
        let same = old.filter(|o| written.is_some() && o.row.size == size && o.written == written);
        if let Some(seen) = same.filter(|o| o.unsure == 0) {
            self.new.insert(name, seen.clone());
            return;
        }
        let Ok(bytes) = self.folder.read(&name) else { return };
        let unsure = same.map_or(UNSURE, |o| o.unsure.saturating_sub(1));
        let row = Row {
            path: name.clone(),
            size: bytes.len() as u64,
            hash: fingerprint::hash(&bytes),
            title: title(&name, &bytes),
        };
        self.new.insert(name, Seen { row, written, unsure });
    }
}

/// The first sentence of the first note.
fn title(name: &str, bytes: &[u8]) -> Option<String> {
    if !name.to_ascii_lowercase().ends_with(".g7") {
        return None;
    }
    let head = String::from_utf8_lossy(bytes.get(..bytes.len().min(2_000))?).into_owned();
    let lines = head.lines().map(str::trim).take_while(|l| l.starts_with("//"));
    let note: Vec<&str> = lines.map(|l| l.trim_start_matches('/').trim()).collect();
    let note = note.join(" ");
    let end = note.match_indices(". ").next().map_or(note.len(), |(at, _)| at);
    let title: String = note.get(..end)?.trim_end_matches('.').chars().take(120).collect();
    (!title.is_empty()).then_some(title)
}
