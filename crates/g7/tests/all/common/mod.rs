//! A folder for each test, and the program under test.
#![allow(clippy::disallowed_methods, reason = "tests look at what was written")]

pub(crate) mod broker;
pub(crate) mod station;
pub(crate) mod talk;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use snapbox::cmd::{Command, OutputAssert, cargo_bin};

static NEXT: AtomicU32 = AtomicU32::new(0);

/// A folder that is deleted after the test.
pub(crate) struct Folder(PathBuf);

impl Folder {
    pub(crate) fn new() -> Folder {
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("g7-test-{}-{number}", std::process::id()));
        fs::create_dir_all(&path).expect("a folder for the test");
        Folder(path)
    }

    /// A folder with one file `chart.g7`.
    pub(crate) fn with(chart: &str) -> Folder {
        let folder = Folder::new();
        folder.write("chart.g7", chart);
        folder
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    pub(crate) fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().expect("in the folder")).expect("a folder");
        fs::write(path, text).expect("a file for the test");
    }

    pub(crate) fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// The names in the folder, sorted.
    pub(crate) fn names(&self) -> Vec<String> {
        let list = fs::read_dir(&self.0).expect("the folder");
        let mut names: Vec<String> =
            list.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// Runs `g7` in the folder.
    pub(crate) fn g7(&self, args: &[&str]) -> Ran {
        self.command(args).assert().into()
    }

    pub(crate) fn command(&self, args: &[&str]) -> Command {
        Command::new(cargo_bin!("g7"))
            .args(args)
            .current_dir(&self.0)
            .env_remove("CLICOLOR_FORCE")
            .env_remove("LC_ALL")
            .env_remove("LC_MESSAGES")
            .env("LANG", "C")
            .env("COLUMNS", "100")
    }

    pub(crate) fn root(&self) -> &Path {
        &self.0
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        fs::remove_dir_all(&self.0).ok();
    }
}

/// The result of a run of `g7`.
pub(crate) struct Ran {
    pub(crate) code: i32,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl From<OutputAssert> for Ran {
    fn from(ran: OutputAssert) -> Ran {
        let output = ran.get_output();
        Ran {
            code: output.status.code().expect("an exit code"),
            out: String::from_utf8_lossy(&output.stdout).into_owned(),
            err: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }
}

impl Ran {
    /// Asserts exit code 2, no output, and one line of message that contains all of `parts`.
    #[track_caller]
    pub(crate) fn is_refused(&self, parts: &[&str]) {
        assert_eq!((self.code, self.out.as_str()), (2, ""), "{}", self.err);
        assert_eq!(self.err.lines().count(), 1, "one line: {}", self.err);
        for part in parts {
            assert!(self.err.contains(part), "`{part}` in: {}", self.err);
        }
    }

    #[track_caller]
    pub(crate) fn is(&self, code: i32) -> &Ran {
        assert_eq!(self.code, code, "out: {}\nerr: {}", self.out, self.err);
        self
    }
}

/// Two steps: `a` leads to step 2, `not a` leads back; step 2 is counted.
pub(crate) const PINGPONG: &str = "\
input a : BOOL
output m : BOOL
var n : INT

chart G {
  initial step 1
  step 2 {
    N m
    P1 n := n + 1
  }
  1 -> 2 when a
  2 -> 1 when not a
}
";
