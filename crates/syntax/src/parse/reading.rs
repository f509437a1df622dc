//! Reads a text from a mark on, and sets marks on the way.
//!
//! `marks` has the places; here is the parser's part: it begins at a mark with the state that the mark
//! holds, and ends at the first one from which on all is known.

use super::marks::{Change, Level, Mark, Marks};
use super::{Parser, extent::Extent};
use crate::lexer::Tok;
use crate::problems::Problems;
use g7_model::{Document, FileId, Item, Note, Problem};

/// All that a reading gives. Notes and problems are those of the text up to where it ended.
pub(crate) struct Reading {
    pub(crate) items: Vec<Item>,
    pub(crate) notes: Vec<Note>,
    pub(crate) problems: Problems,
    pub(crate) marks: Vec<Mark>,
    /// The marks of the text before, and which of them the reading met.
    pub(crate) before: Vec<Mark>,
    pub(crate) met: Option<usize>,
    /// Where it ended: the mark met, or the end of the text.
    pub(crate) end: usize,
    /// One past the last byte of all tokens that were looked at.
    pub(crate) seen: usize,
}

/// The state in which a reading begins.
#[derive(Default)]
pub(crate) struct Begin {
    /// The items before the mark. If it lies in a chart or a layout, this is the last of them.
    pub(crate) document: Document,
    pub(crate) problems: Vec<Problem>,
    /// The marks up to that at which it begins, which is the last one.
    pub(crate) marks: Vec<Mark>,
    /// The marks behind it.
    pub(crate) before: Vec<Mark>,
    pub(crate) change: Option<Change>,
}

/// Reads a text from a mark to its end, or to a mark from which on all is known.
pub(crate) fn read(text: &str, file: FileId, begin: Begin) -> Reading {
    let Begin { document, problems, marks: list, before, change } = begin;
    let Document { mut items, notes } = document;
    let from = list.last().cloned();
    let mut parser = match &from {
        None => Parser::new(text, file),
        Some(mark) => Parser::portion(text, file, mark.start()),
    };
    parser.marks = Some(Box::new(Marks { list, before, change, items: 0, met: None }));
    if let Some(mark) = from {
        parser.lexer.notes = notes;
        parser.lexer.problems = Problems::of(problems);
        parser.lexer.seen.set(parser.lexer.seen.get().max(mark.seen));
        parser.cur.newline = true;
        parser.prev = mark.prev;
        parser.go_on(&mut items, mark.level);
    }
    if parser.marks.as_ref().is_some_and(|m| m.met.is_none()) {
        parser.items(&mut items);
    }
    let Marks { list, before, met, .. } = parser.marks.take().map_or_else(Marks::default, |m| *m);
    let (end, seen) = (parser.cur.start as usize, parser.lexer.seen.get());
    let (notes, problems) = (parser.lexer.notes, parser.lexer.problems);
    Reading { items, notes, problems, marks: list, before, met, end, seen }
}

impl Parser<'_> {
    /// Reads the rest of the chart or the layout that is the last item.
    fn go_on(&mut self, items: &mut Vec<Item>, level: Level) {
        let last = if level == Level::File { None } else { items.pop() };
        if let Some(marks) = &mut self.marks {
            marks.items = items.len();
        }
        let item = match (last, level) {
            (Some(Item::Chart(mut chart)), Level::Chart(open)) => {
                self.chart_items(&mut chart.items, open);
                chart.at = self.since(chart.at.0.start).into();
                Some(Item::Chart(chart))
            }
            (Some(Item::Layout(mut layout)), Level::Layout(open)) => {
                self.places(&mut layout.places, open);
                layout.at = self.since(layout.at.0.start).into();
                Some(Item::Layout(layout))
            }
            (last, _) => last,
        };
        items.extend(item);
    }

    /// Sets a mark before an item, where `count` items of this level are complete. Returns true if all
    /// that follows is known.
    pub(super) fn mark(&mut self, count: usize, level: Level) -> bool {
        let Some(marks) = &mut self.marks else { return false };
        if marks.met.is_some() {
            return true;
        }
        if level == Level::File {
            marks.items = count;
        }
        let start = self.cur.start;
        let plain = self.cur.newline
            && !matches!(self.cur.kind, Tok::End | Tok::Line)
            && self.next.is_none()
            && self.nested == 0
            && self.prefixes.is_empty()
            && self.lines.extent == Extent::Free
            && self.lines.base == 0
            && self.lines.behind.is_none()
            && self.lines.ran_on.is_none()
            && self.told.is_none_or(|told| told < start)
            && self.corrected.is_none_or(|(at, _)| at < self.prev.start);
        if !plain {
            return false;
        }
        let mark = Mark {
            cur: self.cur,
            prev: self.prev,
            level,
            items: marks.items,
            inner: if level == Level::File { 0 } else { count },
            notes: self.lexer.notes.len(),
            problems: self.lexer.problems.len(),
            seen: self.lexer.seen.get(),
        };
        marks.met = marks.known(self.text, &mark);
        if marks.met.is_none() && marks.list.last().is_none_or(|m| (m.cur, m.level) != (mark.cur, level)) {
            marks.list.push(mark);
        }
        marks.met.is_some()
    }
}
