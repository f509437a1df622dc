//! `g7 check --watch`: checks again whenever a file changes, until the user ends it.
//!
//! Files are asked for their time and length, as the server does: this works on every kind of file system.

use std::io::{IsTerminal, stdout};
use std::path::PathBuf;
use std::time::{Duration, SystemTime};

use crate::failure::{Failure, Verdict};
use crate::message::talk;
use crate::style;

/// Time between two looks at the files.
const PAUSE: Duration = Duration::from_millis(200);
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

/// Does something with the files now and after each change. Failures are told and do not end it, apart from
/// that of the output, and that of the first look.
pub(super) fn for_ever(
    find: impl Fn() -> Result<Vec<PathBuf>, Failure>,
    look: impl Fn(&[PathBuf]) -> Result<Verdict, Failure>,
) -> Result<Verdict, Failure> {
    let mut paths = find()?;
    loop {
        // The state before the look: what changes while it goes on is seen afterwards. What --fix writes
        // is looked at once more, which finds nothing to write.
        let before = seen(&paths);
        if stdout().is_terminal() {
            anstream::print!("{CLEAR}");
        }
        match look(&paths) {
            Err(failure @ Failure::Output(_)) => return Err(failure),
            Err(failure) => talk!("{}error:{:#} {failure}", style::BAD, style::BAD),
            Ok(_) => {}
        }
        talk!("{}waiting for a change; Ctrl-C ends{:#}", style::FAINT, style::FAINT);
        loop {
            std::thread::sleep(PAUSE);
            // An editor may replace a file by another: for a moment there may be none.
            let Ok(now) = find() else { continue };
            if seen(&now) != before {
                paths = now;
                break;
            }
        }
    }
}
