//! The history of signals: each change of their values, over days and starts of the controller.
//!
//! # Where this sits
//!
//! ```text
//! notes of the scan -> Writer -> tail (a batch a second) -> chunks (packed, by signal) -> Reader -> lanes, rows
//! ```
//!
//! # The time of the record
//!
//! The record has a time of its own, in us: that of the controller, which no clock of the wall can turn
//! back, with the pauses between two runs added. A pause counts as the wall clock says, but as a day at
//! most, so that a clock that was wrong by years deletes nothing. What the wall clock showed is noted
//! beside it whenever the two part ([`Clock`]).
//!
//! # Invariants
//!
//! The time of the record never goes back. Within a span of the record each change of its signals is
//! there; the span begins with the values of all of them. Outside of spans nothing is known, and no value
//! is carried over. What a crash takes is what was not yet committed: a second.
//! After a full disk the writer goes on; what had no room is a gap with its count.

mod clock;
mod lanes;
mod limits;
mod packed;
mod prune;
mod reader;
#[cfg(test)]
mod tests;
mod writer;

use g7_host::Kind;
use g7_model::Moment;

pub use clock::Clock;
pub use lanes::{Lane, Piece, lane};
pub use limits::Limits;
pub use reader::{Overview, Reader, Seen, Span};
pub use writer::Writer;

/// The application id of the file: `G7hi`.
const KIND: i32 = 0x4737_6869;

/// Times are in us of the record.
const LAYOUTS: &[&str] = &["
CREATE TABLE signal (
    id INTEGER PRIMARY KEY, name TEXT NOT NULL, kind TEXT NOT NULL, class TEXT NOT NULL,
    type TEXT NOT NULL, comment TEXT, UNIQUE (name, kind));
CREATE TABLE span (
    id INTEGER PRIMARY KEY, start INTEGER NOT NULL, stop INTEGER NOT NULL, lost INTEGER NOT NULL);
CREATE TABLE clock (at INTEGER PRIMARY KEY, utc INTEGER NOT NULL);
CREATE TABLE kept (id INTEGER PRIMARY KEY CHECK (id = 0), start INTEGER NOT NULL);
CREATE TABLE chunk (
    id INTEGER PRIMARY KEY, signal INTEGER NOT NULL, start INTEGER NOT NULL, stop INTEGER NOT NULL,
    count INTEGER NOT NULL, low REAL, high REAL, last INTEGER NOT NULL, data BLOB NOT NULL);
CREATE INDEX chunk_signal ON chunk (signal, start);
CREATE INDEX chunk_stop ON chunk (stop, signal);
CREATE TABLE tail (id INTEGER PRIMARY KEY, data BLOB NOT NULL);
"];

/// A signal of the record.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Signal {
    /// The variable, or the step by its step variable.
    pub name: String,
    /// How its word is to be read.
    pub kind: Kind,
    /// `inputs`, `outputs`, `variables` or `steps`.
    pub class: String,
    /// Its type, as the language writes it.
    pub ty: String,
    /// The author's comment.
    pub comment: Option<String>,
}

/// A kind in the file.
fn kind_word(kind: Kind) -> String {
    match kind {
        Kind::Bool => "bool".to_owned(),
        Kind::Int { bits, signed: true } => format!("i{bits}"),
        Kind::Int { bits, signed: false } => format!("u{bits}"),
        Kind::Real => "f32".to_owned(),
        Kind::Lreal => "f64".to_owned(),
        Kind::Time => "time".to_owned(),
        Kind::Moment(moment) => moment.name().to_ascii_lowercase(),
        Kind::Text => "text".to_owned(),
    }
}

/// The kind of a word of the file.
fn kind_of(word: &str) -> Option<Kind> {
    Some(match word {
        "bool" => Kind::Bool,
        "f32" => Kind::Real,
        "f64" => Kind::Lreal,
        "time" => Kind::Time,
        "date" => Kind::Moment(Moment::Date),
        "tod" => Kind::Moment(Moment::Tod),
        "dt" => Kind::Moment(Moment::Dt),
        _ => {
            let (sign, bits) = word.split_at_checked(1)?;
            let bits = bits.parse().ok().filter(|bits| [8, 16, 32, 64].contains(bits))?;
            Kind::Int {
                bits,
                signed: match sign {
                    "i" => true,
                    "u" => false,
                    _ => return None,
                },
            }
        }
    })
}
