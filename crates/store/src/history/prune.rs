//! Changes that are too old, or too many, are deleted.
//!
//! Of each signal the last chunk before the cut stays: it has the value that stands there.

use rusqlite::{Transaction, params};

use super::limits::Limits;
use crate::file::StoreError;

/// The share of the chunks that goes at a time while there is too much: one in so many.
const SHARE: i64 = 16;

pub(super) fn prune(step: &Transaction<'_>, limits: Limits, now: i64) -> Result<(), StoreError> {
    cut(step, now.saturating_sub(limits.age.count() / 1000))?;
    for _ in 0..SHARE {
        if used(step)? <= limits.bytes {
            return Ok(());
        }
        let oldest = step.query_row(
            "SELECT stop FROM chunk ORDER BY stop LIMIT 1 OFFSET (SELECT count(*) / ?1 FROM chunk)",
            [SHARE],
            |row| row.get::<_, i64>(0),
        );
        match oldest {
            Ok(stop) => cut(step, stop.saturating_add(1).min(now))?,
            Err(rusqlite::Error::QueryReturnedNoRows) => return Ok(()),
            Err(e) => return Err(e.into()),
        }
    }
    Ok(())
}

/// Deletes what ends before a time.
fn cut(step: &Transaction<'_>, at: i64) -> Result<(), StoreError> {
    let first: Option<i64> = step.query_row("SELECT min(start) FROM span", (), |row| row.get(0))?;
    if first.is_none_or(|first| first >= at) {
        return Ok(());
    }
    step.execute(
        "DELETE FROM chunk WHERE stop < ?1 AND id NOT IN
         (SELECT id FROM (SELECT id, max(stop) FROM chunk WHERE stop < ?1 GROUP BY signal))",
        [at],
    )?;
    step.execute("DELETE FROM span WHERE stop < ?1", [at])?;
    step.execute("DELETE FROM clock WHERE at < (SELECT max(at) FROM clock WHERE at <= ?1)", [at])?;
    step.execute(
        "INSERT INTO kept VALUES (0, ?1) ON CONFLICT (id) DO UPDATE SET start = max(start, ?1)",
        params![at],
    )?;
    Ok(())
}

/// The bytes in use.
fn used(step: &Transaction<'_>) -> Result<u64, StoreError> {
    let number = |name: &str| step.pragma_query_value(None, name, |row| row.get::<_, i64>(0));
    let pages = number("page_count")?.saturating_sub(number("freelist_count")?);
    Ok(pages.saturating_mul(number("page_size")?).max(0).unsigned_abs())
}
