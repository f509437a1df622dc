//! The reader of a record, beside a writer or without one.

use std::path::Path;

use g7_host::Kind;
use rusqlite::Connection;

use super::packed::{Changes, take_batch};
use super::{Clock, KIND, LAYOUTS, Signal, kind_of};
use crate::file::{StoreError, read};

/// A span of the record, without a gap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// Its first instant and its last one, in us of the record.
    pub start: i64,
    /// See `start`.
    pub stop: i64,
    /// Changes before it that were lost; 0 where the controller was off.
    pub lost: u64,
}

/// The signals and the span of a record.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Overview {
    /// Its signals, with their numbers.
    pub signals: Vec<(i64, Signal)>,
    /// Its spans, in the order of time.
    pub spans: Vec<Span>,
    /// The wall clock beside it.
    pub clock: Clock,
    /// Changes before this were deleted, in us of the record.
    pub from: i64,
    /// The last instant.
    pub until: i64,
}

impl Overview {
    /// The signals of a name: several where its type was another one in a chart before.
    pub fn named<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a (i64, Signal)> {
        self.signals.iter().filter(move |(_, signal)| signal.name.eq_ignore_ascii_case(name))
    }
}

/// A part of the values of a signal, as a visitor sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Seen {
    /// A value from an instant on.
    Value(i64, u64),
    /// Nothing is known from an instant on.
    Unknown(i64),
    /// Several changes, passed over.
    Many {
        /// The first instant.
        start: i64,
        /// The last instant.
        stop: i64,
        /// The number of changes.
        count: u64,
        /// The least and the greatest value, as numbers.
        range: Option<(f64, f64)>,
        /// The last value.
        last: u64,
    },
}

/// The reader of a record.
pub struct Reader {
    file: Connection,
}

impl Reader {
    /// Opens a record. All that one reader reads is of one instant.
    ///
    /// # Errors
    ///
    /// There is no such file, it is none of a record, or cannot be read.
    pub fn open(path: &Path) -> Result<Reader, StoreError> {
        let file = read(path, KIND, LAYOUTS)?;
        file.execute_batch("BEGIN")?;
        Ok(Reader { file })
    }

    /// The signals and the span of the record.
    ///
    /// # Errors
    ///
    /// The file cannot be read.
    pub fn overview(&self) -> Result<Overview, StoreError> {
        let mut signals = Vec::new();
        let mut rows =
            self.file.prepare("SELECT id, name, kind, class, type, comment FROM signal ORDER BY id")?;
        let mut rows = rows.query(())?;
        while let Some(row) = rows.next()? {
            if let Some(kind) = kind_of(&row.get::<_, String>(2)?) {
                let (name, class, ty, comment) = (row.get(1)?, row.get(3)?, row.get(4)?, row.get(5)?);
                signals.push((row.get(0)?, Signal { name, kind, class, ty, comment }));
            }
        }
        let from: i64 =
            self.file.query_row("SELECT coalesce(max(start), 0) FROM kept", (), |row| row.get(0))?;
        let mut rows = self.file.prepare("SELECT start, stop, lost FROM span ORDER BY id")?;
        let spans = rows
            .query_map((), |row| {
                let lost = row.get::<_, i64>(2)?.cast_unsigned();
                Ok(Span { start: row.get(0)?, stop: row.get(1)?, lost })
            })?
            .collect::<Result<Vec<_>, _>>()?;
        let mut rows = self.file.prepare("SELECT at, utc FROM clock ORDER BY at")?;
        let marks = rows.query_map((), |row| Ok((row.get(0)?, row.get(1)?)))?.collect::<Result<_, _>>()?;
        let until = spans.last().map_or(from, |span| span.stop);
        Ok(Overview { signals, spans, clock: Clock::new(marks), from, until })
    }

