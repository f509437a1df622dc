//! Kinds and values of signals.

use std::sync::Arc;

use g7_model::{Moment, Nanos};

/// How the words of a signal are to be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// 0 or 1.
    Bool,
    /// An integer, sign-extended or zero-extended to 64 bits.
    Int {
        /// Its size: 8, 16, 32 or 64.
        bits: u8,
        /// True for two's complement.
        signed: bool,
    },
    /// A floating-point number, stored as the bits of an `f32`.
    Real,
    /// A floating-point number, stored as the bits of an `f64`.
    Lreal,
    /// A signed number of nanoseconds.
    Time,
    /// A date, a time of day, or a date with a time: a signed number of nanoseconds.
    Moment(Moment),
    /// UTF-8 text.
    Text,
}

/// One value of a signal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Value {
    /// A value of one word, in the engine's representation.
    Word(u64),
    /// A text.
    Text(Arc<str>),
}

impl Kind {
    /// The unit in which devices and files have this kind as a number: the millisecond for TIME, [`Moment::unit`] for dates
    /// and times of day. None for other kinds.
    pub const fn unit(self) -> Option<Nanos> {
        match self {
            Kind::Time => Some(Nanos::MILLISECOND),
            Kind::Moment(moment) => Some(moment.unit()),
            Kind::Bool | Kind::Int { .. } | Kind::Real | Kind::Lreal | Kind::Text => None,
        }
    }

    /// True if a signal of this kind can have the value of a word: a DATE is whole days, a TOD less than one.
    pub const fn admits(self, word: u64) -> bool {
        match self {
            Kind::Moment(moment) => moment.admits(Nanos::new(word as i64)),
            Kind::Bool | Kind::Int { .. } | Kind::Real | Kind::Lreal | Kind::Time | Kind::Text => true,
        }
    }
}

impl Value {
    /// The word; 0 if the value is a text.
    pub fn word(&self) -> u64 {
        match self {
            Value::Word(w) => *w,
            Value::Text(_) => 0,
        }
    }

    /// The value as a number, for drawing curves.
    pub fn number(&self, kind: Kind) -> f64 {
        let w = self.word();
        match kind {
            Kind::Bool => w as f64,
            Kind::Int { signed: true, .. } => w as i64 as f64,
            Kind::Int { signed: false, .. } => w as f64,
            Kind::Real => f64::from(f32::from_bits(w as u32)),
            Kind::Lreal => f64::from_bits(w),
            Kind::Time | Kind::Moment(_) => Nanos::new(w as i64).as_seconds(),
            Kind::Text => 0.0,
        }
    }

    /// The value as text for the user: `TRUE`, `-3`, `2.5`, `1s500ms`, `2026-11-28`, `text`.
    pub fn show(&self, kind: Kind) -> String {
        let w = self.word();
        match (self, kind) {
            (Value::Text(t), _) => t.to_string(),
            (_, Kind::Bool) => if w == 0 { "FALSE" } else { "TRUE" }.to_owned(),
            (_, Kind::Int { signed: true, .. }) => (w as i64).to_string(),
            (_, Kind::Int { signed: false, .. }) => w.to_string(),
            (_, Kind::Real) => f32::from_bits(w as u32).to_string(),
            (_, Kind::Lreal) => f64::from_bits(w).to_string(),
            (_, Kind::Time) => Nanos::new(w as i64).plain(),
            (_, Kind::Moment(moment)) => moment.text(Nanos::new(w as i64)),
            (_, Kind::Text) => String::new(),
        }
    }
}

/// A value as it stands in a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sample<'a> {
    /// A value of one word.
    Word(u64),
    /// The words of a text: its length in bytes, then the bytes ([`crate::read_text`]).
    Text(&'a [u64]),
}

impl Sample<'_> {
    pub(super) fn words(&self) -> &[u64] {
        match self {
            Sample::Word(word) => std::slice::from_ref(word),
            Sample::Text(words) => words,
        }
    }
}
