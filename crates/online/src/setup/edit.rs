//! Changes of an io file that leave the rest of it as it is.
//!
//! A change names a key by its path and gives it a value, or takes it away. `toml_edit` makes the new
//! text; of it only the lines that differ are taken, so that comments, spacing and line ends of all other
//! lines stay to the byte.

use std::fmt;

use g7_model::{Said, say};
use toml_edit::{DocumentMut, InlineTable, Item, Table, TableLike, Value};

/// A change of an io file.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// Gives the key at this path a value; tables on the way are made where there are none.
    Set(Vec<String>, Plain),
    /// Takes the key at this path away, with all that is below it.
    Remove(Vec<String>),
    /// Gives a device another name, here and in the channels that name it.
    Rename(String, String),
}

/// A value of a change.
#[derive(Clone, Debug, PartialEq)]
pub enum Plain {
    /// A text.
    Text(String),
    /// A whole number.
    Whole(i64),
    /// A number.
    Number(f64),
    /// True or false.
    Flag(bool),
    /// A table: of a device one with lines of its own, otherwise one in braces.
    Table(Vec<(String, Plain)>),
}

/// Why a file cannot be changed so.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Uneditable(pub Said);

impl fmt::Display for Uneditable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Uneditable {}

/// The tables that can be changed.
const TABLES: [&str; 5] = ["controller", "devices", "inputs", "outputs", "shown"];

/// The text of an io file after some changes, one after the other.
///
/// # Errors
///
/// The text is no TOML, or a path leads through something that is no table.
pub fn edit(text: &str, changes: &[Change]) -> Result<String, Uneditable> {
    let mut text = text.to_owned();
    for change in changes {
        for one in single(&text, change)? {
            let mut document = parsed(&text)?;
            match &one {
                Change::Set(path, value) => set(&mut document, path, value)?,
                Change::Remove(path) => remove(&mut document, path)?,
                Change::Rename(from, to) => rename(&mut document, from, to)?,
            }
            text = merged(&text, &document.to_string());
        }
    }
    Ok(text)
}

fn parsed(text: &str) -> Result<DocumentMut, Uneditable> {
    text.parse::<DocumentMut>().map_err(|e| {
        let line = e.span().and_then(|at| text.get(..at.start)).map_or(1, |above| above.split('\n').count());
        Uneditable(say!("line {line} of the io file is no TOML: mend it in a text editor first"))
    })
}

/// A change as changes of one place each, so that each leaves all other lines alone.
fn single(text: &str, change: &Change) -> Result<Vec<Change>, Uneditable> {
    let Change::Rename(from, to) = change else { return Ok(vec![change.clone()]) };
    let document = parsed(text)?;
    let mut changes = vec![change.clone()];
    for table in ["inputs", "outputs", "shown"] {
        let Some(channels) = document.get(table).and_then(Item::as_table_like) else { continue };
        for (name, channel) in channels.iter() {
            let at = channel.as_table_like().and_then(|channel| channel.get("at"));
            let mut path = vec![table.to_owned(), name.to_owned()];
            if at.is_some() {
                path.push("at".to_owned());
            }
            let Some(point) = at.unwrap_or(channel).as_str() else { continue };
            if let Some(point) = super::point::renamed(point, from, to) {
                changes.push(Change::Set(path, Plain::Text(point)));
            }
        }
    }
    Ok(changes)
}

fn set(document: &mut DocumentMut, path: &[String], value: &Plain) -> Result<(), Uneditable> {
    let (key, above) = allowed(path)?;
    // A device is a table with lines of its own, and so is what the file begins such a table for.
    if let ([top], Plain::Table(rows)) = (above, value)
        && top == "devices"
    {
        return device(document, key, rows);
    }
    let table = tables(document, above)?;
    let value = value_of(value);
    match table.get_mut(key).and_then(Item::as_value_mut) {
        Some(old) => {
            let decor = old.decor().clone();
            *old = value;
            *old.decor_mut() = decor;
        }
        None => {
            table.insert(key, Item::Value(value));
        }
    }
    Ok(())
}

/// The last key of a path and those above it.
fn allowed(path: &[String]) -> Result<(&String, &[String]), Uneditable> {
    match path.split_last() {
        Some((key, above))
            if above.first().is_some_and(|top| TABLES.contains(&top.as_str())) && path.len() <= 4 =>
        {
            Ok((key, above))
        }
        Some(_) | None => Err(Uneditable(say!("an io file has nothing at `{}`", path.join(".")))),
    }
}

