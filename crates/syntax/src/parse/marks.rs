//! Marks: places of a text at which reading can begin again, or end because the rest is known.
//!
//! A mark stands at the head of a loop over the items of a file, a chart or a layout, before an item that
//! begins its line. It holds all of the parser's state that what follows depends on. Two readings that
//! come to a mark with the same state and the same text behind it go on in the same way; this is why
//! [`crate::Tree`] may keep what it has read before a change and behind it.
//!
//! # What must hold
//!
//! - A mark is set only where the parser is in its plain state: nothing read ahead, no bracket or line
//!   that ends a construct, no problem told at the token in hand. All other state is in the mark.
//! - The text before [`Mark::seen`], up to the end of that line, has decided what the mark holds; the text
//!   behind it has not.

use super::{Parser, extent::Extent};
use crate::lexer::{Tok, Token};
use crate::problems::Problems;
use g7_model::{Document, FileId, Item, Note, Problem, Span, places::Shift};

/// The loop that a mark belongs to, with the place of its opening brace.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Level {
    File,
    Chart(Span),
    Layout(Span),
}

impl Level {
    fn moved(self, change: Change) -> Level {
        match self {
            Level::File => Level::File,
            Level::Chart(open) => Level::Chart(change.moved(open)),
            Level::Layout(open) => Level::Layout(change.moved(open)),
        }
    }
}

/// A place between two items.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Mark {
    /// The first token of the item behind it.
    cur: Token,
    prev: Token,
    pub(crate) level: Level,
    /// How many items of the file are complete here.
    pub(crate) items: usize,
    /// How many items of the chart or the layout.
    pub(crate) inner: usize,
    pub(crate) notes: usize,
    /// How many problems were found, in the order in which they were found.
    pub(crate) problems: usize,
    /// One past the last byte of all tokens that were looked at.
    seen: usize,
}

impl Mark {
    pub(crate) fn start(&self) -> usize {
        self.cur.start as usize
    }

    /// True if a change of the text from this byte on changes nothing before the mark.
    pub(crate) fn is_before(&self, text: &str, change: usize) -> bool {
        // What ends a token is decided within its line.
        let line_end = |rest: &str| rest.find('\n').map(|n| self.seen + n + 1);
        self.seen < change && text.get(self.seen..).and_then(line_end).is_some_and(|end| end <= change)
    }

    /// Moves the mark with the text behind a change. The text up to `seen` was looked at before it.
    pub(crate) fn follow(&mut self, change: Change, seen: usize) {
        let by = change.by();
        (self.cur, self.prev) = (moved(self.cur, by), moved(self.prev, by));
        self.level = self.level.moved(change);
        self.seen = self.seen.saturating_add_signed(by as isize).max(seen);
    }
}

/// A change of the text: the bytes `start..end` have become `start..now`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Change {
    pub(crate) start: usize,
    pub(crate) end: usize,
    pub(crate) now: usize,
}

impl Change {
    /// How many bytes longer the text has become.
    pub(crate) fn by(self) -> i32 {
        let clip = |n: usize| i32::try_from(n).unwrap_or(i32::MAX);
        clip(self.now) - clip(self.end)
    }

    /// Where a place before or behind the change stands now.
    pub(crate) fn moved(self, mut at: Span) -> Span {
        if at.start as usize >= self.end {
            at.shift(self.by());
        }
        at
    }
}

/// The marks of the reading in hand, and those of the reading before.
#[derive(Debug, Default)]
pub(crate) struct Marks {
    pub(crate) list: Vec<Mark>,
    /// The marks of the text before the change.
    before: Vec<Mark>,
    change: Option<Change>,
    /// How many items of the file are complete.
    items: usize,
    /// The place in `before` of the mark behind which the rest is known.
    met: Option<usize>,
}

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

/// What a reading begins with.
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

impl Marks {
    /// The mark of the text before that is the same as this one, if it lies behind the change.
    fn known(&self, text: &str, mark: &Mark) -> Option<usize> {
        let change = self.change?;
        let by = change.by();
        // The line of the token before the mark has not changed either: messages quote from it.
        let between = text.get(change.now..mark.prev.start as usize)?;
        if !between.contains('\n') {
            return None;
        }
        let old = self.before.partition_point(|m| moved(m.cur, by).start < mark.cur.start);
        let same = |m: &Mark| {
            m.start() >= change.end
                && moved(m.cur, by) == mark.cur
                && moved(m.prev, by) == mark.prev
                && m.level.moved(change) == mark.level
        };
        let here = self.before.get(old..)?.iter().take_while(|m| moved(m.cur, by).start == mark.cur.start);
        here.enumerate().find(|(_, m)| same(m)).map(|(n, _)| old + n)
    }
}

fn moved(token: Token, by: i32) -> Token {
    Token { start: token.start.saturating_add_signed(by), end: token.end.saturating_add_signed(by), ..token }
}
