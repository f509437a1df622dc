//! Every gesture of the editor as a small change of the file's text.
//!
//! ```text
//! text + Document -> gesture -> Draft (the document as it is to be)
//!                                 -> difference -> splices -> parse again -> compare
//! ```
//!
//! The text is the truth: a gesture says what the document is to become, and `difference` finds the
//! least change of the text that leads there. Only lines that must change do; notes, blank lines,
//! spelling and the order of everything else stay.
//!
//! # What must hold
//!
//! After an accepted gesture the text has no syntax errors and gives exactly the document that the
//! gesture asked for: each result is parsed and compared.
//! Steps and transitions always alternate; the editor refuses what the standard forbids.
//! - Nothing panics, whatever the ids and texts.
#![forbid(unsafe_code)]

mod change;
mod copy;
mod difference;
mod draft;
mod gesture;
mod gestures;
mod history;
mod id;
mod needs;
mod splice;

pub use change::{Anchors, Edit, Refusal, Source};
pub use copy::{copy, copy_placed};
pub use gesture::{Alignment, Branching, ChartSort, Gesture, Row, Sort, What};
pub use history::History;
pub use id::{End, ItemId, NoId, Part};
pub use splice::{Splice, spliced};

use g7_model::{ChartItem, Document, FileId, Item};

use change::refuse;
use draft::Draft;

/// Executes a gesture; places of symbols are known only from the layout section of the text.
pub fn apply(source: &Source<'_>, gesture: &Gesture) -> Result<Edit, Refusal> {
    apply_placed(source, gesture, &|_| None)
}

/// The same for a chart that is drawn: `anchors` gives the places of its symbols.
pub fn apply_placed(source: &Source<'_>, gesture: &Gesture, anchors: Anchors<'_>) -> Result<Edit, Refusal> {
    if let Gesture::Text { splices } = gesture {
        return match spliced(source.text, splices) {
            Some(_) => Ok(Edit { splices: splices.clone(), ..Edit::default() }),
            None => refuse("the change does not fit the text"),
        };
    }
    if !source.clean {
        return refuse(
            "the text has syntax errors; correct them first (the drawing shows the chart before them)",
        );
    }
    if let Gesture::Rename { id, name, to } = gesture {
        return gestures::rename(source, id.as_ref(), name.as_deref(), to);
    }
    if let Gesture::Variable { name: Some(name), row } = gesture
        && let Some(new) = gestures::renamed_row(source, name, row)
    {
        return in_two(
            source,
            &Gesture::Rename { id: None, name: Some(name.clone()), to: row.name.clone() },
            &new,
        );
    }
    let mut draft = Draft::new(source, anchors);
    gestures::carry_out(&mut draft, gesture)?;
    difference::settle(&mut draft);
    let splices = difference::difference(&draft);
    let after = spliced(source.text, &splices).ok_or_else(unwritable)?;
    judge(&after, &draft.doc)?;
    let splices = with_besides(source.text, splices, std::mem::take(&mut draft.besides))?;
    let select = draft.select.iter().filter_map(|m| draft.resolved(m)).collect();
    let begin = draft.begin.as_ref().and_then(|m| draft.resolved(m));
    Ok(Edit { splices, select, begin, told: draft.told })
}

/// Renames the part that is named at a byte of the text, wherever it is used.
pub fn rename_at(source: &Source<'_>, at: usize, to: &str) -> Result<Edit, Refusal> {
    if !source.clean {
        return refuse("the text has syntax errors; correct them first");
    }
    gestures::rename_at(source, at, to)
}

/// Executes two gestures as one change.
fn in_two(source: &Source<'_>, first: &Gesture, second: &Gesture) -> Result<Edit, Refusal> {
    let before = apply(source, first)?;
    let text = spliced(source.text, &before.splices).ok_or_else(unwritable)?;
    let (document, problems) = g7_syntax::parse(&text, FileId(0));
    let between = Source { text: &text, document: &document, clean: problems.is_empty() };
    let after = apply(&between, second)?;
    let splices = splice::composed(source.text, &before.splices, &after.splices).ok_or_else(unwritable)?;
    Ok(Edit { splices, ..after })
}

/// Adds changes of names; the resulting text must have no syntax errors.
fn with_besides(text: &str, mut splices: Vec<Splice>, besides: Vec<Splice>) -> Result<Vec<Splice>, Refusal> {
    if besides.is_empty() {
        return Ok(splices);
    }
    let free = |s: &Splice| !splices.iter().any(|o| s.start < o.end && o.start < s.end);
    let besides: Vec<Splice> = besides.into_iter().filter(free).collect();
    splices.extend(besides);
    splices.sort_by_key(|s| (s.start, s.end));
    let after = spliced(text, &splices).ok_or_else(unwritable)?;
    match g7_syntax::parse(&after, FileId(0)).1.first() {
        Some(problem) => refuse(format!("this cannot be written: {problem}")),
        None => Ok(splices),
    }
}

/// Checks that the text gives exactly the intended document.
fn judge(text: &str, meant: &Document) -> Result<(), Refusal> {
    let (read, problems) = g7_syntax::parse(text, FileId(0));
    if let Some(problem) = problems.first() {
        return refuse(format!("this cannot be written: {problem}"));
    }
    if plain(read).items != plain(meant.clone()).items {
        return Err(unwritable());
    }
    Ok(())
}

/// Removes differences without meaning, such as the empty braces of a step.
fn plain(mut doc: Document) -> Document {
    for item in &mut doc.items {
        let Item::Chart(chart) = item else { continue };
        for item in &mut chart.items {
            if let ChartItem::Step(step) = item {
                step.braces = !step.actions.is_empty();
            }
        }
    }
    doc
}

fn unwritable() -> Refusal {
    Refusal::new("this cannot be written into the text as it stands here; change the text itself")
}
