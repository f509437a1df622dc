//! The way back in time: the run as it stood at some scans, and what came in
//! since. A scan between is made again from the one before it.
//!
//! What must hold: making a scan again gives the state it gave (the engine's
//! promise); memory is bounded, whatever the length of the run.

use g7_host::{Runner, Start, Value};
use g7_rig::Bench;

/// What came in from outside.
#[derive(Clone, Debug)]
pub(super) enum Event {
    Set(usize, Value),
    Force(usize, Value),
    Release(usize),
    Restart(Start),
}

/// When: behind so many scans, perhaps between two passes of the next one.
#[derive(Clone, Debug)]
struct Entry {
    scans: u64,
    within: bool,
    event: Event,
}

/// The run before the scan of this number.
#[derive(Clone)]
struct Mark {
    scans: u64,
    runner: Runner,
}

/// What is kept of a run.
pub(super) struct Past {
    marks: Vec<Mark>,
    /// Scans from one mark to the next.
    every: u64,
    /// Most marks.
    room: usize,
    entries: Vec<Entry>,
    scans: u64,
    /// Instant of the first scan, nanoseconds.
    begin: i64,
}

/// Scans from mark to mark at first.
const EVERY: u64 = 64;
/// Words that all marks may take.
const WORDS: usize = 1 << 20;
/// Most events that are kept; at more the past begins anew.
const EVENTS: usize = 100_000;

impl Past {
    /// A past that begins here.
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

    /// Instant of the first scan.
    pub(super) fn begin(&self) -> i64 {
        self.begin
    }

    /// Something comes in.
    pub(super) fn note(&mut self, runner: &Runner, event: Event) {
        if self.entries.len() >= EVENTS {
            *self = Past::new(runner);
        }
        self.entries.push(Entry { scans: self.scans, within: runner.is_within_scan(), event });
    }

    /// A scan is about to be made.
    pub(super) fn before_scan(&mut self, runner: &Runner) {
        let due =
            self.scans.is_multiple_of(self.every) && self.marks.last().is_none_or(|m| m.scans < self.scans);
        // Between two passes the scan has begun; the mark before it will do.
        if due && !runner.is_within_scan() {
            if self.marks.len() >= self.room {
                self.every = self.every.saturating_mul(2);
                let every = self.every;
                self.marks.retain(|m| m.scans.is_multiple_of(every));
            }
            // What came in at this very instant is made again too: it lies behind the mark.
            if self.scans.is_multiple_of(self.every)
                && self.entries.last().is_none_or(|e| e.scans != self.scans)
            {
                self.marks.push(Mark { scans: self.scans, runner: runner.clone() });
            }
        }
        self.scans += 1;
    }

    /// The run behind the scan at an instant or the last one before it, and the
    /// number of that scan, from 1.
    pub(super) fn at(&self, bench: &Bench, instant: i64) -> Option<(Runner, u64)> {
        let first = self.marks.first()?;
        let period = first.runner.period();
        let number = instant.saturating_sub(self.begin).checked_div(period)?.saturating_add(1);
        let target = u64::try_from(number).unwrap_or(0).clamp(1, self.scans.max(1));
        let mark = self.marks.iter().rev().find(|m| m.scans < target)?;
        let mut runner = mark.runner.clone();
        let mut next = self.entries.partition_point(|e| e.scans < mark.scans);
        for scan in mark.scans..target {
            while let Some(entry) = self.entries.get(next).filter(|e| e.scans <= scan) {
                if entry.within && !runner.is_within_scan() {
                    runner.pass().ok();
                }
                apply(bench, &mut runner, &entry.event);
                next += 1;
            }
            runner.scan().ok();
        }
        Some((runner, target))
    }

    /// Whether this is the latest scan.
    pub(super) fn is_last(&self, scans: u64) -> bool {
        scans >= self.scans
    }

    /// Forgets what came behind a scan.
    pub(super) fn cut(&mut self, scans: u64) {
        self.scans = scans;
        self.entries.retain(|e| e.scans < scans);
        self.marks.retain(|m| m.scans <= scans);
    }
}

/// Does to a run what came in.
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
