//! Changes of a file: gestures, typing, undo, the formatter.

use std::cell::RefCell;
use std::collections::HashMap;

use g7_edit::{Edit, Gesture, ItemId, Splice};
use g7_model::Document;
use serde::Serialize;

use crate::drawing::anchors;
use crate::file::File;
use crate::language::names::{meaning, word_at};
use crate::look::{Look, look};
use crate::problems::Change;

/// The file behind a change, and the change: the text view makes it too.
#[derive(Debug, Serialize)]
pub(crate) struct Edited {
    #[serde(flatten)]
    look: Look,
    splices: Vec<Change>,
    select: Vec<ItemId>,
    #[serde(skip_serializing_if = "Option::is_none")]
    begin: Option<ItemId>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    told: Vec<String>,
}

/// Carries a gesture out.
pub(crate) fn edit(name: &str, file: &mut File, gesture: &Gesture) -> Result<Edited, String> {
    let edit = draft(file, gesture)?;
    if edit.splices.is_empty() {
        return Ok(Edited {
            look: look(name, file),
            splices: Vec::new(),
            select: edit.select,
            begin: edit.begin,
            told: edit.told,
        });
    }
    let splices = file.outward(&edit.splices);
    file.change(&edit.splices, false)?;
    Ok(Edited { look: look(name, file), splices, select: edit.select, begin: edit.begin, told: edit.told })
}

/// What a gesture would change.
pub(crate) fn draft(file: &File, gesture: &Gesture) -> Result<Edit, String> {
    let stand = standing(&file.source.document);
    g7_edit::apply_placed(&file.as_edited(), gesture, &stand).map_err(|e| e.to_string())
}

/// A part of a chart as text, with where it stands.
pub(crate) fn copy(file: &File, ids: &[ItemId]) -> String {
    g7_edit::copy_placed(&file.as_edited(), ids, &standing(&file.source.document))
}

/// Where symbols stand; a chart is drawn when the first of its symbols is asked for.
fn standing(document: &Document) -> impl Fn(&ItemId) -> Option<(i32, i32)> {
    let placed = RefCell::new(HashMap::new());
    move |id: &ItemId| {
        let mut placed = placed.borrow_mut();
        let chart = placed.entry(id.chart.clone()).or_insert_with(|| anchors(document, &id.chart));
        chart.get(id).copied()
    }
}

/// Takes the last change back, or makes it again.
pub(crate) fn travel(name: &str, file: &mut File, back: bool) -> Result<Edited, String> {
    let before = std::sync::Arc::clone(&file.positions);
    let text = file.text().to_owned();
    let splices = file.travel(back)?;
    let unit = |byte| before.unit(&text, byte);
    let change = |s: &Splice| Change { from: unit(s.start), to: unit(s.end), insert: s.insert.clone() };
    let splices = splices.iter().map(change).collect();
    Ok(Edited { look: look(name, file), splices, select: Vec::new(), begin: None, told: Vec::new() })
}

/// Writes the text as the formatter does.
pub(crate) fn format(name: &str, file: &mut File) -> Result<Edited, String> {
    if !file.is_clean() {
        return Err("the text has syntax errors: mend them first".to_owned());
    }
    let text = g7_syntax::print(&file.source.document, Some(file.text()));
    let splices = difference(file.text(), &text);
    let out = file.outward(&splices);
    if !splices.is_empty() {
        file.change(&splices, false)?;
    }
    Ok(Edited { look: look(name, file), splices: out, select: Vec::new(), begin: None, told: Vec::new() })
}

/// The lines that differ: one splice from the first to the last of them.
fn difference(old: &str, new: &str) -> Vec<Splice> {
    if old == new {
        return Vec::new();
    }
    let common = |a: &mut dyn Iterator<Item = char>, b: &mut dyn Iterator<Item = char>| -> usize {
        a.zip(b).take_while(|(a, b)| a == b).map(|(a, _)| a.len_utf8()).sum()
    };
    let head = common(&mut old.chars(), &mut new.chars());
    let (rest, fresh) = (old.get(head..).unwrap_or(""), new.get(head..).unwrap_or(""));
    let tail = common(&mut rest.chars().rev(), &mut fresh.chars().rev());
    let insert = fresh.get(..fresh.len() - tail).unwrap_or("");
    vec![Splice::new(head, old.len() - tail, insert)]
}

/// Every place that names what the word at a place names.
pub(crate) fn references(file: &File, at: usize) -> Vec<(usize, usize)> {
    let byte = file.positions.byte(file.text(), at);
    let known = g7_compile::references(&file.source.document);
    let offset = u32::try_from(byte).unwrap_or(u32::MAX);
    let places: Vec<(usize, usize)> = match known.at(offset) {
        Some(named) => known.of(named).into_iter().map(|s| (s.start as usize, s.end as usize)).collect(),
        // Names without an entry, such as those of functions within themselves, are taken by their letters.
        None => match word_at(file.text(), byte) {
            Some(word) if meaning(&file.source.document, &word).is_some() => words(file.text(), word.text),
            _ => Vec::new(),
        },
    };
    places
        .into_iter()
        .map(|(a, b)| (file.positions.unit(file.text(), a), file.positions.unit(file.text(), b)))
        .collect()
}

/// Words of a text that read so.
fn words(text: &str, name: &str) -> Vec<(usize, usize)> {
    g7_syntax::tokens(text)
        .filter(|t| text.get(t.start..t.end).is_some_and(|w| w.trim_matches('`') == name))
        .map(|t| (t.start, t.end))
        .collect()
}
