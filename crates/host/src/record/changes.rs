//! The changes of one signal: for each of them the instant and the words of the value, one behind the
//! other in a ring.
//!
//! The ring has room from the start. When that is used up it doubles, which a recording with a limit
//! does no more once it has reached the limit; so scans do not allocate, except a few at first.

use std::collections::VecDeque;

use g7_model::Nanos;

use super::value::{Kind, Sample, Value};
use crate::text::read_text;

#[derive(Clone, Debug)]
pub(super) struct Changes {
    words: VecDeque<u64>,
    /// Words of one change: the instant and the value.
    width: usize,
    /// Changes to make room for.
    room: usize,
    /// The last value, if there is one and it has one word: most values do not change, and this is
    /// what a scan looks at.
    last: Option<u64>,
}

impl Changes {
    /// Nothing yet; the room is made with the first value, which shows how many words it needs.
    pub(super) fn new(room: usize) -> Changes {
        Changes { words: VecDeque::new(), width: 2, room, last: None }
    }

    pub(super) fn len(&self) -> usize {
        self.words.len() / self.width
    }

    fn instant(&self, i: usize) -> Nanos {
        Nanos::new(self.words.get(i * self.width).copied().unwrap_or(0) as i64)
    }

    pub(super) fn instants(&self) -> impl Iterator<Item = Nanos> + '_ {
        (0..self.len()).map(|i| self.instant(i))
    }

    fn value(&self, i: usize) -> impl Iterator<Item = u64> + '_ {
        self.words.iter().skip(i * self.width + 1).take(self.width - 1).copied()
    }

    /// A change, with its value as one of this kind.
    pub(super) fn get(&self, i: usize, kind: Kind) -> (Nanos, Value) {
        let value = match kind {
            Kind::Text => Value::Text(read_text(&self.value(i).collect::<Vec<u64>>(), 0).into()),
            Kind::Bool | Kind::Int { .. } | Kind::Real | Kind::Lreal | Kind::Time | Kind::Moment(_) => {
                Value::Word(self.value(i).next().unwrap_or(0))
            }
        };
        (self.instant(i), value)
    }

    /// The number of changes that were made until an instant.
    pub(super) fn until(&self, instant: Nanos) -> usize {
        let (mut low, mut high) = (0, self.len());
        while low < high {
            let middle = low + (high - low) / 2;
            if self.instant(middle) <= instant {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        low
    }

    /// True if the last value is this one.
    #[inline(always)]
    pub(super) fn ends_with(&self, value: &Sample<'_>) -> bool {
        match value {
            Sample::Word(word) => {
                self.last == Some(*word) || (self.width > 2 && self.ends_with_words(&[*word]))
            }
            Sample::Text(words) => self.ends_with_words(words),
        }
    }

    fn ends_with_words(&self, value: &[u64]) -> bool {
        self.len() > 0 && self.value(self.len() - 1).eq(self.padded(value))
    }

    /// Brings the last value up to date.
    fn settle(&mut self) {
        self.last = self.words.back().copied().filter(|_| self.width == 2);
    }

    /// Adds a value that is not the last one. A change at the same instant is replaced; with more
    /// changes than the limit the oldest one goes.
    pub(super) fn add(&mut self, now: Nanos, value: &[u64], limit: usize) {
        if self.width <= value.len() || self.words.is_empty() {
            self.widen(value.len() + 1, limit);
        }
        if let Some(last) = self.len().checked_sub(1).filter(|last| self.instant(*last) == now) {
            self.truncate(last);
            if self.ends_with_words(value) {
                return;
            }
        }
        if self.len() >= limit {
            self.words.drain(..self.width);
        }
        self.words.push_back(now.count() as u64);
        self.words.extend(self.padded(value));
        self.settle();
    }

    /// A value with as many words as there is room for in a change. The text of a variable may be
    /// shorter than it was in another version of a chart.
    fn padded<'a>(&self, value: &'a [u64]) -> impl Iterator<Item = u64> + use<'a> {
        let padding = (self.width - 1).saturating_sub(value.len());
        value.iter().copied().chain(std::iter::repeat_n(0, padding))
    }

    /// Makes room for values of so many words, those that are there included.
    #[cold]
    fn widen(&mut self, width: usize, limit: usize) {
        let mut words = VecDeque::with_capacity(width * self.room.min(limit).max(self.len() + 1));
        for i in 0..self.len() {
            words.push_back(self.instant(i).count() as u64);
            words.extend(self.value(i));
            words.resize((i + 1) * width, 0);
        }
        (self.words, self.width) = (words, width);
        self.settle();
    }

    /// Keeps so many changes, the oldest.
    pub(super) fn truncate(&mut self, count: usize) {
        self.words.truncate(count * self.width);
        self.settle();
    }

    /// The changes between two instants, the first of them with the value that stands there.
    pub(super) fn part(&self, from: Nanos, to: Nanos) -> Changes {
        let known = self.until(from);
        let (first, behind) = (known.saturating_sub(1), self.until(to).max(known));
        let range = first * self.width..behind * self.width;
        let mut words: VecDeque<u64> = self.words.range(range).copied().collect();
        if let Some(instant) = words.front_mut()
            && (*instant as i64) < from.count()
        {
            *instant = from.count() as u64;
        }
        let mut part = Changes { words, width: self.width, room: self.room, last: None };
        part.settle();
        part
    }
}
