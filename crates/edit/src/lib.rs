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
//! After an accepted gesture the text has no new syntax errors and gives exactly the document that the
//! gesture asked for: each result is parsed and compared. Where the text had syntax errors before, they
//! stand in other items of the file than those that the gesture changes.
//! Steps and transitions always alternate; the editor refuses what the standard forbids.
//! - Nothing panics, whatever the ids and texts.
#![forbid(unsafe_code)]

mod change;
mod copy;
mod difference;
mod draft;
mod gesture;
mod gestures;
mod heads;
mod history;
mod id;
mod needs;
mod reading;
mod splice;

pub use change::{Anchors, Edit, Refusal, Source};
pub use copy::{copy, copy_placed};
use g7_model::say;
pub use gesture::{
    Alignment, Bound, Branching, ChartSort, DrawnAs, Gesture, LinkEnd, Row, Sort, StackedAs, What,
};
pub use gestures::{Joined, Renaming};
pub use heads::{Head, meant};
pub use history::History;
pub use id::{End, ItemId, NoId, Part};
pub use splice::{Splice, spliced};

use g7_syntax::Tree;
pub use g7_syntax::UNITS;

use change::refuse;
use draft::Draft;
use reading::{judge, judge_problems, read, unwritable};

/// Executes a gesture; places of symbols are known only from the layout section of the text.
pub fn apply(source: &Source<'_>, gesture: &Gesture) -> Result<Edit, Refusal> {
    apply_placed(source, gesture, &|_| None)
}

/// The same for a chart that is drawn: `anchors` gives the places of its symbols.
#[inline(never)]
pub fn apply_placed(source: &Source<'_>, gesture: &Gesture, anchors: Anchors<'_>) -> Result<Edit, Refusal> {
    if let Gesture::Text { splices } = gesture {
        return match spliced(source.text, splices) {
            Some(_) => Ok(Edit { splices: splices.clone(), ..Edit::default() }),
            None => refuse(say!("the change does not fit the text")),
        };
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
    gestures::hold(&mut draft);
    let splices = difference::difference(&draft);
    let mut tree = read(source, &splices).ok_or_else(unwritable)?;
    judge(source, &splices, &tree, &draft.doc)?;
    let splices = match std::mem::take(&mut draft.besides) {
        besides if besides.is_empty() => splices,
        besides => {
            let splices = with_besides(splices, besides);
            tree = read(source, &splices).ok_or_else(unwritable)?;
            judge_problems(source, &splices, &tree)?;
            splices
        }
    };
    let select = draft.select.iter().filter_map(|m| draft.resolved(m)).collect();
    let begin = draft.begin.as_ref().and_then(|m| draft.resolved(m));
    Ok(Edit { splices, select, begin, told: draft.told, read: Some(Box::new(tree)) })
}

/// The steps that a deletion of parts of one chart would join if it heals.
pub fn joins(source: &Source<'_>, ids: &[ItemId]) -> Result<Vec<Joined>, Refusal> {
    gestures::joins(&mut Draft::new(source, &|_| None), ids)
}

/// Renames the part that is named at a byte of the text, wherever it is used.
pub fn rename_at(source: &Source<'_>, at: usize, to: &str) -> Result<Edit, Refusal> {
    gestures::rename_at(source, at, to)
}

/// Executes two gestures as one change.
fn in_two(source: &Source<'_>, first: &Gesture, second: &Gesture) -> Result<Edit, Refusal> {
    let before = apply(source, first)?;
    let tree = match before.read {
        Some(tree) => *tree,
        None => read(source, &before.splices).ok_or_else(unwritable)?,
    };
    let Tree { text, document, problems, marks } = &tree;
    let after = apply(&Source { text, document, problems, marks: Some(marks) }, second)?;
    let splices = splice::composed(source.text, &before.splices, &after.splices).ok_or_else(unwritable)?;
    Ok(Edit { splices, ..after })
}

/// Adds changes of names.
fn with_besides(mut splices: Vec<Splice>, besides: Vec<Splice>) -> Vec<Splice> {
    let free = |s: &Splice| !splices.iter().any(|o| s.start < o.end && o.start < s.end);
    let besides: Vec<Splice> = besides.into_iter().filter(free).collect();
    splices.extend(besides);
    splices.sort_by_key(|s| (s.start, s.end));
    splices
}
