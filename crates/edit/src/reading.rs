//! Reads a changed text only where it changed, and tells whether it gives what a gesture asked for.
//!
//! It stands above the ends of a gesture (`change.rs`) and below the gestures and their execution. The tree
//! that is read here goes out with the change, so that nobody reads the new text again.

use g7_model::{Chart, ChartItem, Document, FileId, Item, Problem, Said, Step, say};
use g7_syntax::{Marks, Tree};

use crate::change::{Refusal, Source, refuse};
use crate::splice::{Splice, spliced};

/// The text after a change, read. `None` if the change does not fit the text.
pub(crate) fn read(source: &Source<'_>, splices: &[Splice]) -> Option<Tree> {
    let Some(marks) = source.marks else {
        return spliced(source.text, splices).map(|text| Tree::read(text, FileId(0)));
    };
    let mut tree = known(source, marks);
    let edits: Vec<_> = splices.iter().map(|s| (s.start..s.end, s.insert.as_str())).collect();
    tree.change(&edits).then_some(tree)
}

fn known(source: &Source<'_>, marks: &Marks) -> Tree {
    Tree {
        text: source.text.to_owned(),
        document: source.document.clone(),
        problems: source.problems.to_vec(),
        marks: marks.clone(),
    }
}

/// Checks that the text has no other problems than before, which stand elsewhere.
pub(crate) fn judge_problems(source: &Source<'_>, splices: &[Splice], tree: &Tree) -> Result<(), Refusal> {
    if !splices.iter().all(|s| source.reads_cleanly(s.start..s.end)) {
        return refuse(mended_first());
    }
    same_problems(source, splices, tree)
}

/// Checks that the text has the same problems as before, wherever they stand.
#[inline(never)]
pub(crate) fn same_problems(source: &Source<'_>, splices: &[Splice], tree: &Tree) -> Result<(), Refusal> {
    let before = |new: &&Problem| {
        source.problems.iter().any(|old| {
            (old.code, &old.what) == (new.code, &new.what)
                && moved(splices, old.at.start) == i64::from(new.at.start)
        })
    };
    match tree.problems.iter().find(|new| !before(new)) {
        Some(problem) => refuse(say!("this cannot be written: {}", problem.what)),
        None if tree.problems.len() != source.problems.len() => Err(unwritable()),
        None => Ok(()),
    }
}

/// Where a byte that the splices do not touch stands after them.
fn moved(splices: &[Splice], at: u32) -> i64 {
    let long = |n: usize| i64::try_from(n).unwrap_or(i64::MAX);
    let before = splices.iter().filter(|s| s.end <= at as usize);
    before.fold(i64::from(at), |at, s| at + long(s.insert.len()) - long(s.end - s.start))
}

/// The refusal of a gesture where the text cannot be read.
pub(crate) fn mended_first() -> Said {
    say!("the text has syntax errors; correct them first (the drawing shows the chart before them)")
}

/// Checks that the text gives exactly the intended document.
#[inline(never)]
pub(crate) fn judge(
    source: &Source<'_>,
    splices: &[Splice],
    tree: &Tree,
    meant: &Document,
) -> Result<(), Refusal> {
    judge_problems(source, splices, tree)?;
    let (read, meant) = (&tree.document.items, &meant.items);
    if read.len() == meant.len() && read.iter().zip(meant).all(|(a, b)| same(a, b)) {
        return Ok(());
    }
    Err(unwritable())
}

pub(crate) fn unwritable() -> Refusal {
    Refusal::new(say!("this cannot be written into the text as it stands here; change the text itself"))
}

/// True if two items mean the same: the empty braces of a step mean nothing.
fn same(a: &Item, b: &Item) -> bool {
    let (Item::Chart(a), Item::Chart(b)) = (a, b) else { return a == b };
    let Chart { kind, name, params, block, comment, every, items, at: _ } = a;
    (kind, name, params, block, comment, every)
        == (&b.kind, &b.name, &b.params, &b.block, &b.comment, &b.every)
        && items.len() == b.items.len()
        && items.iter().zip(&b.items).all(|(a, b)| match (a, b) {
            (ChartItem::Step(a), ChartItem::Step(b)) => same_step(a, b),
            _ => a == b,
        })
}

fn same_step(a: &Step, b: &Step) -> bool {
    let Step { name, kind, initial, linked, comment, actions, braces: _, at: _ } = a;
    (name, kind, initial, linked, comment, actions)
        == (&b.name, &b.kind, &b.initial, &b.linked, &b.comment, &b.actions)
}
