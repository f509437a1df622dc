//! A text with everything that could be read of it, kept over changes of the text.
//!
//! ```text
//! text -> Tree::read -> document, notes, problems  -> compile, draw, edit, print
//!           ^   | marks between the items (parse/marks.rs)
//!           |   v
//!        Tree::change: the items that the change touches are read anew, what lies behind them moves
//! ```
//!
//! # What must hold
//!
//! After a change the tree is exactly what [`Tree::read`] makes of the new text: document, places, notes
//! and problems, in their order. The property test in `tests/all/tree.rs` compares all of them.

use std::ops::Range;

use crate::decode;
use crate::parse::marks::{Change, Level, Mark};
use crate::parse::reading::{Begin, Reading, read};
use g7_model::{ChartItem, Document, FileId, Item, PlaceAt, Problem, places::Shift};

/// A text, its document and its problems.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tree {
    /// The text.
    pub text: String,
    /// The document, with the notes of the text.
    pub document: Document,
    /// The problems, in the order of the text.
    pub problems: Vec<Problem>,
    /// The places at which a change can begin and end to read.
    pub marks: Marks,
}

/// The places of a text at which reading can begin and end, kept beside its document. Where nothing is known
/// yet, the first change reads the whole text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Marks {
    file: FileId,
    list: Vec<Mark>,
    /// The problems in the order in which they were found; `None` if there are more than are kept.
    found: Option<Vec<Problem>>,
    reread: usize,
}

/// Changes with less text between them are read as one.
const NEAR: usize = 400;

/// More changes than this are read as one.
const MOST: usize = 8;

impl Marks {
    /// Nothing is known of the text of a file.
    pub fn none(file: FileId) -> Marks {
        Marks { file, ..Marks::default() }
    }

    /// How many bytes the last reading has read.
    pub fn reread(&self) -> usize {
        self.reread
    }
}

impl Tree {
    /// Reads a text.
    pub fn read(text: String, file: FileId) -> Tree {
        let mut tree = Tree { text, marks: Marks::none(file), ..Tree::default() };
        tree.read_whole();
        tree
    }

    /// Changes the text: each range of bytes of the present text is replaced by the words. The ranges are
    /// in order and do not overlap. Returns false, and changes nothing, if they do not fit the text.
    #[inline(never)]
    pub fn change(&mut self, edits: &[(Range<usize>, &str)]) -> bool {
        let mut last = 0;
        for (range, _) in edits {
            if range.start < last || self.text.get(range.clone()).is_none() {
                return false;
            }
            last = range.end;
        }
        self.marks.reread = 0;
        // From the last to the first, so that the places of the others stay.
        for (range, words) in self.joined(edits).into_iter().rev() {
            self.replace(range, &words);
        }
        true
    }

    /// The same changes, with those that are near each other as one.
    #[inline(never)]
    fn joined(&self, edits: &[(Range<usize>, &str)]) -> Vec<(Range<usize>, String)> {
        let one = edits.len() > MOST || self.marks.found.is_none();
        let near = if one { usize::MAX } else { NEAR };
        let mut out: Vec<(Range<usize>, String)> = Vec::new();
        for (range, words) in edits {
            match out.last_mut() {
                Some((before, text)) if range.start - before.end <= near => {
                    text.push_str(self.text.get(before.end..range.start).unwrap_or_default());
                    text.push_str(words);
                    before.end = range.end;
                }
                _ => out.push((range.clone(), (*words).to_owned())),
            }
        }
        out
    }

    #[inline(never)]
    fn read_whole(&mut self) {
        self.marks.reread += self.text.len();
        self.document = Document::default();
        (self.marks.list, self.marks.found) = (Vec::new(), None);
        if let Some(problem) = decode::too_large(self.text.len(), self.marks.file) {
            self.problems = vec![problem];
            return;
        }
        let Reading { items, notes, mut problems, marks, .. } =
            read(&self.text, self.marks.file, Begin::default());
        self.document = Document { items, notes };
        self.marks.list = marks;
        self.problems = problems.clone().finish();
        self.marks.found = problems.split_off(0);
    }

    /// Makes one change and reads what it touches.
    #[inline(never)]
    fn replace(&mut self, range: Range<usize>, words: &str) {
        let change = Change { start: range.start, end: range.end, now: range.start + words.len() };
        let begin = self.marks.list.partition_point(|m| m.start() < change.start);
        let begin = (0..begin)
            .rev()
            .find(|n| self.marks.list.get(*n).is_some_and(|mark| mark.is_before(&self.text, change.start)));
        self.text.replace_range(range, words);
        let fits = decode::too_large(self.text.len(), self.marks.file).is_none();
        let found = self.marks.found.take().filter(|_| fits);
        if found.and_then(|found| self.read_part(change, begin, found)).is_none() {
            self.read_whole();
        }
    }

    /// Reads from the mark on until the rest is known. `None` if there are then too many problems; the
    /// document is lost in that case.
    #[inline(never)]
    fn read_part(&mut self, change: Change, begin: Option<usize>, mut found: Vec<Problem>) -> Option<()> {
        let mut marks = std::mem::take(&mut self.marks.list);
        let mut document = std::mem::take(&mut self.document);
        let before = marks.split_off(begin.map_or(0, |n| n + 1));
        let (base, start) = marks.last().map_or((Base::default(), 0), |m| (Base::of(m), m.start()));
        let mut known = Known {
            found: found.split_off(base.problems.min(found.len())),
            notes: document.notes.split_off(base.notes.min(document.notes.len())),
            items: document.items.split_off(base.items.min(document.items.len())),
            inner: None,
        };
        if base.level != Level::File {
            // The chart or the layout in which reading begins: its first part stays in the document.
            let mut item = known.items.remove(0);
            known.inner = Inner::split(&mut item, base.inner);
            document.items.push(item);
        }
        let parts = Begin { document, problems: found, marks, before, change: Some(change) };
        let mut reading = read(&self.text, self.marks.file, parts);
        self.marks.reread += reading.end - start.min(reading.end);
        if let Some(met) = reading.met {
            known.join(&mut reading, met, &base, change)?;
        }
        self.document = Document { items: reading.items, notes: reading.notes };
        self.problems = reading.problems.clone().finish();
        self.marks.found = Some(reading.problems.split_off(0)?);
        self.marks.list = reading.marks;
        Some(())
    }
}

