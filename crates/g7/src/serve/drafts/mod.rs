//! Copies of unsaved work: they survive a crash of the page or the server.
//!
//! ```text
//! routes -> Drafts -> file (a line that says what it is, and the text)
//!              \----> owners (is its window there?)
//! ```
//!
//! They are stored outside the user's folder, in the system's place for such data, in one folder
//! for each served folder, with one inside it for each person.
//!
//! # Invariants
//!
//! A copy belongs to a window of a person. Only that window changes it, and only after that window has gone does another
//! one of the same person take it over. A copy is deleted when its owner has saved it, or when its person asks for that.
//! Work that was closed or undone is kept for 30 days (decision 70).

mod file;
mod owners;
pub(super) mod routes;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use axum::http::StatusCode;
use g7_host::utc_millis;
use g7_model::say;
use serde::{Deserialize, Serialize};

use super::file_names;
use super::fingerprint;
use super::refusal::Refusal;
use super::state;
use file::Head;
pub(super) use owners::{Owner, Owners};

/// Greatest number of copies of a person.
const MOST: usize = 500;
/// Greatest size of all copies of a person together, in bytes on the disk.
const LARGEST: u64 = 64 << 20;
/// How long a copy is kept that was closed, in ms.
const KEPT: u64 = 30 * 24 * 3_600_000;
/// After this time every window that was there before the server was restarted has come again, in ms.
const AGAIN: u64 = 3_000;

/// The state in which a window leaves a copy.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(super) enum End {
    /// The file has changes.
    Open,
    /// The changes were undone: the next ones take the place of the copy.
    Undone,
    /// The file was closed without being saved: the copy stays beside later ones.
    Closed,
}

/// Who has a copy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
enum Holder {
    /// The window that asks.
    This,
    /// Another window, which is there.
    Other,
    /// A window that has gone.
    Gone,
    /// None: it was closed.
    Closed,
}

/// A copy in the list. Of another person it says only that it is there.
#[derive(Debug, Serialize)]
pub(super) struct Row {
    id: String,
    path: String,
    #[serde(skip_serializing_if = "String::is_empty")]
    person: String,
    holder: Holder,
    at: u64,
    size: u64,
}

/// A copy with its text.
#[derive(Debug, Serialize)]
pub(super) struct Draft {
    pub(super) path: String,
    pub(super) text: String,
    pub(super) base: Option<String>,
}

/// The copies of one folder.
#[derive(Debug)]
pub(super) struct Drafts {
    folder: PathBuf,
    pub(super) owners: Arc<Owners>,
    began: u64,
    changed: AtomicBool,
    turn: Mutex<()>,
}

impl Drafts {
    /// The copies for a folder, below the system's place for data of programs.
    pub(super) fn of(root: &Path, state: Option<&Path>) -> Drafts {
        let folder = match state {
            Some(state) => state.join("g7").join("drafts").join(state::name_of(root)),
            None => root.join(".g7").join("drafts"),
        };
        let owners = Arc::new(Owners::new(&folder));
        Drafts { folder, owners, began: utc_millis(), changed: AtomicBool::new(false), turn: Mutex::new(()) }
    }

    /// True once after copies have come or gone, or their owners.
    pub(super) fn have_changed(&self) -> bool {
        let left = self.owners.has_left();
        self.changed.swap(false, Ordering::Relaxed) || left
    }

    /// Stores the copy of a window and replaces its previous one.
    pub(super) fn keep(
        &self,
        owner: &Owner,
        path: &str,
        end: End,
        base: Option<String>,
        text: &str,
    ) -> Result<(), Refusal> {
        file_names::path(path).map_err(Refusal::bad)?;
        let _turn = self.turn();
        let at = utc_millis();
        let head = Head {
            path: path.to_owned(),
            person: owner.person.clone(),
            window: owner.window.clone(),
            server: self.owners.server().to_owned(),
            at,
            base,
            closed: end != End::Open,
            ..Head::default()
        };
        let own = self.place(owner, path);
        let place =
            if end == End::Closed { self.place_of(&owner.person, &aside(&own, at)) } else { own.clone() };
        let was = file::head(&own).ok().map(|(head, _)| head.closed);
        self.put(&place, &head, text)?;
        if place != own {
            fs::remove_file(&own).ok();
        }
        if place != own || was != Some(head.closed) {
            self.changed.store(true, Ordering::Relaxed);
        }
        Ok(())
    }