    /// Shows the values of a signal from one time of the record to another: that which stands at the
    /// first, then its changes. Several changes are passed over where `fits` says so of their first and
    /// last instant.
    ///
    /// # Errors
    ///
    /// The file cannot be read.
    pub fn visit(
        &self,
        overview: &Overview,
        (signal, kind): (i64, Kind),
        (from, to): (i64, i64),
        fits: impl Fn(i64, i64) -> bool,
        see: impl FnMut(Seen),
    ) -> Result<(), StoreError> {
        let from = from.max(overview.from);
        let spans = within(&overview.spans, from, to);
        let mut walk = Walk { spans, from, to, before: None, known: false, see };
        let alone = |start, stop| {
            let behind = spans.partition_point(|span| span.start <= start);
            spans.get(behind).is_none_or(|next| next.start > stop) && start > from && stop <= to
        };
        let mut rows = self.file.prepare_cached(
            "SELECT start, stop, count, low, high, last, data FROM chunk WHERE signal = ?1 AND start >= ?2
             AND start <= ?3 ORDER BY start, id",
        )?;
        // The chunk in which the value of the first instant stands.
        let first: Option<i64> = self.file.query_row(
            "SELECT max(start) FROM chunk WHERE signal = ?1 AND start <= ?2",
            (signal, from),
            |row| row.get(0),
        )?;
        let mut rows = rows.query((signal, first.unwrap_or(from), to))?;
        while let Some(row) = rows.next()? {
            let (start, stop): (i64, i64) = (row.get(0)?, row.get(1)?);
            if fits(start, stop) && alone(start, stop) {
                let range = row.get::<_, Option<f64>>(3)?.zip(row.get(4)?);
                let (count, last) = (row.get::<_, i64>(2)?, row.get::<_, i64>(5)?);
                let (count, last) = (count.cast_unsigned(), last.cast_unsigned());
                walk.many(Seen::Many { start, stop, count, range, last }, start);
                continue;
            }
            let data = row.get_ref(6)?.as_blob().unwrap_or(&[]);
            Changes::new(kind, start, data).for_each(|(at, word)| walk.change(at, word));
        }
        let mut rows = self.file.prepare_cached("SELECT data FROM tail ORDER BY id")?;
        let mut rows = rows.query(())?;
        while let Some(row) = rows.next()? {
            let mut batch = row.get_ref(0)?.as_blob().unwrap_or(&[]);
            while let Some((of, start, data)) = take_batch(&mut batch) {
                if of == signal {
                    Changes::new(kind, start, data).for_each(|(at, word)| walk.change(at, word));
                }
            }
        }
        walk.end();
        Ok(())
    }
}

/// The spans that have a part between two times.
fn within(spans: &[Span], from: i64, to: i64) -> &[Span] {
    let first = spans.partition_point(|span| span.stop < from);
    let behind = spans.partition_point(|span| span.start <= to);
    spans.get(first..behind.max(first)).unwrap_or(&[])
}

/// Walks along the spans and the changes of a signal.
struct Walk<'a, F: FnMut(Seen)> {
    /// The present span is the first one.
    spans: &'a [Span],
    from: i64,
    to: i64,
    /// The last change before `from`.
    before: Option<(i64, u64)>,
    known: bool,
    see: F,
}

impl<F: FnMut(Seen)> Walk<'_, F> {
    fn change(&mut self, at: i64, word: u64) {
        if at <= self.from {
            self.before = Some((at, word));
            return;
        }
        if at > self.to {
            return;
        }
        self.arrive(at);
        (self.see)(Seen::Value(at, word));
        self.known = true;
    }

    fn many(&mut self, many: Seen, start: i64) {
        self.arrive(start);
        (self.see)(many);
        self.known = true;
    }

    /// Shows the value that stands at the begin, if the first span has one.
    fn stand(&mut self) {
        let Some((at, word)) = self.before.take() else { return };
        while let [_, next, ..] = self.spans
            && next.start <= self.from
        {
            self.spans = self.spans.get(1..).unwrap_or(&[]);
        }
        // A span has the values of all its signals from its begin on.
        if self.spans.first().is_some_and(|span| span.start <= at) {
            (self.see)(Seen::Value(self.from, word));
            self.known = true;
        }
    }

    /// Goes on to the span of a change.
    fn arrive(&mut self, at: i64) {
        self.stand();
        while let [now, next, ..] = self.spans {
            if next.start > at {
                break;
            }
            self.spans = self.spans.get(1..).unwrap_or(&[]);
            let goes_on = next.start == now.stop && next.start == at;
            if self.known && !goes_on {
                (self.see)(Seen::Unknown(now.stop));
                self.known = false;
            }
        }
    }

    /// Shows where the values end.
    fn end(&mut self) {
        self.stand();
        if let Some(span) = self.spans.first().filter(|_| self.known)
            && (self.spans.len() > 1 || span.stop < self.to)
        {
            (self.see)(Seen::Unknown(span.stop));
        }
    }
}