/// The parts that are complete at the mark at which a reading begins.
struct Base {
    level: Level,
    items: usize,
    inner: usize,
    notes: usize,
    problems: usize,
}

impl Default for Base {
    fn default() -> Base {
        Base { level: Level::File, items: 0, inner: 0, notes: 0, problems: 0 }
    }
}

impl Base {
    fn of(mark: &Mark) -> Base {
        let Mark { level, items, inner, notes, problems, .. } = *mark;
        Base { level, items, inner, notes, problems }
    }
}

/// The parts known of the text behind the mark at which the reading began.
struct Known {
    found: Vec<Problem>,
    notes: Vec<g7_model::Note>,
    items: Vec<Item>,
    /// The second part of the chart or the layout in which the reading began.
    inner: Option<Inner>,
}

/// Items of a chart or of a layout, and the end of it.
enum Inner {
    Chart(Vec<ChartItem>, u32),
    Layout(Vec<PlaceAt>, u32),
}

impl Inner {
    /// Takes the items from a number on.
    fn split(item: &mut Item, at: usize) -> Option<Inner> {
        match item {
            Item::Chart(c) => Some(Inner::Chart(c.items.split_off(at.min(c.items.len())), c.at.0.end)),
            Item::Layout(l) => Some(Inner::Layout(l.places.split_off(at.min(l.places.len())), l.at.0.end)),
            _ => None,
        }
    }

    /// How many items an item of the file has.
    fn count(item: &Item) -> usize {
        match item {
            Item::Chart(c) => c.items.len(),
            Item::Layout(l) => l.places.len(),
            _ => 0,
        }
    }

    /// The items behind the first so many.
    fn without(self, count: usize) -> Inner {
        match self {
            Inner::Chart(mut items, end) => Inner::Chart(items.split_off(count.min(items.len())), end),
            Inner::Layout(mut places, end) => Inner::Layout(places.split_off(count.min(places.len())), end),
        }
    }

    /// Puts the items behind those of an item of the file, which ends where they did.
    #[inline(never)]
    fn join(self, item: Option<&mut Item>, by: i32) {
        match (self, item) {
            (Inner::Chart(mut items, end), Some(Item::Chart(c))) => {
                items.shift(by);
                c.items.append(&mut items);
                c.at.0.end = end.saturating_add_signed(by);
            }
            (Inner::Layout(mut places, end), Some(Item::Layout(l))) => {
                places.shift(by);
                l.places.append(&mut places);
                l.at.0.end = end.saturating_add_signed(by);
            }
            _ => {}
        }
    }
}

impl Known {
    /// Appends the known rest of the text to the part that was read anew. The rest begins at the mark `met`.
    /// `None` if there are then too many problems.
    #[inline(never)]
    fn join(mut self, reading: &mut Reading, met: usize, base: &Base, change: Change) -> Option<()> {
        let by = change.by();
        let mut marks = reading.before.split_off(met.min(reading.before.len()));
        let end = Base::of(marks.first()?);
        let now = Base {
            level: end.level,
            items: reading.items.len() - usize::from(end.level != Level::File),
            inner: reading.items.last().filter(|_| end.level != Level::File).map_or(0, Inner::count),
            notes: reading.notes.len(),
            problems: reading.problems.len(),
        };
        for mark in &mut marks {
            if mark.level == end.level {
                mark.inner = mark.inner + now.inner - end.inner;
            }
            mark.items = mark.items + now.items - end.items;
            mark.notes = mark.notes + now.notes - end.notes;
            mark.problems = mark.problems + now.problems - end.problems;
            mark.follow(change, reading.seen);
        }
        reading.marks.append(&mut marks);

        // The chart or the layout in which the reading began is no longer among the items.
        let taken = usize::from(self.inner.is_some());
        let mut items = self.items.split_off((end.items - base.items).saturating_sub(taken));
        if end.level != Level::File {
            let inner = match self.inner.take().filter(|_| end.items == base.items) {
                Some(inner) => Some(inner.without(end.inner - base.inner)),
                None => Inner::split(&mut items.remove(0), end.inner),
            };
            inner?.join(reading.items.last_mut(), by);
        }
        items.shift(by);
        reading.items.append(&mut items);

        let mut notes = self.notes.split_off(end.notes - base.notes);
        notes.shift(by);
        reading.notes.append(&mut notes);

        let mut found = self.found.split_off(end.problems - base.problems);
        found.iter_mut().for_each(|problem| shift_problem(problem, change));
        reading.problems = std::mem::take(&mut reading.problems).and(found)?;
        Some(())
    }
}

fn shift_problem(problem: &mut Problem, change: Change) {
    let Problem { code: _, at, what: _, related, help: _, fixes } = problem;
    *at = change.moved(*at);
    related.iter_mut().for_each(|(at, _)| *at = change.moved(*at));
    fixes.iter_mut().flat_map(|fix| &mut fix.edits).for_each(|edit| edit.at = change.moved(edit.at));
}
