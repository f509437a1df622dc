//! `g7 check --watch`: checks again whenever a file changes, until the user ends it.
//!
//! The system tells of changes in the folders of the files; then, and from time to time, the files are asked for
//! their time and length. Some file systems, network drives among them, tell of nothing. Where the system cannot
//! be asked to tell, the files are looked at more often.

use std::collections::BTreeSet;
use std::io::{IsTerminal, stdout};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, SystemTime};

use g7_model::say;
use notify::{EventKind, RecommendedWatcher, RecursiveMode, Watcher};

use crate::failure::{Failure, Verdict};
use crate::message::{error, talk, told};
use crate::style;

/// Time between two looks at the files where the system tells of changes.
const SLOW: Duration = Duration::from_secs(2);
/// The same where it does not.
const PAUSE: Duration = Duration::from_millis(200);
/// One writing is several changes: they are over when nothing more is told for this time.
const QUIET: Duration = Duration::from_millis(40);
/// Most changes that are waited for, since some program may write for ever.
const MOST: u32 = 1000;
/// Clears the screen and what was scrolled off it.
const CLEAR: &str = "\u{1b}[H\u{1b}[2J\u{1b}[3J";

/// The files with their times and lengths, which tell two states apart.
type Seen = Vec<(PathBuf, Option<(SystemTime, u64)>)>;

fn seen(paths: &[PathBuf]) -> Seen {
    let of = |path: &PathBuf| {
        let meta = std::fs::metadata(path).ok()?;
        Some((meta.modified().ok()?, meta.len()))
    };
    paths.iter().map(|path| (path.clone(), of(path))).collect()
}

/// The changes that the system tells of some folders.
struct Ear {
    told: Receiver<()>,
    /// Kept, so that the channel stays open where there is no watcher.
    _tell: Sender<()>,
    watcher: Option<RecommendedWatcher>,
    folders: BTreeSet<PathBuf>,
}

impl Ear {
    fn new() -> Ear {
        let (tell, told) = channel();
        let heard = tell.clone();
        let watcher = notify::recommended_watcher(move |event: notify::Result<notify::Event>| {
            // Reading a file is no change of it.
            if event.is_ok_and(|event| !matches!(event.kind, EventKind::Access(_))) {
                heard.send(()).ok();
            }
        });
        Ear { told, _tell: tell, watcher: watcher.ok(), folders: BTreeSet::new() }
    }

    /// Listens to the folders of these files and to no others.
    fn follow(&mut self, paths: &[PathBuf]) {
        let here = |folder: &Path| if folder.as_os_str().is_empty() { ".".into() } else { folder.into() };
        let wanted: BTreeSet<PathBuf> = paths.iter().filter_map(|p| p.parent()).map(here).collect();
        if wanted == self.folders {
            return;
        }
        let Some(watcher) = &mut self.watcher else { return };
        for folder in self.folders.difference(&wanted) {
            watcher.unwatch(folder).ok();
        }
        let deaf = |folder: &PathBuf| watcher.watch(folder, RecursiveMode::NonRecursive).is_err();
        // There may be more folders than the system listens to.
        if wanted.difference(&self.folders).any(deaf) {
            self.watcher = None;
        }
        self.folders = wanted;
    }

    /// Waits until something may have changed; true if the system says so.
    fn wait(&self) -> bool {
        let pause = if self.watcher.is_some() { SLOW } else { PAUSE };
        let told = self.told.recv_timeout(pause).is_ok();
        if told {
            (0..MOST).take_while(|_| self.told.recv_timeout(QUIET).is_ok()).count();
        }
        told
    }
}

/// The result of a look at files.
pub(super) struct Looked {
    pub(super) verdict: Verdict,
    /// The files that the files use, which were read as well.
    pub(super) used: Vec<PathBuf>,
}

/// Does something with the files now and after each change. Failures are told and do not end it, apart from
/// that of the output, and that of the first look.
pub(super) fn for_ever(
    find: impl Fn() -> Result<Vec<PathBuf>, Failure>,
    look: impl Fn(&[PathBuf]) -> Result<Looked, Failure>,
) -> Result<Verdict, Failure> {
    let mut paths = find()?;
    // The files that those use; known behind a look.
    let mut used: Vec<PathBuf> = Vec::new();
    let mut ear = Ear::new();
    loop {
        ear.follow(&[&*paths, &*used].concat());
        // The state before the look: what changes while it goes on is seen afterwards. What --fix writes
        // is looked at once more, which finds nothing to write.
        let before = seen(&paths);
        if stdout().is_terminal() {
            anstream::print!("{CLEAR}");
        }
        match look(&paths) {
            Err(failure @ Failure::Output(_)) => return Err(failure),
            Err(failure) => error(&failure),
            Ok(looked) => used = looked.used,
        }
        let before_used = seen(&used);
        ear.follow(&[&*paths, &*used].concat());
        let waiting = told(&say!("waiting for a change; Ctrl-C ends"));
        talk!("{}{waiting}{:#}", style::FAINT, style::FAINT);
        loop {
            ear.wait();
            // An editor may replace a file by another: for a moment there may be none.
            let Ok(now) = find() else { continue };
            if seen(&now) != before || seen(&used) != before_used {
                paths = now;
                break;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn the_system_tells_of_files_that_are_written_or_made_in_their_folders() {
        let folder = std::env::temp_dir().join(format!("g7-ear-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        let path = folder.join("chart.g7");
        std::fs::write(&path, "chart").expect("a file");
        let mut ear = Ear::new();
        ear.follow(std::slice::from_ref(&path));
        std::fs::write(&path, "chart G").expect("the file again");
        assert!(ear.wait(), "a file that was written");
        std::fs::write(folder.join("other.g7"), "").expect("another file");
        assert!(ear.wait(), "a file that was made");
        std::fs::remove_dir_all(&folder).ok();
    }

    #[test]
    fn without_a_watcher_it_waits_for_the_next_look() {
        let ear = Ear { watcher: None, ..Ear::new() };
        assert!(!ear.wait());
    }
}
