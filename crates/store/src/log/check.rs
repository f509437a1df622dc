//! The proof of a log: each row fits the one before, and the rows that are gone went as the log says.

use rusqlite::OptionalExtension as _;

use super::reader::Reader;
use super::{COLUMNS, Hash, Mark, PRUNED, chained, row_of};
use crate::file::StoreError;

/// The state of a whole log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Checked {
    /// The rows that are there.
    pub rows: u64,
    /// The number of the last row that was removed as an old one; 0 where all are there.
    pub gone: u64,
    /// The newest row.
    pub newest: Mark,
}

/// The first row that does not fit.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("row {n} does not fit: {why}")]
pub struct Broken {
    /// The number of the row.
    pub n: u64,
    /// The fault.
    pub why: String,
}

impl Reader {
    /// Holds each row against the one before. `known` is a mark that was kept elsewhere.
    ///
    /// # Errors
    ///
    /// The file cannot be read. A log that does not fit is the inner error.
    pub fn check(&self, known: Option<Mark>) -> Result<Result<Checked, Broken>, StoreError> {
        let broken = |n, why: &str| Ok(Err(Broken { n, why: why.to_owned() }));
        let anchor: Option<(i64, [u8; 32])> = self
            .file
            .query_row("SELECT n, hash FROM anchor", (), |r| Ok((r.get(0)?, r.get(1)?)))
            .optional()?;
        let anchor = anchor.map(|(n, hash)| Mark { n: n as u64, hash: Hash(hash) });
        let begin = anchor.unwrap_or_default();
        let (mut last, mut rows, mut told, mut met) = (begin, 0, None, known.is_none_or(|k| k.n == 0));
        let mut query = self.file.prepare(&format!("SELECT {COLUMNS} FROM row ORDER BY n"))?;
        let mut found = query.query(())?;
        while let Some(row) = found.next()? {
            let n = last.n + 1;
            let Ok(read) = row_of(row) else { return broken(n, "it holds what no log holds") };
            if read.n != n {
                let what = if rows == 0 && anchor.is_none() {
                    "the oldest rows are gone"
                } else {
                    "it is not there"
                };
                return broken(n, what);
            }
            if chained(&last.hash, n, &read.entry) != read.hash {
                return broken(n, "it was changed, or a row before it was put in or taken out");
            }
            last = Mark { n, hash: read.hash };
            rows += 1;
            if read.entry.kind == PRUNED {
                told = Some(read.entry.data);
            }
            if let Some(known) = known.filter(|known| known.n == n) {
                if known.hash != last.hash {
                    return broken(n, "it is another row than the one with the hash that was kept");
                }
                met = true;
            }
        }
        if let Some(anchor) = anchor
            && told != Some(format!("{{\"upto\":\"{anchor}\"}}"))
        {
            return broken(anchor.n + 1, "rows before it are gone, and no row of the log says so");
        }
        match known {
            Some(known) if !met && known.n > last.n => {
                broken(last.n + 1, &format!("it is not there, and the log once had {} rows", known.n))
            }
            Some(known) if !met && known.n == begin.n && known.hash != begin.hash => {
                broken(known.n, "it was another row than the one with the hash that was kept")
            }
            _ => Ok(Ok(Checked { rows, gone: begin.n, newest: last })),
        }
    }
}