/// The table at a path; those that are missing are made.
fn tables<'d>(document: &'d mut DocumentMut, path: &[String]) -> Result<&'d mut dyn TableLike, Uneditable> {
    let mut at: &mut dyn TableLike = document.as_table_mut();
    for (depth, key) in path.iter().enumerate() {
        if at.get(key).is_none() {
            at.insert(
                key,
                if depth == 0 { Item::Table(new_table()) } else { Item::Value(InlineTable::new().into()) },
            );
        }
        let item = at.get_mut(key).ok_or_else(|| no_table(key))?;
        // A channel that is only a point becomes a table with it.
        if depth == 1 && path.first().is_some_and(|top| top != "devices" && top != "controller") {
            point_as_table(item);
        }
        at = item.as_table_like_mut().ok_or_else(|| no_table(key))?;
    }
    Ok(at)
}

fn no_table(key: &str) -> Uneditable {
    Uneditable(say!("`{key}` is no table: mend it in a text editor first"))
}

fn new_table() -> Table {
    let mut table = Table::new();
    table.decor_mut().set_prefix("\n");
    table
}

fn point_as_table(item: &mut Item) {
    let Some(value) = item.as_value_mut() else { return };
    let Some(point) = value.as_str().map(str::to_owned) else { return };
    let decor = value.decor().clone();
    let mut table = InlineTable::new();
    table.insert("at", point.into());
    *value = Value::InlineTable(table);
    *value.decor_mut() = decor;
}

/// Adds a device, or replaces what an old one has.
fn device(document: &mut DocumentMut, name: &str, rows: &[(String, Plain)]) -> Result<(), Uneditable> {
    if document.get("devices").is_none() {
        let mut devices = Table::new();
        devices.set_implicit(true);
        document.insert("devices", Item::Table(devices));
    }
    let devices =
        document.get_mut("devices").and_then(Item::as_table_like_mut).ok_or_else(|| no_table("devices"))?;
    if devices.get(name).is_some() {
        return Err(Uneditable(say!("there is a device `{name}` already")));
    }
    let mut table = new_table();
    for (key, value) in rows {
        table.insert(key, Item::Value(value_of(value)));
    }
    devices.insert(name, Item::Table(table));
    Ok(())
}

fn remove(document: &mut DocumentMut, path: &[String]) -> Result<(), Uneditable> {
    let (key, above) = allowed(path)?;
    let mut at: &mut dyn TableLike = document.as_table_mut();
    for key in above {
        let Some(item) = at.get_mut(key) else { return Ok(()) };
        at = item.as_table_like_mut().ok_or_else(|| no_table(key))?;
    }
    at.remove(key);
    Ok(())
}

fn rename(document: &mut DocumentMut, from: &str, to: &str) -> Result<(), Uneditable> {
    let devices =
        document.get_mut("devices").and_then(Item::as_table_like_mut).ok_or_else(|| no_table("devices"))?;
    if devices.get(to).is_some() {
        return Err(Uneditable(say!("there is a device `{to}` already")));
    }
    let item = devices.remove(from).ok_or_else(|| Uneditable(say!("there is no device `{from}`")))?;
    devices.insert(to, item);
    Ok(())
}

fn value_of(plain: &Plain) -> Value {
    match plain {
        Plain::Text(text) => text.as_str().into(),
        Plain::Whole(n) => (*n).into(),
        Plain::Number(x) => (*x).into(),
        Plain::Flag(on) => (*on).into(),
        Plain::Table(rows) => {
            let mut table = InlineTable::new();
            for (key, value) in rows {
                table.insert(key, value_of(value));
            }
            Value::InlineTable(table)
        }
    }
}

/// The old text with the lines of the new one that differ: above and below them each byte stays.
fn merged(old: &str, new: &str) -> String {
    // A file that begins has no empty line at its head.
    let new = if old.is_empty() { new.trim_start_matches('\n') } else { new };
    let (before, after): (Vec<&str>, Vec<&str>) =
        (old.split_inclusive('\n').collect(), new.split_inclusive('\n').collect());
    let same = |a: &&str, b: &&str| bare(a) == bare(b);
    let head = before.iter().zip(&after).take_while(|(a, b)| same(a, b)).count();
    let most = before.len().min(after.len()) - head;
    let tail = before.iter().rev().zip(after.iter().rev()).take(most).take_while(|(a, b)| same(a, b)).count();
    // A file keeps the line ends that it has.
    let end = if before.first().is_some_and(|line| line.ends_with("\r\n")) { "\r\n" } else { "\n" };
    let mut text: String = before.iter().take(head).copied().collect();
    let changed = after.iter().skip(head).take(after.len() - head - tail);
    if head > 0 && changed.len() > 0 && !text.ends_with('\n') {
        text.push_str(end);
    }
    for line in changed {
        text.push_str(bare(line));
        text.push_str(end);
    }
    text.extend(before.iter().skip(before.len() - tail).copied());
    text
}

/// A line without its end, and the first without the mark of its encoding.
fn bare(line: &str) -> &str {
    line.trim_start_matches('\u{feff}').trim_end_matches(['\n', '\r'])
}
