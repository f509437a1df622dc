//! The history of a controller for its page: what there is, lanes of a chronogram, files.
//!
//! Each answer reads the record by a connection of its own, on a thread that nothing else waits for; the
//! scan and the attendant know nothing of it.

use std::io::{self, Write};

use axum::extract::{Query, State};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use axum::{Json, Router};
use g7_host::{Kind, Value as Word};
use g7_model::say;
use g7_store::StoreError;
use g7_store::history::{Overview, Piece, Reader, Signal, Span, lane};
use serde::Deserialize;
use serde_json::{Value, json};
use tokio::sync::Semaphore;

use super::aside::aside;
use super::refusal::Refusal;
use super::shared::Shared;
use crate::failure::raw;
use crate::history::{Csv, Sink, rows};

/// Answers that are made at the same time; this bounds the memory.
static READERS: Semaphore = Semaphore::const_new(2);
/// Greatest number of signals of one answer, and of columns.
const SIGNALS: usize = 100;
const COLUMNS: u32 = 4_000;
/// Spans of an answer: as many as can be told apart.
const SPANS: usize = 4_000;
/// Longest file that the page gets; the command line has no limit.
const LONGEST: usize = 64 << 20;

/// The addresses below `/api/history`.
pub(super) fn routes() -> Router<Shared> {
    Router::new()
        .route("/api/history", get(overview))
        .route("/api/history/lanes", get(lanes))
        .route("/api/history/export", get(export))
}

/// The part of the record that is asked for: numbers of signals, separated by commas; times of the record in
/// ms.
#[derive(Deserialize)]
struct Part {
    signals: String,
    from: f64,
    to: f64,
    #[serde(default)]
    columns: u32,
    #[serde(default)]
    r#as: String,
}

impl Part {
    fn range(&self) -> (i64, i64) {
        ((self.from * 1e3) as i64, (self.to * 1e3) as i64)
    }

    fn signals(&self, overview: &Overview) -> Result<Vec<(i64, Signal)>, Refusal> {
        let asked: Vec<&str> = self.signals.split(',').filter(|id| !id.is_empty()).collect();
        if asked.len() > SIGNALS {
            return Err(Refusal::bad(say!("these are too many signals: {SIGNALS} at most")));
        }
        let find = |id: &str| {
            let id = id.parse::<i64>().ok()?;
            overview.signals.iter().find(|(known, _)| *known == id).cloned()
        };
        let known = |id| find(id).ok_or_else(|| Refusal::bad(say!("the record has no signal `{id}`")));
        asked.into_iter().map(known).collect()
    }
}

/// Reads the record of the controller.
async fn read<T: Send + 'static>(
    shared: Shared,
    work: impl FnOnce(&Reader, &Overview) -> Result<T, Refusal> + Send + 'static,
) -> Result<T, Refusal> {
    // The semaphore is never closed.
    let _turn = READERS.acquire().await.ok();
    aside(move || {
        let Some(path) = shared.history.get() else {
            let what =
                say!("this controller keeps no history: `[history]` in its io file names a file for it");
            return Err(Refusal::new(StatusCode::NOT_FOUND, what));
        };
        let reader = Reader::open(path).map_err(unreadable)?;
        let overview = reader.overview().map_err(unreadable)?;
        work(&reader, &overview)
    })
    .await
}

fn unreadable(error: StoreError) -> Refusal {
    Refusal::new(StatusCode::INTERNAL_SERVER_ERROR, say!("the history cannot be read: {}", raw(error)))
}

fn ms(at: i64) -> f64 {
    at as f64 / 1e3
}

async fn overview(State(shared): State<Shared>) -> Result<Json<Value>, Refusal> {
    let title = shared.title.clone();
    read(shared, move |_, overview| {
        let signals = overview.signals.iter().map(|(id, signal)| {
            let Signal { name, kind, class, ty, comment } = signal;
            let (is_bool, is_time) = (*kind == Kind::Bool, *kind == Kind::Time);
            let real = matches!(kind, Kind::Real | Kind::Lreal);
            json!({
                "id": id, "name": name, "class": class, "type": ty, "comment": comment,
                "bool": is_bool, "real": real, "time": is_time,
            })
        });
        Ok(Json(json!({
            "title": title,
            "signals": signals.collect::<Vec<_>>(),
            "from": ms(overview.from.max(overview.spans.first().map_or(0, |span| span.start))),
            "until": ms(overview.until),
        })))
    })
    .await
}

