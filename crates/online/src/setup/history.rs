//! The table `[history]`: which signals are recorded, in which file, and for how long.
//!
//! ```toml
//! [history]
//! file = "sorter.history"
//! signals = ["start", "level", "X3"]
//! days = 30
//! megabytes = 256
//! deadband = { level = 0.5 }
//! ```

use g7_model::say;
use toml::de::DeValue;

use super::table::{self, At, Found, Table};

/// Greatest number of signals that are recorded.
pub(crate) const SIGNALS: usize = 10_000;
/// Days and megabytes where the file does not say them.
const USUAL: (i64, i64) = (30, 256);

/// The table `[history]`.
#[derive(Clone, Debug, PartialEq)]
pub struct History {
    /// The file of the record, beside the io file.
    pub file: At<String>,
    /// The signals by name; `None` for all.
    pub signals: Option<Vec<At<String>>>,
    /// Changes that are older than so many days are deleted.
    pub days: u32,
    /// The greatest size of the record, in MB; beyond it the oldest is deleted.
    pub megabytes: u32,
    /// By name of a number: it is recorded when it has moved by so much.
    pub deadband: Vec<(At<String>, f64)>,
}

pub(super) fn history(mut table: Table<'_>, found: &mut Found) -> Option<History> {
    let file = table.needed(found, "file", "chart.history");
    let signals = signals(&mut table, found);
    let mut whole = |key, usual| {
        let read = table.whole(found, key, 1..=100_000);
        read.map_or(usual, |n| n.value)
    };
    let (days, megabytes) = (whole("days", USUAL.0), whole("megabytes", USUAL.1));
    let mut deadband = Vec::new();
    for row in table.rows(found, "deadband") {
        match table::number(row.value).filter(|band| *band > 0.0) {
            Some(band) => deadband.push((At::new(row.name.to_owned(), row.at), band)),
            None => {
                found.wrong(row.value_at, say!("the deadband of `{}` is a number above 0", row.name));
            }
        }
    }
    table.end(found);
    // Both are within the limits above.
    Some(History { file: file?, signals: signals?, days: days as u32, megabytes: megabytes as u32, deadband })
}

/// The names of the signals; `Some(None)` for all, `None` behind a problem.
fn signals(table: &mut Table<'_>, found: &mut Found) -> Option<Option<Vec<At<String>>>> {
    let Some(value) = table.value(found, "signals") else { return Some(None) };
    let names = match value.value {
        DeValue::String(word) if word == "all" => return Some(None),
        DeValue::Array(names) => names,
        _ => {
            found.wrong(value.at, say!("`signals` of [history] is \"all\", or a list of names")).help =
                Some(say!("write `signals = [\"start\", \"X3\"]`"));
            return None;
        }
    };
    let mut read = Vec::new();
    for name in names.iter() {
        let at = found.span(name.span());
        match name.get_ref().as_str() {
            Some(text) => read.push(At::new(text.to_owned(), at)),
            None => {
                found.wrong(at, say!("a signal is a name in quotes"));
            }
        }
    }
    if read.is_empty() {
        found.wrong(value.at, say!("a history without signals records nothing")).help =
            Some(say!("name some, or leave `signals` out for all"));
        return None;
    }
    Some(Some(read))
}
