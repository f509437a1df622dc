//! Changes of a file: gestures, undo and redo, the formatter.

use g7_edit::{Gesture, ItemId};
use g7_ide::File;
use g7_ide::gestures::draft;
use g7_model::{Said, say};
use serde::Serialize;

use crate::overview::{Overview, overview};
use crate::places::{Change, changes, outward};

/// The file after a change, and the change itself, which the text view makes too.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(optional_fields))]
pub(crate) struct Edited {
    #[serde(flatten)]
    overview: Overview,
    splices: Vec<Change>,
    select: Vec<ItemId>,
    #[serde(skip_serializing_if = "Option::is_none")]
    begin: Option<ItemId>,
    #[cfg_attr(feature = "types", ts(as = "Option<_>"))]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    told: Vec<String>,
}

/// Executes a gesture.
pub(crate) fn edit(name: &str, file: &mut File, gesture: &Gesture) -> Result<Edited, Said> {
    let mut edit = draft(file, gesture)?;
    if edit.splices.is_empty() {
        return Ok(Edited {
            overview: overview(name, file),
            splices: Vec::new(),
            select: edit.select,
            begin: edit.begin,
            told: edit.told.iter().map(|t| t.in_language(file.language)).collect(),
        });
    }
    let splices = outward(file, &edit.splices);
    file.make(&mut edit)?;
    Ok(Edited {
        overview: overview(name, file),
        splices,
        select: edit.select,
        begin: edit.begin,
        told: edit.told.iter().map(|t| t.in_language(file.language)).collect(),
    })
}

/// Undoes the last change, or redoes it.
pub(crate) fn travel(name: &str, file: &mut File, back: bool) -> Result<Edited, Said> {
    let before = std::sync::Arc::clone(&file.positions);
    let text = file.text().to_owned();
    let splices = file.travel(back)?;
    let splices = changes(&before, &text, &splices);
    Ok(Edited { overview: overview(name, file), splices, select: Vec::new(), begin: None, told: Vec::new() })
}

/// Formats the text.
pub(crate) fn format(name: &str, file: &mut File) -> Result<Edited, Said> {
    let splices =
        g7_ide::format(file).ok_or_else(|| say!("the text has syntax errors; correct them first"))?;
    let out = outward(file, &splices);
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
