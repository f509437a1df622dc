//! Changes of a file: gestures, undo and redo, the formatter; and the places where a name is used.

use g7_edit::{Gesture, ItemId, Splice};
use serde::Serialize;

use crate::file::File;
use crate::gestures::draft;
use crate::language::definitions::{meaning, word_at};
use crate::overview::{Overview, overview};
use crate::positions::Change;

/// The file after a change, and the change itself, which the text view makes too.
#[derive(Debug, Serialize)]
pub(crate) struct Edited {
    #[serde(flatten)]
    overview: Overview,
    splices: Vec<Change>,
    select: Vec<ItemId>,
    #[serde(skip_serializing_if = "Option::is_none")]
    begin: Option<ItemId>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    told: Vec<String>,
}

/// Executes a gesture.
pub(crate) fn edit(name: &str, file: &mut File, gesture: &Gesture) -> Result<Edited, String> {
    let edit = draft(file, gesture)?;
    if edit.splices.is_empty() {
        return Ok(Edited {
            overview: overview(name, file),
            splices: Vec::new(),
            select: edit.select,
            begin: edit.begin,
            told: edit.told,
        });
    }
    let splices = file.outward(&edit.splices);
    file.change(&edit.splices, false)?;
    Ok(Edited {
        overview: overview(name, file),
        splices,
        select: edit.select,
        begin: edit.begin,
        told: edit.told,
    })
}

/// Undoes the last change, or redoes it.
pub(crate) fn travel(name: &str, file: &mut File, back: bool) -> Result<Edited, String> {
    let before = std::sync::Arc::clone(&file.positions);
    let text = file.text().to_owned();
    let splices = file.travel(back)?;
    let unit = |byte| before.unit(&text, byte);
    let change = |s: &Splice| Change { from: unit(s.start), to: unit(s.end), insert: s.insert.clone() };
    let splices = splices.iter().map(change).collect();
    Ok(Edited { overview: overview(name, file), splices, select: Vec::new(), begin: None, told: Vec::new() })
}

/// Formats the text.
pub(crate) fn format(name: &str, file: &mut File) -> Result<Edited, String> {
    if !file.is_clean() {
        return Err("the text has syntax errors: correct them first".to_owned());
    }
    let text = g7_syntax::print(&file.source.document, Some(file.text()));
    let splices = difference(file.text(), &text);
    let out = file.outward(&splices);
    if !splices.is_empty() {
        file.change(&splices, false)?;
    }
    Ok(Edited {
        overview: overview(name, file),
        splices: out,
        select: Vec::new(),
        begin: None,
        told: Vec::new(),
    })
}

/// The difference between two texts as one splice, from the first to the last differing character.
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

/// All places that name the same part as the word at a place.
pub(crate) fn references(file: &File, at: usize) -> Vec<(usize, usize)> {
    let byte = file.positions.byte(file.text(), at);
    let known = g7_compile::references(&file.source.document);
    let offset = u32::try_from(byte).unwrap_or(u32::MAX);
    let places: Vec<(usize, usize)> = match known.at(offset) {
        Some(named) => known.of(named).into_iter().map(|s| (s.start as usize, s.end as usize)).collect(),
        // Names that are not indexed, such as a function's name inside the function, are found by
        // spelling.
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

/// All words of a text with this spelling.
fn words(text: &str, name: &str) -> Vec<(usize, usize)> {
    g7_syntax::tokens(text)
        .filter(|t| text.get(t.start..t.end).is_some_and(|w| w.trim_matches('`') == name))
        .map(|t| (t.start, t.end))
        .collect()
}
