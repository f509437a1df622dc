//! A file of SQLite: opened, brought to its present layout, told apart from others.

use std::path::Path;
use std::time::Duration;

use rusqlite::{Connection, ErrorCode, OpenFlags};

/// The time that a write waits for another connection to the same file.
const PATIENCE: Duration = Duration::from_millis(2_000);

/// When a write has survived a loss of power.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Durable {
    /// As soon as the call returns.
    AtOnce,
    /// A moment later; the file stays whole in any case.
    Soon,
}

/// Why a file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// It is a file of something else.
    #[error("it is not a file of this kind")]
    Foreign,
    /// A newer G7 has written it.
    #[error("a newer G7 has written it (layout {0})")]
    Newer(i32),
    /// The file system refuses, or SQLite does.
    #[error("{0}")]
    Sql(#[from] rusqlite::Error),
}

impl StoreError {
    /// True where the disk has no room.
    pub fn is_full(&self) -> bool {
        matches!(self, StoreError::Sql(e) if e.sqlite_error_code() == Some(ErrorCode::DiskFull))
    }
}

/// Opens or makes a file of a kind.
///
/// `kind` is the application id of the file (SQLite file format, 1.2.17), `layouts` are the statements that
/// bring a file from each layout to the next; those that the file lacks are carried out, whole or not at all.
///
/// # Errors
///
/// The file belongs to something else, is newer than this program, or cannot be read or written.
pub fn open(path: &Path, kind: i32, layouts: &[&str], durable: Durable) -> Result<Connection, StoreError> {
    let mut file = Connection::open(path)?;
    file.busy_timeout(PATIENCE)?;
    let number =
        |file: &Connection, name: &str| file.pragma_query_value(None, name, |row| row.get::<_, i32>(0));
    let found = match number(&file, "application_id") {
        Err(e) if e.sqlite_error_code() == Some(ErrorCode::NotADatabase) => return Err(StoreError::Foreign),
        found => found?,
    };
    let layout = number(&file, "user_version")?;
    if found != kind && (found != 0 || layout != 0 || number(&file, "schema_version")? != 0) {
        return Err(StoreError::Foreign);
    }
    let missing = usize::try_from(layout).ok().and_then(|have| layouts.get(have..));
    let missing = missing.ok_or(StoreError::Newer(layout))?;
    file.pragma_update(None, "journal_mode", "WAL")?;
    let sync = match durable {
        Durable::AtOnce => "FULL",
        Durable::Soon => "NORMAL",
    };
    file.pragma_update(None, "synchronous", sync)?;
    if !missing.is_empty() {
        let step = file.transaction()?;
        for statements in missing {
            step.execute_batch(statements)?;
        }
        step.pragma_update(None, "application_id", kind)?;
        step.pragma_update(None, "user_version", layouts.len() as i32)?;
        step.commit()?;
    }
    Ok(file)
}

/// Opens a file of a kind for reading alone; another process may be writing it.
///
/// # Errors
///
/// There is no such file, it belongs to something else, has another layout, or cannot be read.
pub fn read(path: &Path, kind: i32, layouts: &[&str]) -> Result<Connection, StoreError> {
    let file = Connection::open_with_flags(path, OpenFlags::SQLITE_OPEN_READ_ONLY)?;
    file.busy_timeout(PATIENCE)?;
    let number = |name: &str| file.pragma_query_value(None, name, |row| row.get::<_, i32>(0));
    let found = match number("application_id") {
        Err(e) if e.sqlite_error_code() == Some(ErrorCode::NotADatabase) => return Err(StoreError::Foreign),
        found => found?,
    };
    let layout = number("user_version")?;
    match usize::try_from(layout) {
        Ok(have) if found == kind && have == layouts.len() => Ok(file),
        Ok(have) if found == kind && have > layouts.len() => Err(StoreError::Newer(layout)),
        Ok(_) | Err(_) => Err(StoreError::Foreign),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KIND: i32 = 0x4737_5431;

    fn folder(name: &str) -> std::path::PathBuf {
        let path = std::env::temp_dir().join(format!("g7-store-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a folder");
        path.join("file")
    }

    #[test]
    fn a_file_comes_to_the_present_layout_and_keeps_what_it_has() {
        let path = folder("layout");
        let first = ["CREATE TABLE a (n INTEGER)"];
        let file = open(&path, KIND, &first, Durable::AtOnce).expect("made");
        file.execute("INSERT INTO a VALUES (7)", ()).expect("written");
        drop(file);
        let both = [first[0], "ALTER TABLE a ADD COLUMN m INTEGER DEFAULT 3"];
        let file = open(&path, KIND, &both, Durable::Soon).expect("brought up");
        let row: (i64, i64) =
            file.query_row("SELECT n, m FROM a", (), |r| Ok((r.get(0)?, r.get(1)?))).expect("a row");
        assert_eq!(row, (7, 3));
        drop(file);
        assert!(matches!(open(&path, KIND, &first, Durable::Soon), Err(StoreError::Newer(2))));
    }

    #[test]
    fn a_file_of_something_else_is_left_alone() {
        let path = folder("foreign");
        std::fs::write(&path, vec![b'x'; 5_000]).expect("written");
        assert!(matches!(open(&path, KIND, &[], Durable::AtOnce), Err(StoreError::Foreign)));
        assert_eq!(std::fs::read(&path).expect("there"), vec![b'x'; 5_000]);
        let path = folder("other-kind");
        drop(open(&path, KIND + 1, &["CREATE TABLE a (n)"], Durable::AtOnce).expect("made"));
        assert!(matches!(
            open(&path, KIND, &["CREATE TABLE b (n)"], Durable::AtOnce),
            Err(StoreError::Foreign)
        ));
    }
}
