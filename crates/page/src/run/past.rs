//! The past of a run: copies of the run at some scans, and all events from outside. A scan between
//! two copies is reached by repeating the scans since the copy before it.
//!
//! Repeating a scan gives the same state (the engine guarantees it); the memory is bounded for runs
//! of any length.

use g7_host::{Runner, Start, Tape, Value};
use g7_model::Nanos;
use g7_rig::Bench;

/// An event from outside.
#[derive(Clone, Debug)]
pub(super) enum Event {
    Set(usize, Value),
    Force(usize, Value),
    Release(usize),
    Restart(Start),
}

/// When an event came: after how many scans, and if so, between two passes of the next one.
#[derive(Clone, Debug)]
struct Entry {
    scans: u64,
    within: bool,
    event: Event,
}

/// A copy of the run before the scan with this number.
#[derive(Clone)]
struct Mark {
    scans: u64,
    runner: Runner,
}

/// The stored past of a run.
pub(super) struct Past {
    marks: Vec<Mark>,
    /// The number of scans between two copies.
    every: u64,
    /// Greatest number of copies.
    room: usize,
    entries: Vec<Entry>,
    scans: u64,
    /// The instant of the first scan.
    begin: Nanos,
}

/// The number of scans between two copies at the start of a run.
const EVERY: u64 = 64;
/// Greatest number of words in all copies together.
const WORDS: usize = 1 << 20;
/// Greatest number of events; when it is exceeded, the past begins anew.
const EVENTS: usize = 100_000;

impl Past {
    /// A past that begins at the present state of the run.
    pub(super) fn new(runner: &Runner) -> Past {
        let words = |s: &g7_engine::State| s.image().len();
        let size = 2 * words(runner.state()) + runner.plant().map_or(0, |(_, s)| 2 * words(s)) + 256;
        Past {
            marks: vec![Mark { scans: 0, runner: runner.clone() }],
            every: EVERY,
            room: (WORDS / size).clamp(4, 512),
            entries: Vec::new(),
            scans: 0,
            begin: runner.due(),
        }
    }

    /// The instant of the first scan.
    pub(super) fn begin(&self) -> Nanos {
        self.begin
    }

    /// Records an event from outside.
    pub(super) fn note(&mut self, runner: &Runner, event: Event) {
        if self.entries.len() >= EVENTS {
            *self = Past::new(runner);
        }
        self.entries.push(Entry { scans: self.scans, within: runner.is_within_scan(), event });
    }

    /// Must be called before each scan.
    pub(super) fn before_scan(&mut self, runner: &Runner) {
        let due =
            self.scans.is_multiple_of(self.every) && self.marks.last().is_none_or(|m| m.scans < self.scans);
        // Between two passes the scan has already begun; the copy before it is used.
        if due && !runner.is_within_scan() {
            if self.marks.len() >= self.room {
                self.every = self.every.saturating_mul(2);
                let every = self.every;
                self.marks.retain(|m| m.scans.is_multiple_of(every));
            }
            // Events since the last scan are replayed after the copy, so none may be in it already.
            if self.scans.is_multiple_of(self.every)
                && self.entries.last().is_none_or(|e| e.scans != self.scans)
            {
                self.marks.push(Mark { scans: self.scans, runner: runner.clone() });
            }
        }
        self.scans += 1;
    }

    /// The run after the last scan at or before an instant, and the number of that scan, from 1.
    pub(super) fn at(&self, bench: &Bench, instant: Nanos) -> Option<(Runner, u64)> {
        let first = self.marks.first()?;
        let period = first.runner.period();
        let number = (instant - self.begin).count_of(period).saturating_add(1);
        let target = u64::try_from(number).unwrap_or(0).clamp(1, self.scans.max(1));
        let mark = self.marks.iter().rev().find(|m| m.scans < target)?;
        Some((self.repeated(bench, mark.runner.clone(), mark.scans, target), target))
    }

    /// A run that stands before the scan with the number `from`, after all scans up to `target`.
    fn repeated(&self, bench: &Bench, mut runner: Runner, from: u64, target: u64) -> Runner {
        let mut next = self.entries.partition_point(|e| e.scans < from);
        for scan in from..target {
            while let Some(entry) = self.entries.get(next).filter(|e| e.scans <= scan) {
                if entry.within && !runner.is_within_scan() {
                    runner.pass().ok();
                }
                apply(bench, &mut runner, &entry.event);
                next += 1;
            }
            runner.scan().ok();
        }
        runner
    }

    /// All that entered the charts from the start on; `None` where the past begins later, after an on-line change for
    /// example.
    pub(super) fn tape(&self, bench: &Bench) -> Option<Tape> {
        let first = self.marks.first().filter(|m| m.scans == 0 && self.begin == Nanos::ZERO)?;
        let runner = self.repeated(bench, first.runner.clone().with_tape(), 0, self.scans);
        runner.tape().cloned()
    }

    /// True if this is the latest scan.
    pub(super) fn is_last(&self, scans: u64) -> bool {
        scans >= self.scans
    }

    /// Drops everything after a scan.
    pub(super) fn cut(&mut self, scans: u64) {
        self.scans = scans;
        self.entries.retain(|e| e.scans < scans);
        self.marks.retain(|m| m.scans <= scans);
    }
}

/// Executes an event on a run.
pub(super) fn apply(bench: &Bench, runner: &mut Runner, event: &Event) {
    match event {
        Event::Set(i, value) => {
            if let Some(item) = bench.items.get(*i) {
                bench.set(runner, item, value);
            }
        }
        Event::Force(i, value) => {
            if let Some(item) = bench.items.get(*i) {
                bench.force(runner, item, value);
            }
        }
        Event::Release(i) => {
            if let Some(item) = bench.items.get(*i) {
                bench.release(runner, item);
            }
        }
        Event::Restart(start) => runner.restart(*start),
    }
}
