//! Changes of a file: gestures, undo and redo, the formatter.

use g7_edit::{Edit, Gesture, ItemId};
use g7_ide::File;
use g7_ide::fixes::Fixes;
use g7_ide::gestures::draft;
use g7_model::{Said, say};
use serde::Serialize;

use crate::overview::{Overview, overview};
use crate::places::{Change, changes, outward};
use crate::problems::{NewName, names};

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
    let edit = draft(file, gesture)?;
    make(name, file, edit)
}

/// Executes a fix: that of this number, of the problem of this number. `version` is that of the text whose problems
/// the page shows.
pub(crate) fn mend(
    name: &str,
    file: &mut File,
    version: u64,
    (problem, fix): (usize, usize),
) -> Result<Edited, Said> {
    let problem = file.problems.get(problem).filter(|_| version == file.version);
    let fix = problem.and_then(|p| Fixes::of(file).fixes(p).into_iter().nth(fix));
    let edit = fix.ok_or_else(|| say!("the text has changed; the problem is no longer there"))?.edit(file)?;
    make(name, file, edit)
}

fn make(name: &str, file: &mut File, mut edit: Edit) -> Result<Edited, Said> {
    let told = edit.told.iter().map(|t| t.in_language(file.language)).collect();
    let splices = outward(file, &edit.splices);
    if !splices.is_empty() {
        file.make(&mut edit)?;
    }
    Ok(Edited { overview: overview(name, file), splices, select: edit.select, begin: edit.begin, told })
}

/// The effect that a gesture would have.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(optional_fields))]
pub(crate) struct Foreseen {
    /// The text that was probably meant by one that cannot be read.
    #[serde(skip_serializing_if = "Option::is_none")]
    meant: Option<String>,
    /// The names in its symbol that nothing would declare.
    undeclared: Vec<NewName>,
}

/// The effect of a gesture on a file, which stays as it is.
pub(crate) fn foresee(file: &File, gesture: &Gesture) -> Foreseen {
    match g7_ide::gestures::foresee(file, gesture) {
        Ok(after) => {
            let undeclared = names(&after.document, &after.undeclared);
            Foreseen { meant: None, undeclared }
        }
        Err(_) => Foreseen { meant: g7_edit::meant(gesture), undeclared: Vec::new() },
    }
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
