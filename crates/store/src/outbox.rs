//! Events that wait until a broker has taken them, numbered from 1, oldest first.
//!
//! The file is bounded in events and in bytes. Where it would grow beyond, the oldest go, and one row says
//! in their place from which number to which they are missing. A number is never used twice, also
//! after the file was empty.

use std::path::Path;

use rusqlite::{Connection, OptionalExtension as _, Transaction, params};

use crate::file::{Durable, StoreError, open};

/// The application id of the file: `G7ob`.
const KIND: i32 = 0x4737_6f62;
/// A row without an event stands for those from `first` to its own number.
const LAYOUT: &str = "CREATE TABLE waiting (
    number INTEGER PRIMARY KEY AUTOINCREMENT,
    at INTEGER NOT NULL,
    event TEXT,
    first INTEGER
)";

/// The most that may wait.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Rows; two at least.
    pub count: u64,
    /// Bytes of all events together.
    pub bytes: u64,
}

/// A row that waits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Waiting {
    /// Its number. It is greater than the numbers of all rows that were added before.
    pub number: i64,
    /// The time of day, UTC, as RFC 3339 has it, to the millisecond.
    pub at: String,
    /// The event, or the first number of those that were dropped, up to that of the row.
    pub event: Result<String, i64>,
}

/// A file of what waits.
#[derive(Debug)]
pub struct Outbox {
    file: Connection,
    limits: Limits,
    count: u64,
    bytes: u64,
}

impl Outbox {
    /// Opens or makes the file.
    ///
    /// # Errors
    ///
    /// It cannot be used, or belongs to something else.
    pub fn open(path: &Path, limits: Limits) -> Result<Outbox, StoreError> {
        let file = open(path, KIND, &[LAYOUT], Durable::AtOnce)?;
        let sum = "SELECT count(*), coalesce(sum(octet_length(event)), 0) FROM waiting";
        let (count, bytes) = file.query_row(sum, (), |row| Ok((size(row, 0)?, size(row, 1)?)))?;
        Ok(Outbox { file, limits, count, bytes })
    }

    /// The number of rows that wait.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The bytes of the events that wait.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Adds events, each with its time in milliseconds since 1970, all or none of them. Returns the
    /// greatest number that was dropped for them, if any was.
    ///
    /// # Errors
    ///
    /// The disk or the file refuses; nothing was added.
    pub fn add(&mut self, events: &[(u64, String)]) -> Result<Option<i64>, StoreError> {
        let step = self.file.transaction()?;
        let (mut count, mut bytes) = (self.count, self.bytes);
        {
            let mut insert = step.prepare_cached("INSERT INTO waiting (at, event) VALUES (?1, ?2)")?;
            for (at, event) in events {
                insert.execute(params![i64::try_from(*at).unwrap_or(i64::MAX), event])?;
                count += 1;
                bytes += event.len() as u64;
            }
        }
        let dropped = drop_oldest(&step, self.limits, &mut count, &mut bytes)?;
        step.commit()?;
        (self.count, self.bytes) = (count, bytes);
        Ok(dropped)
    }

    /// The oldest rows behind a number, so many at most.
    ///
    /// # Errors
    ///
    /// The disk or the file refuses.
    pub fn after(&self, number: i64, most: usize) -> Result<Vec<Waiting>, StoreError> {
        let mut rows = self.file.prepare_cached(
            "SELECT number, strftime('%Y-%m-%dT%H:%M:%fZ', at / 1000.0, 'unixepoch'), event, first
             FROM waiting WHERE number > ?1 ORDER BY number LIMIT ?2",
        )?;
        let read = |row: &rusqlite::Row<'_>| {
            let event: Option<String> = row.get(2)?;
            let first: Option<i64> = row.get(3)?;
            let number: i64 = row.get(0)?;
            let at: Option<String> = row.get(1)?;
            Ok(Waiting {
                number,
                // A clock beyond the year 9999 has no text.
                at: at.unwrap_or_default(),
                event: event.ok_or(first.unwrap_or(number)),
            })
        };
        let most = i64::try_from(most).unwrap_or(i64::MAX);
        Ok(rows.query_map(params![number, most], read)?.collect::<Result<Vec<Waiting>, _>>()?)
    }

    /// Removes rows that were taken, by number; those that are gone already are none.
    ///
    /// # Errors
    ///
    /// The disk or the file refuses; all are there still.
    pub fn remove(&mut self, numbers: &[i64]) -> Result<(), StoreError> {
        if numbers.is_empty() {
            return Ok(());
        }
        let step = self.file.transaction()?;
        let (mut count, mut bytes) = (self.count, self.bytes);
        {
            let mut delete = step.prepare_cached(
                "DELETE FROM waiting WHERE number = ?1 RETURNING coalesce(octet_length(event), 0)",
            )?;
            for number in numbers {
                if let Some(size) = delete.query_row([number], |row| size(row, 0)).optional()? {
                    count = count.saturating_sub(1);
                    bytes = bytes.saturating_sub(size);
                }
            }
        }
        step.commit()?;
        (self.count, self.bytes) = (count, bytes);
        Ok(())
    }
}

/// A count or a length, which SQLite has with a sign.
fn size(row: &rusqlite::Row<'_>, column: usize) -> rusqlite::Result<u64> {
    Ok(row.get::<_, i64>(column)?.max(0).unsigned_abs())
}

