//! A signal over time as a page draws it: where many changes would fall into one column, their least and
//! greatest value.

use g7_host::{Kind, Value};

use super::reader::{Overview, Reader, Seen};
use crate::file::StoreError;

/// Changes of a column that are shown one by one.
const FEW: usize = 4;

/// A part of a lane. Times are in us of the record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Piece {
    /// A value from an instant on.
    Value(i64, u64),
    /// Nothing is known from an instant on.
    Unknown(i64),
    /// Many changes.
    Busy {
        /// The first instant.
        start: i64,
        /// The last instant.
        stop: i64,
        /// The number of changes.
        count: u64,
        /// The least and the greatest value, as numbers.
        range: Option<(f64, f64)>,
        /// The last value, which stands behind it.
        last: u64,
    },
}

/// The parts of a lane, in the order of time.
pub type Lane = Vec<Piece>;

/// A column that is being filled.
struct Column {
    number: i64,
    /// The first changes, as long as they are few.
    few: Vec<(i64, u64)>,
    start: i64,
    stop: i64,
    count: u64,
    range: Option<(f64, f64)>,
    last: u64,
}

/// The lane of a signal between two times, for so many columns.
///
/// # Errors
///
/// The file cannot be read.
pub fn lane(
    reader: &Reader,
    overview: &Overview,
    (signal, kind): (i64, Kind),
    (from, to): (i64, i64),
    columns: u32,
) -> Result<Lane, StoreError> {
    let width = (to.saturating_sub(from) / i64::from(columns.max(1))).max(1);
    let of = |at: i64| at.saturating_sub(from).div_euclid(width);
    let mut lane = Lane::new();
    let mut column: Option<Column> = None;
    let fits = |start, stop| of(start) == of(stop);
    reader.visit(overview, (signal, kind), (from, to), fits, |seen| {
        let (start, stop, count, range, last) = match seen {
            Seen::Unknown(at) => {
                flush(&mut lane, column.take());
                lane.push(Piece::Unknown(at));
                return;
            }
            Seen::Value(at, word) => {
                let number = Value::Word(word).number(kind);
                (at, at, 1, (!number.is_nan()).then_some((number, number)), word)
            }
            Seen::Many { start, stop, count, range, last } => (start, stop, count, range, last),
        };
        if column.as_ref().is_some_and(|c| c.number != of(start)) {
            flush(&mut lane, column.take());
        }
        let number = of(start);
        let open = column.get_or_insert_with(|| Column {
            number,
            few: Vec::with_capacity(FEW),
            start,
            stop,
            count: 0,
            range: None,
            last,
        });
        if count == 1 && open.few.len() < FEW {
            open.few.push((start, last));
        }
        (open.stop, open.count, open.last) = (stop, open.count + count, last);
        open.range = match (open.range, range) {
            (Some((a, b)), Some((c, d))) => Some((a.min(c), b.max(d))),
            (one, other) => one.or(other),
        };
    })?;
    flush(&mut lane, column);
    Ok(lane)
}

fn flush(lane: &mut Lane, column: Option<Column>) {
    let Some(Column { few, start, stop, count, range, last, .. }) = column else { return };
    if few.len() as u64 == count {
        lane.extend(few.into_iter().map(|(at, word)| Piece::Value(at, word)));
    } else {
        lane.push(Piece::Busy { start, stop, count, range, last });
    }
}