    /// All copies that someone may know of, ordered by path, the newest first. Old ones that were closed are deleted.
    pub(super) fn list(&self, asks: &Owner) -> Vec<Row> {
        let _turn = self.turn();
        let oldest = utc_millis().saturating_sub(KEPT);
        let mut rows = Vec::new();
        for place in self.entries(&self.folder_of(&asks.person)) {
            let Ok((head, size)) = file::head(&place) else { continue };
            if head.closed && head.at < oldest {
                fs::remove_file(&place).ok();
            } else if file_names::path(&head.path).is_ok() {
                let (id, holder) = (name(&place), self.holder(&head, asks));
                rows.push(Row { id, path: head.path, person: String::new(), holder, at: head.at, size });
            }
        }
        for place in
            self.folders().filter(|f| *f != self.folder_of(&asks.person)).flat_map(|f| self.entries(&f))
        {
            let Ok((head, size)) = file::head(&place) else { continue };
            if self.holder(&head, asks) == Holder::Other {
                let (id, holder) = (String::new(), Holder::Other);
                rows.push(Row { id, path: head.path, person: head.person, holder, at: head.at, size });
            }
        }
        rows.sort_by(|a, b| a.path.cmp(&b.path).then(b.at.cmp(&a.at)));
        rows
    }

    /// True as long as the owner of a copy that seems to have gone may come again: the server was restarted just now.
    pub(super) fn may_come(&self, rows: &[Row]) -> bool {
        utc_millis() < self.began + AGAIN && rows.iter().any(|row| row.holder == Holder::Gone)
    }

    /// A copy of a person.
    pub(super) fn read(&self, person: &str, id: &str) -> Result<Draft, Refusal> {
        let _turn = self.turn();
        let (head, text) = file::whole(&self.named(person, id)?).map_err(|e| Refusal::io(id, &e))?;
        Ok(Draft { path: head.path, text, base: head.base })
    }

    /// Makes a window the owner of a copy whose window has gone. Older copies of the same file that have no window either
    /// are closed, so that they are offered, and nothing more.
    pub(super) fn take(&self, owner: &Owner, id: &str) -> Result<Draft, Refusal> {
        let _turn = self.turn();
        let place = self.named(&owner.person, id)?;
        let (mut head, text) = file::whole(&place).map_err(|e| Refusal::io(id, &e))?;
        match self.holder(&head, owner) {
            Holder::Gone => {}
            Holder::This | Holder::Closed => return Ok(Draft { path: head.path, text, base: head.base }),
            Holder::Other => return Err(held()),
        }
        self.close_others(owner, &place, &head.path)?;
        owner.window.clone_into(&mut head.window);
        owner.person.clone_into(&mut head.person);
        self.owners.server().clone_into(&mut head.server);
        let own = self.place(owner, &head.path);
        self.put(&own, &head, &text)?;
        if own != place {
            // Whoever deletes it is the one who took it, also among several servers.
            fs::remove_file(&place).map_err(|_| held())?;
        }
        self.changed.store(true, Ordering::Relaxed);
        Ok(Draft { path: head.path, text, base: head.base })
    }

    /// Deletes the copy of a window, which has saved the file.
    pub(super) fn saved(&self, owner: &Owner, path: &str) -> Result<(), Refusal> {
        file_names::path(path).map_err(Refusal::bad)?;
        let _turn = self.turn();
        self.delete(&self.place(owner, path), path)
    }

    /// Deletes a copy, as its person asked for; one whose window is there stays.
    pub(super) fn drop(&self, owner: &Owner, id: &str) -> Result<(), Refusal> {
        let _turn = self.turn();
        let place = self.named(&owner.person, id)?;
        let head = file::head(&place).map(|(head, _)| head);
        if head.is_ok_and(|head| self.holder(&head, owner) == Holder::Other) {
            return Err(held());
        }
        self.delete(&place, id)
    }

    fn turn(&self) -> MutexGuard<'_, ()> {
        self.turn.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn holder(&self, head: &Head, asks: &Owner) -> Holder {
        let owner = Owner { person: head.person.clone(), window: head.window.clone() };
        if head.closed {
            Holder::Closed
        } else if owner == *asks {
            Holder::This
        } else if self.owners.is_there(&owner, &head.server) {
            Holder::Other
        } else {
            Holder::Gone
        }
    }