/// Replaces the oldest rows by one, until the rest is within the limits. Returns its number.
fn drop_oldest(
    step: &Transaction<'_>,
    limits: Limits,
    count: &mut u64,
    bytes: &mut u64,
) -> Result<Option<i64>, StoreError> {
    if *count <= limits.count && *bytes <= limits.bytes {
        return Ok(None);
    }
    let (mut first, mut last) = (None, None);
    {
        let mut rows = step.prepare_cached(
            "SELECT number, coalesce(first, number), at, coalesce(octet_length(event), 0)
             FROM waiting ORDER BY number",
        )?;
        let mut rows = rows.query(())?;
        // The row that stands for those that are gone is one as well.
        while *count + 1 > limits.count || *bytes > limits.bytes {
            let Some(row) = rows.next()? else { break };
            let (number, from): (i64, i64) = (row.get(0)?, row.get(1)?);
            first.get_or_insert(from);
            last = Some((number, row.get::<_, i64>(2)?));
            *count = count.saturating_sub(1);
            *bytes = bytes.saturating_sub(size(row, 3)?);
        }
    }
    let (Some(first), Some((last, at))) = (first, last) else { return Ok(None) };
    step.execute("DELETE FROM waiting WHERE number <= ?1", [last])?;
    step.execute("INSERT INTO waiting (number, at, first) VALUES (?1, ?2, ?3)", [last, at, first])?;
    *count += 1;
    Ok(Some(last))
}

#[cfg(test)]
mod tests {
    use super::*;

    const MANY: Limits = Limits { count: 1_000, bytes: 1 << 20 };

    fn path(name: &str) -> std::path::PathBuf {
        let folder = std::env::temp_dir().join(format!("g7-outbox-{name}-{}", std::process::id()));
        std::fs::remove_dir_all(&folder).ok();
        std::fs::create_dir_all(&folder).expect("a folder");
        folder.join("events")
    }

    fn some(texts: &[&str]) -> Vec<(u64, String)> {
        texts.iter().map(|text| (1_764_041_726_123, (*text).to_owned())).collect()
    }

    fn numbers(outbox: &Outbox) -> Vec<i64> {
        outbox.after(0, 1_000).expect("read").iter().map(|row| row.number).collect()
    }

    #[test]
    fn events_wait_in_order_until_they_are_removed_and_numbers_go_on() {
        let path = path("order");
        let mut outbox = Outbox::open(&path, MANY).expect("made");
        assert_eq!(outbox.add(&some(&["a", "b", "c"])).expect("added"), None);
        let row = &outbox.after(1, 1).expect("read")[0];
        // 1764041726 is 2025-11-25 03:35:26 UTC.
        assert_eq!((row.number, row.at.as_str()), (2, "2025-11-25T03:35:26.123Z"));
        assert_eq!(row.event, Ok("b".to_owned()));
        outbox.remove(&[1, 3, 99]).expect("removed");
        drop(outbox);
        let mut outbox = Outbox::open(&path, MANY).expect("there");
        assert_eq!((numbers(&outbox), outbox.count(), outbox.bytes()), (vec![2], 1, 1));
        outbox.remove(&[2]).expect("removed");
        outbox.add(&some(&["d"])).expect("added");
        assert_eq!(numbers(&outbox), [4], "the file was empty; no number comes twice");
    }

    #[test]
    fn the_oldest_go_and_one_row_says_which() {
        let mut outbox = Outbox::open(&path("full"), Limits { count: 3, bytes: 1 << 20 }).expect("made");
        outbox.add(&some(&["1", "2", "3"])).expect("added");
        assert_eq!(outbox.add(&some(&["4"])).expect("added"), Some(2));
        let rows = outbox.after(0, 9).expect("read");
        assert_eq!(rows[0].event, Err(1), "1 to 2 are gone");
        assert_eq!(numbers(&outbox), [2, 3, 4]);
        assert_eq!(outbox.add(&some(&["5", "6"])).expect("added"), Some(4));
        assert_eq!(outbox.after(0, 9).expect("read")[0].event, Err(1), "1 to 4 are gone");
        assert_eq!((numbers(&outbox), outbox.count()), (vec![4, 5, 6], 3));
        // As soon as it has told so, the next gap begins anew.
        outbox.remove(&[4]).expect("removed");
        outbox.add(&some(&["7", "8"])).expect("added");
        assert_eq!(outbox.after(0, 1).expect("read")[0].event, Err(5));
    }

    #[test]
    fn bytes_are_bounded_too() {
        let mut outbox = Outbox::open(&path("bytes"), Limits { count: 1_000, bytes: 100 }).expect("made");
        let long = "x".repeat(40);
        for _ in 0..10 {
            outbox.add(&some(&[&long])).expect("added");
            assert!(outbox.bytes() <= 100, "{}", outbox.bytes());
        }
        assert_eq!(numbers(&outbox), [8, 9, 10]);
        assert_eq!(outbox.after(0, 1).expect("read")[0].event, Err(1));
        // One that is longer than all there may be is dropped as well.
        outbox.add(&some(&[&"x".repeat(101)])).expect("added");
        assert_eq!((numbers(&outbox), outbox.bytes()), (vec![11], 0));
    }
}
