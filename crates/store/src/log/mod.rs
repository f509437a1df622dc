//! The log of events and of the deeds of persons: rows that are only added, each chained to the one before
//! by its hash.
//!
//! ```text
//! attendant, server -> Log (bounded queue) -> a thread of its own -> file
//! g7 log, the page  -> Reader (filter, check) <---------------------/
//! ```
//!
//! # Invariants
//!
//! A row that was told as written survives a loss of power, with all rows before it.
//! `hash = SHA-256(hash of the row before, number, times, level, kind, who, from, data)`, each text with its
//! length. So a row that is changed, left out or put in no longer fits. The chain has no secret: who may write
//! the file can make all of it anew. The number and the hash of the newest row, kept elsewhere, find that
//! too, and rows that are cut off at the end ([`Mark`]).
//! Rows go from the oldest only, and a row in the chain says so with the number and the hash of the last.

mod check;
mod reader;
mod writer;

use std::fmt;
use std::str::FromStr;

use rusqlite::Row as SqlRow;
use sha2::{Digest as _, Sha256};

pub use check::{Broken, Checked};
pub use reader::{Filter, Reader};
pub use writer::{Entrance, Keep, Log, Opened, State, Ticket};

/// The application id of the file: `G7LG`.
const KIND: i32 = 0x4737_4C47;

const LAYOUTS: [&str; 1] = ["\
CREATE TABLE row (
    n INTEGER PRIMARY KEY,
    wall INTEGER NOT NULL,
    at INTEGER,
    level TEXT NOT NULL,
    kind TEXT NOT NULL,
    who TEXT NOT NULL,
    origin TEXT NOT NULL,
    data TEXT NOT NULL,
    hash BLOB NOT NULL
) STRICT;
CREATE TABLE anchor (
    one INTEGER PRIMARY KEY CHECK (one = 1),
    n INTEGER NOT NULL,
    hash BLOB NOT NULL
) STRICT;"];

/// The kind of the row that says that rows were lost: the disk was full, or too much happened.
pub const GAP: &str = "log-gap";
/// The kind of the row that says that old rows were removed.
pub const PRUNED: &str = "log-pruned";
/// The kind of the row that says that the newest rows are not those that this process has written.
pub const CUT: &str = "log-cut";

/// A hash of the chain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Hash(pub [u8; 32]);

impl fmt::Display for Hash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl FromStr for Hash {
    type Err = String;

    fn from_str(text: &str) -> Result<Hash, String> {
        let wrong = || "a hash has 64 hexadecimal digits".to_owned();
        if text.len() != 64 || !text.is_ascii() {
            return Err(wrong());
        }
        let mut bytes = [0; 32];
        for (byte, k) in bytes.iter_mut().zip((0..64).step_by(2)) {
            let digits = text.get(k..k + 2).ok_or_else(wrong)?;
            *byte = u8::from_str_radix(digits, 16).map_err(|_| wrong())?;
        }
        Ok(Hash(bytes))
    }
}

/// The number of a row and its hash: who keeps them elsewhere can prove the log up to it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mark {
    /// The number of the row; 0 before the first.
    pub n: u64,
    /// Its hash.
    pub hash: Hash,
}

impl fmt::Display for Mark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.n, self.hash)
    }
}

impl FromStr for Mark {
    type Err = String;

    fn from_str(text: &str) -> Result<Mark, String> {
        let wrong = || "expected `NUMBER:HASH` as a start or `g7 log --check` prints it".to_owned();
        let (n, hash) = text.split_once(':').ok_or_else(wrong)?;
        Ok(Mark { n: n.parse().map_err(|_| wrong())?, hash: hash.parse()? })
    }
}

/// The contents of a row.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Entry {
    /// The time of day, in ms since 1970, UTC.
    pub wall: u64,
    /// The time of the controller in ns; `None` where it was none of its scans.
    pub at: Option<i64>,
    /// `note`, `warning`, `alarm`, or `deed` for what a person did.
    pub level: String,
    /// The kind of event or deed, one word.
    pub kind: String,
    /// The person, or empty.
    pub who: String,
    /// The address or terminal of the person, or empty.
    pub from: String,
    /// Its details: a JSON object.
    pub data: String,
}

/// A row of the log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Row {
    /// Its number, from 1.
    pub n: u64,
    /// The contents.
    pub entry: Entry,
    /// Its hash.
    pub hash: Hash,
}

/// The columns of a row, in the order of [`row_of`].
const COLUMNS: &str = "n, wall, at, level, kind, who, origin, data, hash";

/// Reads a row; a value that no writer of ours writes is an error.
fn row_of(row: &SqlRow<'_>) -> rusqlite::Result<Row> {
    let entry = Entry {
        wall: row.get::<_, i64>(1)? as u64,
        at: row.get(2)?,
        level: row.get(3)?,
        kind: row.get(4)?,
        who: row.get(5)?,
        from: row.get(6)?,
        data: row.get(7)?,
    };
    Ok(Row { n: row.get::<_, i64>(0)? as u64, entry, hash: Hash(row.get(8)?) })
}

/// The hash of a row behind one with the hash `before`.
fn chained(before: &Hash, n: u64, entry: &Entry) -> Hash {
    let mut hash = Sha256::new();
    hash.update(b"G7 log 1");
    hash.update(before.0);
    hash.update(n.to_le_bytes());
    hash.update(entry.wall.to_le_bytes());
    hash.update([u8::from(entry.at.is_some())]);
    hash.update(entry.at.unwrap_or_default().to_le_bytes());
    for text in [&entry.level, &entry.kind, &entry.who, &entry.from, &entry.data] {
        hash.update((text.len() as u64).to_le_bytes());
        hash.update(text.as_bytes());
    }
    Hash(hash.finalize().into())
}

#[cfg(test)]
mod tests;
