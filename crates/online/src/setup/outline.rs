//! An io file key by key, as it stands: for those who show it. Nothing is judged here.

use g7_model::{FileId, Span};
use serde_json::{Map, Value};
use toml::de::{DeTable, DeValue};

use super::table::{Found, MOST, number, rows};

/// Tables within tables that are looked into; a channel or a broker has no more.
const DEEPEST: usize = 4;

/// A key of an io file.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// The keys above it, and its own: `devices`, `line1`, `poll`.
    pub path: Vec<String>,
    /// The place of the key.
    pub key: Span,
    /// The place of the value.
    pub at: Span,
    /// The value; a table has those of its keys.
    pub value: Value,
}

/// All keys of an io file, each table before what is in it, in the order of the text. Of a text that is
/// no TOML it has what can be read.
pub fn outline(text: &str, file: FileId) -> Vec<Entry> {
    let mut entries = Vec::new();
    if text.len() <= MOST {
        let (table, _) = DeTable::parse_recoverable(text);
        walk(table.get_ref(), &[], &Found { file, problems: Vec::new() }, &mut entries);
    }
    entries
}

fn walk(table: &DeTable<'_>, above: &[String], found: &Found, entries: &mut Vec<Entry>) {
    for row in rows(table, found) {
        let path: Vec<String> = above.iter().cloned().chain([row.name.to_owned()]).collect();
        let value = json(row.value, path.len());
        entries.push(Entry { path: path.clone(), key: row.at, at: row.value_at, value });
        if let (Some(inner), true) = (row.value.as_table(), path.len() < DEEPEST) {
            walk(inner, &path, found, entries);
        }
    }
}

fn json(value: &DeValue<'_>, depth: usize) -> Value {
    if let Some(text) = value.as_str() {
        return text.into();
    }
    if let Some(on) = value.as_bool() {
        return on.into();
    }
    if let Some(x) = number(value) {
        return if x.fract() == 0.0 && x.abs() < 9e15 { Value::from(x as i64) } else { Value::from(x) };
    }
    match value.as_table() {
        Some(table) if depth <= DEEPEST => {
            let pairs = table
                .iter()
                .map(|(key, value)| (key.get_ref().to_string(), json(value.get_ref(), depth + 1)));
            Value::Object(pairs.collect::<Map<_, _>>())
        }
        Some(_) | None => Value::Null,
    }
}
