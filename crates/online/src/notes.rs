//! The record of a controller: each change of a chosen signal, from every scan.
//!
//! ```text
//! step -> Pen -> ring of Notes -> a thread of its own -> a file
//! ```
//!
//! # Invariants
//!
//! The pen compares words and puts notes of fixed size into a ring; it never waits.
//! The notes of a step are in the ring as a whole or not at all. Where there is no room for them, what
//! follows begins anew with the values of all signals, so a loss is seen and never looks like a value
//! that stood still.

use std::sync::mpsc::{Receiver, Sender, channel};

use g7_host::{Kind, Runner, Value};
use g7_model::Nanos;

use crate::chosen::Recorded;
use crate::wire::Worth;
use crate::word::Source;

/// Notes that wait for their reader: more than four times those of one step with all signals.
const NOTES: usize = 1 << 16;
/// The time between two notes that nothing has changed.
const ALIVE: Nanos = Nanos::from_millis(100);

/// A note of one step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Note {
    /// From here on signals have the numbers of this table; the values of all of them follow.
    Begin {
        /// The time of the controller.
        at: Nanos,
        /// The number of the table.
        table: u64,
        /// Changes before it that found no room.
        lost: u32,
    },
    /// A signal has another value.
    Change {
        /// The time of the controller.
        at: Nanos,
        /// The number of the signal in the table.
        signal: u32,
        /// The new value.
        word: u64,
    },
    /// Until here nothing else has changed.
    Alive {
        /// The time of the controller.
        at: Nanos,
    },
}

/// The signals of a chart, in the order of their numbers.
#[derive(Clone, Debug)]
pub struct Table {
    /// Its number; the one of the start is 0.
    pub number: u64,
    /// The signals.
    pub signals: Vec<Recorded>,
}

/// The reader's side.
pub struct Notes {
    /// The notes, as they come.
    pub notes: rtrb::Consumer<Note>,
    tables: Receiver<Table>,
    present: Option<u64>,
}

impl Notes {
    /// The table of a number that a note has told; `None` where it is that of the note before.
    pub fn table(&mut self, number: u64) -> Option<Table> {
        if self.present == Some(number) {
            // A later table may be there already, and stays.
            return None;
        }
        self.present = Some(number);
        // Tables of changes that were not made come in between.
        self.tables.try_iter().find(|table| table.number == number)
    }
}

/// A signal as the pen sees it.
#[derive(Clone, Copy, Debug)]
struct Watch {
    source: Source,
    input: Option<u32>,
    safe: Option<u64>,
    kind: Kind,
    band: f64,
}

impl Watch {
    fn word(&self, runner: &Runner, drives: bool) -> u64 {
        match (self.input, self.safe) {
            (Some(input), _) if !drives => runner.input(input),
            (None, Some(safe)) if !drives => safe,
            // No signal tells how good an input is.
            (_, _) => self.source.word(runner, runner.state(), |_, _| Worth::None),
        }
    }

    /// True if a value differs enough to be noted.
    fn differs(&self, word: u64, last: u64) -> bool {
        if word == last || self.band <= 0.0 {
            return word != last;
        }
        let number = |word| Value::Word(word).number(self.kind);
        let moved = (number(word) - number(last)).abs();
        // NaN differs from every number.
        moved.is_nan() || moved >= self.band
    }
}

/// The signals of the chart that runs, with the values that were noted last.
#[derive(Debug)]
pub(crate) struct Noting {
    table: u64,
    signals: Vec<Watch>,
    last: Vec<u64>,
}

impl Noting {
    pub(crate) fn new(table: &Table) -> Noting {
        let watch = |signal: &Recorded| Watch {
            source: signal.source,
            input: signal.input,
            safe: signal.safe,
            kind: signal.kind,
            band: signal.band,
        };
        let signals: Vec<Watch> = table.signals.iter().map(watch).collect();
        Noting { table: table.number, last: vec![0; signals.len()], signals }
    }
}

/// The controller's side.
#[derive(Debug)]
pub(crate) struct Pen {
    notes: rtrb::Producer<Note>,
    /// The next step begins anew.
    begins: bool,
    lost: u32,
    due: Nanos,
}

/// The pen, its reader, and the way for later tables.
pub(crate) fn pen(table: Table) -> (Pen, Notes, Sender<Table>) {
    let (notes, taken) = rtrb::RingBuffer::new(NOTES);
    let (give, tables) = channel();
    // The receiver is in this function.
    give.send(table).ok();
    (
        Pen { notes, begins: true, lost: 0, due: Nanos::ZERO },
        Notes { notes: taken, tables, present: None },
        give,
    )
}

impl Pen {
    /// From the next step on there are other signals.
    pub(crate) fn begin(&mut self) {
        self.begins = true;
    }

    /// Notes a step: `drives` while the charts give the outputs.
    pub(crate) fn note(&mut self, at: Nanos, drives: bool, runner: &Runner, noting: &mut Noting) {
        // One note for each signal, and two more.
        let room = self.notes.slots() > noting.signals.len() + 1;
        let begins = self.begins && room;
        if begins {
            let (table, lost) = (noting.table, std::mem::take(&mut self.lost));
            self.put(Note::Begin { at, table, lost });
            self.begins = false;
        }
        let mut missed = 0u32;
        for (signal, (watch, last)) in (0u32..).zip(noting.signals.iter().zip(&mut noting.last)) {
            let word = watch.word(runner, drives);
            if !begins && !watch.differs(word, *last) {
                continue;
            }
            *last = word;
            if room {
                self.put(Note::Change { at, signal, word });
            } else {
                missed = missed.saturating_add(1);
            }
        }
        self.lost = self.lost.saturating_add(missed);
        self.begins |= missed > 0;
        if room && at >= self.due {
            self.due = at + ALIVE;
            self.put(Note::Alive { at });
        }
    }

    fn put(&mut self, note: Note) {
        // The caller has seen that there is room.
        self.notes.push(note).ok();
    }
}