    fn delete(&self, place: &Path, named: &str) -> Result<(), Refusal> {
        match fs::remove_file(place) {
            Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(()),
            Err(e) => Err(Refusal::io(named, &e)),
            Ok(()) => {
                self.changed.store(true, Ordering::Relaxed);
                Ok(())
            }
        }
    }

    /// Writes a copy, if there is room for it.
    fn put(&self, place: &Path, head: &Head, text: &str) -> Result<(), Refusal> {
        let bytes = head.with(text).map_err(|e| Refusal::io(&head.path, &e))?;
        let folder = self.folder_of(&head.person);
        let others = self.entries(&folder).filter(|p| p != place);
        let others: Vec<u64> = others.filter_map(|p| Some(fs::metadata(p).ok()?.len())).collect();
        if others.len() >= MOST || others.iter().sum::<u64>() + bytes.len() as u64 > LARGEST {
            let text = say!("there are too many unsaved copies: delete some of the list “Unsaved work”");
            return Err(Refusal::new(StatusCode::INSUFFICIENT_STORAGE, text));
        }
        state::make(&folder)
            .map(|()| self.owners.show())
            .and_then(|()| g7_host::write_whole(place, &bytes))
            .map_err(|e| Refusal::io(&head.path, &e))
    }

    /// Closes the other copies of a file whose windows have gone.
    fn close_others(&self, owner: &Owner, but: &Path, path: &str) -> Result<(), Refusal> {
        for place in self.entries(&self.folder_of(&owner.person)).filter(|p| p != but) {
            let Ok((mut head, text)) = file::whole(&place) else { continue };
            if head.path == path && self.holder(&head, owner) == Holder::Gone {
                head.closed = true;
                self.put(&place, &head, &text)?;
            }
        }
        Ok(())
    }

    /// The folder of a person.
    fn folder_of(&self, person: &str) -> PathBuf {
        if person.is_empty() {
            return self.folder.clone();
        }
        self.folder.join(fingerprint::hash(person.as_bytes()))
    }

    /// The folders of all persons.
    fn folders(&self) -> impl Iterator<Item = PathBuf> {
        let entries = fs::read_dir(&self.folder).into_iter().flatten();
        let folders = entries.filter_map(|e| Some(e.ok()?.path())).filter(|p| p.is_dir());
        std::iter::once(self.folder.clone()).chain(folders)
    }

    /// The place of the copy of a window.
    fn place(&self, owner: &Owner, path: &str) -> PathBuf {
        self.place_of(&owner.person, &fingerprint::hash(format!("{}\n{path}", owner.window).as_bytes()))
    }

    fn place_of(&self, person: &str, id: &str) -> PathBuf {
        self.folder_of(person).join(format!("{id}.json"))
    }

    /// The place of a copy that a client named.
    fn named(&self, person: &str, id: &str) -> Result<PathBuf, Refusal> {
        let plain = !id.is_empty() && id.len() < 80 && id.chars().all(|c| c.is_ascii_hexdigit() || c == '-');
        let place = plain.then(|| self.place_of(person, id));
        place.ok_or_else(|| Refusal::bad(say!("this request means nothing")))
    }

    /// The copies of a folder, without the remains of an interrupted write.
    fn entries(&self, folder: &Path) -> impl Iterator<Item = PathBuf> + use<> {
        let entries = fs::read_dir(folder).into_iter().flatten();
        let paths = entries.filter_map(|e| Some(e.ok()?.path()));
        paths.filter(|p| {
            p.extension().is_some_and(|e| e == "json") && fs::symlink_metadata(p).is_ok_and(|m| m.is_file())
        })
    }
}

/// The refusal to touch the copy of a window that is there.
fn held() -> Refusal {
    Refusal::new(StatusCode::CONFLICT, say!("this unsaved work is open in another window"))
}

/// The name of a copy, for clients.
fn name(place: &Path) -> String {
    place.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// The name of a copy that was closed at a time.
fn aside(own: &Path, at: u64) -> String {
    format!("{}-{at:x}", name(own))
}
