//! The windows that are there: those connected to this server, and those of other servers of the same folder.
//!
//! ```text
//! live -> Owners::enter -> Seat, until the socket ends
//! Drafts -> Owners::is_there
//! ```
//!
//! Two programs may serve one folder. Each shows by a lock of the system, which ends with it, that its windows may be
//! there; nothing else is known of the windows of another program.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use g7_host::utc_millis;

use crate::sole::{self, Sole};

/// Locks of servers that have ended are deleted at this age, in ms: a younger one may belong to a server that has not
/// taken it yet.
const YOUNG: u64 = 60_000;

/// A window of a person; the person is empty where there are no users.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Owner {
    pub(crate) person: String,
    pub(crate) window: String,
}

/// The open windows.
#[derive(Debug)]
pub(crate) struct Owners {
    folder: PathBuf,
    /// The name of this server among those of the folder.
    server: String,
    windows: Mutex<BTreeMap<Owner, usize>>,
    lock: OnceLock<Option<Sole>>,
    left: AtomicBool,
}

/// An open window; it counts as closed when this is dropped.
#[derive(Debug)]
pub(crate) struct Seat {
    owners: Arc<Owners>,
    owner: Owner,
}

impl Owners {
    pub(super) fn new(folder: &Path) -> Owners {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        Owners {
            folder: folder.to_path_buf(),
            server: format!("server-{}-{}-{number}", utc_millis(), std::process::id()),
            windows: Mutex::default(),
            lock: OnceLock::new(),
            left: AtomicBool::new(false),
        }
    }

    /// The name of this server. Other servers of the folder ask by it whether this one still runs.
    pub(super) fn server(&self) -> &str {
        &self.server
    }

    /// Takes the lock that tells other servers of the folder that this one runs. The folder must exist.
    pub(super) fn show(&self) {
        self.lock.get_or_init(|| {
            self.sweep();
            sole::claim(&self.folder.join(&self.server)).ok()
        });
    }

    /// Counts a window as open until the result is dropped.
    pub(crate) fn enter(self: &Arc<Owners>, owner: Owner) -> Seat {
        *self.windows().entry(owner.clone()).or_default() += 1;
        Seat { owners: Arc::clone(self), owner }
    }

    /// True if a window is open on this server, or if the other server through which it wrote still runs: its windows are not
    /// known here, so they count as open.
    pub(super) fn is_there(&self, owner: &Owner, server: &str) -> bool {
        if self.windows().contains_key(owner) {
            return true;
        }
        let plain = server.chars().all(|c| c.is_ascii_alphanumeric() || c == '-');
        !server.is_empty() && plain && server != self.server && sole::is_taken(&self.folder.join(server))
    }

    /// True if a window was closed since this was asked last.
    pub(super) fn has_left(&self) -> bool {
        self.left.swap(false, Ordering::Relaxed)
    }

    fn windows(&self) -> MutexGuard<'_, BTreeMap<Owner, usize>> {
        self.windows.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Deletes the lock files of servers that were killed.
    fn sweep(&self) {
        for entry in fs::read_dir(&self.folder).into_iter().flatten().flatten() {
            let path = entry.path();
            let is_lock = path.extension().is_some_and(|e| e == "lock");
            let age = entry.metadata().and_then(|meta| meta.modified()).map(|at| at.elapsed());
            let old = matches!(age, Ok(Ok(age)) if age.as_millis() > u128::from(YOUNG));
            if is_lock && old && !sole::is_taken(&path.with_extension("")) {
                fs::remove_file(path).ok();
            }
        }
    }
}

impl Drop for Owners {
    fn drop(&mut self) {
        if let Some(Some(lock)) = self.lock.take() {
            drop(lock);
            fs::remove_file(sole::beside(&self.folder.join(&self.server))).ok();
        }
    }
}

impl Drop for Seat {
    fn drop(&mut self) {
        let mut windows = self.owners.windows();
        match windows.get_mut(&self.owner) {
            Some(count) if *count > 1 => *count -= 1,
            Some(_) | None => {
                windows.remove(&self.owner);
                self.owners.left.store(true, Ordering::Relaxed);
            }
        }
    }
}
