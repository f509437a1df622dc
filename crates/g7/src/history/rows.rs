//! The values of a record in the order of time, for files that others read: a row for each change, and one
//! without a value where nothing is known any more.

use std::io::{self, Write};

use g7_host::{Value, csv_cell, csv_quote};
use g7_model::Nanos;
use g7_store::StoreError;
use g7_store::history::{Overview, Reader, Seen, Signal};

use super::time;

/// The span of the record that is read at once, in us: it becomes longer where little happens.
const FIRST: i64 = 600_000_000;
const LEAST: i64 = 1_000_000;
const MOST: i64 = 86_400_000_000;
/// Rows that are read at once: fewer than this many, and more than so few.
const ROWS: (usize, usize) = (50_000, 500_000);

/// A change of one signal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row<'a> {
    /// The time of day, in us since 1970.
    pub(crate) utc: i64,
    /// The time of the record, in us.
    pub(crate) at: i64,
    /// The number of the signal among those that were asked for.
    pub(crate) number: usize,
    pub(crate) signal: &'a Signal,
    /// The value from here on; `None` where it is not known.
    pub(crate) word: Option<u64>,
}

/// Takes rows.
pub(crate) trait Sink {
    /// # Errors
    ///
    /// The file cannot be written, or would be too long.
    fn row(&mut self, row: &Row<'_>) -> io::Result<()>;
}

/// Why rows cannot be given.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Broken {
    #[error("{0}")]
    Record(#[from] StoreError),
    #[error("{0}")]
    Out(#[from] io::Error),
}

/// Gives the rows of some signals, by number, between two times of the record.
pub(crate) fn rows(
    reader: &Reader,
    overview: &Overview,
    signals: &[(i64, Signal)],
    (from, to): (i64, i64),
    sink: &mut impl Sink,
) -> Result<(), Broken> {
    let (mut begin, mut length) = (from.max(overview.from), FIRST);
    let to = to.min(overview.until);
    let mut first = true;
    while first || begin < to {
        let end = begin.saturating_add(length).min(to);
        let mut found = Vec::new();
        for (number, (id, signal)) in signals.iter().enumerate() {
            let see = |seen| match seen {
                // The value that stands at the begin of a later part was given before.
                Seen::Value(at, _) if !first && at <= begin => {}
                Seen::Value(at, word) => found.push((at, number, Some(word))),
                Seen::Unknown(at) => found.push((at, number, None)),
                // Nothing is passed over.
                Seen::Many { .. } => {}
            };
            reader.visit(overview, (*id, signal.kind), (begin, end), |_, _| false, see)?;
        }
        found.sort_by_key(|(at, number, _)| (*at, *number));
        for (at, number, word) in &found {
            let Some((_, signal)) = signals.get(*number) else { continue };
            sink.row(&Row { utc: overview.clock.utc(*at), at: *at, number: *number, signal, word: *word })?;
        }
        if found.len() < ROWS.0 {
            length = (length * 2).min(MOST);
        } else if found.len() > ROWS.1 {
            length = (length / 2).max(LEAST);
        }
        (begin, first) = (end, false);
    }
    Ok(())
}

/// Rows as comma-separated values (RFC 4180): time of day, seconds of the record, signal, value. BOOL is 0
/// or 1, TIME is in seconds; a value that is not known is empty.
pub(crate) struct Csv<W: Write>(W);

impl<W: Write> Csv<W> {
    pub(crate) fn new(mut out: W) -> io::Result<Csv<W>> {
        writeln!(out, "time,record,signal,value")?;
        Ok(Csv(out))
    }

    pub(crate) fn end(mut self) -> io::Result<W> {
        self.0.flush()?;
        Ok(self.0)
    }
}

impl<W: Write> Sink for Csv<W> {
    fn row(&mut self, row: &Row<'_>) -> io::Result<()> {
        let value = row.word.map_or_else(String::new, |word| csv_cell(&Value::Word(word), row.signal.kind));
        let record = Nanos::new(row.at.saturating_mul(1000)).in_seconds();
        writeln!(self.0, "{},{record},{},{value}", time::show(row.utc), csv_quote(&row.signal.name))
    }
}
