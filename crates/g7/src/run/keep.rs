//! Keeps retained variables in a file between runs.

use std::path::Path;

use g7_host::{Clock, Layout, RetainError, Retained, Runner, Start, WallClock};

use g7_model::{Nanos, say};

use crate::failure::{Failure, raw};
use g7_rig::Bench;

fn layout(bench: &Bench) -> Layout {
    let row = |i: &g7_rig::Item| (i.name.clone(), i.retain.clone().unwrap_or_default(), i.words);
    Layout { variables: bench.retained().map(row).collect() }
}

/// Loads the values of an earlier run; the start is then a warm one.
pub(super) fn load(bench: &Bench, runner: &mut Runner, path: Option<&Path>) -> Result<(), Failure> {
    let Some(path) = path else { return Ok(()) };
    match Retained::load(&layout(bench), path) {
        Ok(None) => Ok(()),
        Ok(Some(kept)) => {
            runner.restart(Start::Warm);
            runner.retain(&kept.words);
            Ok(())
        }
        Err(RetainError::Io(e)) => Err(Failure::Read(path.to_path_buf(), e)),
        Err(e) => Err(Failure::Usage(say!(
            "cannot use {}: {e}; remove it to start cold",
            raw(path.display()),
            e = raw(&e)
        ))),
    }
}

/// Writes the retained variables during the run and at its end.
pub(crate) struct Keeper<'a> {
    layout: Layout,
    path: Option<&'a Path>,
    written: Vec<u64>,
    clock: WallClock,
}

/// Least time between two writes; each write waits for the disk.
const PAUSE: Nanos = Nanos::SECOND;

impl<'a> Keeper<'a> {
    pub(super) fn new(bench: &Bench, runner: &Runner, path: Option<&'a Path>) -> Keeper<'a> {
        Keeper { layout: layout(bench), path, written: runner.retained(), clock: WallClock::default() }
    }

    /// Writes changed values, at most once a second: if the run is interrupted, no more than that
    /// is lost.
    pub(crate) fn tick(&mut self, runner: &Runner) -> Result<(), Failure> {
        if self.path.is_none() || self.clock.now() < PAUSE {
            return Ok(());
        }
        self.clock = WallClock::default();
        if runner.retained() == self.written {
            return Ok(());
        }
        self.save(runner)
    }

    /// Writes the present values.
    pub(crate) fn save(&mut self, runner: &Runner) -> Result<(), Failure> {
        let Some(path) = self.path else { return Ok(()) };
        self.written = runner.retained();
        Retained { words: self.written.clone() }
            .save(&self.layout, path)
            .map_err(|e| Failure::Write(path.to_path_buf(), e))
    }
}
