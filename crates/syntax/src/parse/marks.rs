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

use crate::lexer::Token;
use g7_model::{Span, places::Shift};

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
    pub(super) cur: Token,
    pub(super) prev: Token,
    pub(crate) level: Level,
    /// How many items of the file are complete here.
    pub(crate) items: usize,
    /// How many items of the chart or the layout.
    pub(crate) inner: usize,
    pub(crate) notes: usize,
    /// How many problems were found, in the order in which they were found.
    pub(crate) problems: usize,
    /// One past the last byte of all tokens that were looked at.
    pub(super) seen: usize,
}

impl Mark {
    pub(crate) fn start(&self) -> usize {
        self.cur.start as usize
    }

    /// True if a change of the text from this byte on changes nothing before the mark.
    pub(crate) fn is_before(&self, text: &str, change: usize) -> bool {
        // The end of a token is decided within its line.
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
    pub(super) before: Vec<Mark>,
    pub(super) change: Option<Change>,
    /// How many items of the file are complete.
    pub(super) items: usize,
    /// The place in `before` of the mark behind which the rest is known.
    pub(super) met: Option<usize>,
}

impl Marks {
    /// The mark of the text before that is the same as this one, if it lies behind the change.
    pub(super) fn known(&self, text: &str, mark: &Mark) -> Option<usize> {
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