async fn lanes(State(shared): State<Shared>, Query(part): Query<Part>) -> Result<Json<Value>, Refusal> {
    read(shared, move |reader, overview| {
        let range = part.range();
        let columns = part.columns.clamp(1, COLUMNS);
        let mut lanes = Vec::new();
        for (id, signal) in part.signals(overview)? {
            let pieces = lane(reader, overview, (id, signal.kind), range, columns).map_err(unreadable)?;
            let pieces: Vec<Value> = pieces.iter().map(|piece| piece_json(piece, signal.kind)).collect();
            lanes.push(json!({ "id": id, "pieces": pieces }));
        }
        let least = (range.1.saturating_sub(range.0)) / i64::from(columns);
        let clock = overview.clock.marks().iter().map(|(at, utc)| json!([ms(*at), ms(*utc)]));
        Ok(Json(json!({
            "until": ms(overview.until),
            "spans": spans(overview, range, least),
            "clock": clock.collect::<Vec<_>>(),
            "lanes": lanes,
        })))
    })
    .await
}

/// The spans of a range; gaps that are shorter than a column are drawn as one column.
fn spans(overview: &Overview, (from, to): (i64, i64), least: i64) -> Vec<Value> {
    let mut joined: Vec<Span> = Vec::new();
    let start = |span: &Span| span.start.max(overview.from);
    for span in overview.spans.iter().filter(|span| span.stop >= from && start(span) <= to) {
        match joined.last_mut() {
            Some(last) if span.start == last.stop => last.stop = span.stop,
            // Spans that no column can hold count as a part of the gap.
            Some(last) if last.stop - last.start < least => *last = *span,
            _ => joined.push(*span),
        }
    }
    joined.truncate(SPANS);
    joined.iter().map(|span| json!([ms(start(span)), ms(span.stop), span.lost])).collect()
}

/// `[ms, value]`, `[ms, null]` where nothing is known, `[ms, null, text]` for what is no number, or
/// `[first ms, last ms, changes, least, greatest, value behind]`.
fn piece_json(piece: &Piece, kind: Kind) -> Value {
    match piece {
        Piece::Value(at, word) => {
            let value = Word::Word(*word);
            match value.number(kind) {
                number if number.is_finite() => json!([ms(*at), number]),
                _ => json!([ms(*at), null, value.show(kind)]),
            }
        }
        Piece::Unknown(at) => json!([ms(*at), null]),
        Piece::Busy { start, stop, count, range, last } => {
            let (low, high) = range.unwrap_or((0.0, 0.0));
            json!([ms(*start), ms(*stop), count, low, high, Word::Word(*last).number(kind)])
        }
    }
}

async fn export(State(shared): State<Shared>, Query(part): Query<Part>) -> Result<Response, Refusal> {
    let (kind, bytes) = read(shared, move |reader, overview| {
        let signals = part.signals(overview)?;
        let out = Bounded(Vec::new());
        let range = part.range();
        match part.r#as.as_str() {
            "csv" => {
                let mut csv = Csv::new(out).map_err(too_long)?;
                give(reader, overview, (&signals, range), &mut csv)?;
                Ok(("text/csv; charset=utf-8", csv.end().map_err(too_long)?.0))
            }
            #[cfg(feature = "parquet")]
            "parquet" => {
                let mut file = crate::history::Parquet::new(out).map_err(too_long)?;
                give(reader, overview, (&signals, range), &mut file)?;
                Ok(("application/vnd.apache.parquet", file.end().map_err(too_long)?.0))
            }
            _ => Err(Refusal::bad(say!("a history is exported as csv or parquet"))),
        }
    })
    .await?;
    Ok((StatusCode::OK, [(header::CONTENT_TYPE, kind)], bytes).into_response())
}

fn give(
    reader: &Reader,
    overview: &Overview,
    (signals, range): (&[(i64, Signal)], (i64, i64)),
    sink: &mut impl Sink,
) -> Result<(), Refusal> {
    rows(reader, overview, signals, range, sink).map_err(|e| match e {
        crate::history::Broken::Record(e) => unreadable(e),
        crate::history::Broken::Out(e) => too_long(e),
    })
}

fn too_long(_: io::Error) -> Refusal {
    let what =
        say!("this is too long: choose fewer signals or a shorter time, or use `g7 history` on the machine");
    Refusal::new(StatusCode::PAYLOAD_TOO_LARGE, what)
}

/// Bytes that do not become too many.
struct Bounded(Vec<u8>);

impl Write for Bounded {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.0.len() + bytes.len() > LONGEST {
            return Err(io::ErrorKind::FileTooLarge.into());
        }
        self.0.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
