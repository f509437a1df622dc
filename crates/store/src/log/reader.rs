//! Rows of a log by page, newest first: for `g7 log` and for the page of the operator.

use std::path::Path;

use rusqlite::types::Value;
use rusqlite::{Connection, params_from_iter};

use super::{COLUMNS, KIND, LAYOUTS, Row, row_of};
use crate::file::{self, StoreError};

/// The rows that are wanted; an empty filter wants all.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Filter {
    /// From this time of day on, in ms since 1970, UTC.
    pub from: Option<u64>,
    /// Before this time of day.
    pub until: Option<u64>,
    /// Of one of these levels; of any where there is none.
    pub levels: Vec<String>,
    /// With this text in kind, person, origin or data; letter case does not count.
    pub text: String,
    /// Older than the row with this number.
    pub before: Option<u64>,
}

/// A log that is read. Another process may write it at the same time.
#[derive(Debug)]
pub struct Reader {
    pub(super) file: Connection,
}

impl Reader {
    /// Opens a log for reading.
    ///
    /// # Errors
    ///
    /// There is none, or the file is something else.
    pub fn open(path: &Path) -> Result<Reader, StoreError> {
        Ok(Reader { file: file::read(path, KIND, &LAYOUTS)? })
    }

    /// The rows that a filter wants, newest first, at most so many.
    ///
    /// # Errors
    ///
    /// The file cannot be read, or holds what no log holds.
    pub fn rows(&self, filter: &Filter, most: usize) -> Result<Vec<Row>, StoreError> {
        let (wants, values) = wanted(filter);
        let text = format!("SELECT {COLUMNS} FROM row {wants} ORDER BY n DESC LIMIT {most}");
        let mut query = self.file.prepare(&text)?;
        let rows = query.query_map(params_from_iter(values), row_of)?;
        Ok(rows.collect::<Result<_, _>>()?)
    }

    /// Gives each row that a filter wants, oldest first, until `take` wants no more.
    ///
    /// # Errors
    ///
    /// The file cannot be read, or holds what no log holds.
    pub fn each(&self, filter: &Filter, mut take: impl FnMut(Row) -> bool) -> Result<(), StoreError> {
        let (wants, values) = wanted(filter);
        let mut query = self.file.prepare(&format!("SELECT {COLUMNS} FROM row {wants} ORDER BY n"))?;
        for row in query.query_map(params_from_iter(values), row_of)? {
            if !take(row?) {
                break;
            }
        }
        Ok(())
    }
}

/// The condition of a filter, and its values.
fn wanted(filter: &Filter) -> (String, Vec<Value>) {
    let mut parts = Vec::new();
    let mut values = Vec::new();
    let mut also = |part: &str, value: Value| {
        values.push(value);
        parts.push(part.replace('?', &format!("?{}", values.len())));
    };
    let whole = |n: u64| Value::Integer(i64::try_from(n).unwrap_or(i64::MAX));
    if let Some(from) = filter.from {
        also("wall >= ?", whole(from));
    }
    if let Some(until) = filter.until {
        also("wall < ?", whole(until));
    }
    if let Some(before) = filter.before {
        also("n < ?", whole(before));
    }
    if !filter.text.is_empty() {
        let text = Value::Text(filter.text.to_lowercase());
        also("instr(lower(kind || ' ' || who || ' ' || origin || ' ' || data), ?) > 0", text);
    }
    if !filter.levels.is_empty() {
        let all: Vec<String> = filter
            .levels
            .iter()
            .map(|level| {
                values.push(Value::Text(level.clone()));
                format!("?{}", values.len())
            })
            .collect();
        parts.push(format!("level IN ({})", all.join(", ")));
    }
    if parts.is_empty() {
        (String::new(), values)
    } else {
        (format!("WHERE {}", parts.join(" AND ")), values)
    }
}
