//! A progress bar for work that takes more than a second, on a terminal only.

use std::io::{IsTerminal, stderr};

use g7_host::{Clock, WallClock};
use g7_model::Nanos;
use indicatif::{ProgressBar, ProgressStyle};

/// Nothing for the first second, then a bar on the standard error.
pub(crate) struct Progress {
    what: &'static str,
    total: u64,
    done: u64,
    clock: WallClock,
    bar: Option<ProgressBar>,
    on: bool,
}

const PATIENCE: Nanos = Nanos::SECOND;

impl Progress {
    pub(crate) fn new(what: &'static str, total: u64) -> Progress {
        Progress { what, total, done: 0, clock: WallClock::default(), bar: None, on: stderr().is_terminal() }
    }

    /// One more part of the work is done.
    pub(crate) fn step(&mut self) {
        self.at(self.done + 1);
    }

    /// Sets the amount of work that is done.
    pub(crate) fn at(&mut self, done: u64) {
        self.done = done;
        if !self.on || self.clock.now() < PATIENCE {
            return;
        }
        let (total, what) = (self.total, self.what);
        let bar = self.bar.get_or_insert_with(|| {
            let style = ProgressStyle::with_template("{msg} {wide_bar} {percent}%");
            let bar = ProgressBar::new(total).with_message(what);
            match style {
                Ok(style) => bar.with_style(style),
                Err(_) => bar,
            }
        });
        bar.set_length(total);
        bar.set_position(done);
    }

    /// Removes the bar; the next step shows it again.
    pub(crate) fn end(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }
}
