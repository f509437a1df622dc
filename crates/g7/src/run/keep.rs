//! Retained variables in a file, from run to run.

use std::path::Path;

use g7_host::{Layout, RetainError, Retained, Runner, Start};

use crate::bench::Bench;
use crate::failure::Failure;

fn layout(bench: &Bench) -> Layout {
    let row = |i: &crate::bench::Item| (i.name.clone(), i.retain.clone().unwrap_or_default(), i.words);
    Layout { variables: bench.retained().map(row).collect() }
}

/// Takes over what an earlier run kept: then this start is a warm one.
pub(super) fn load(bench: &Bench, runner: &mut Runner<'_>, path: Option<&Path>) -> Result<(), Failure> {
    let Some(path) = path else { return Ok(()) };
    match Retained::load(&layout(bench), path) {
        Ok(None) => Ok(()),
        Ok(Some(kept)) => {
            runner.restart(Start::Warm);
            runner.retain(&kept.words);
            Ok(())
        }
        Err(RetainError::Io(e)) => Err(Failure::Read(path.to_path_buf(), e)),
        Err(e) => Err(Failure::Usage(format!("cannot use {}: {e}; remove it to start cold", path.display()))),
    }
}

/// Keeps the retained variables as they are now.
pub(super) fn save(bench: &Bench, runner: &Runner<'_>, path: Option<&Path>) -> Result<(), Failure> {
    let Some(path) = path else { return Ok(()) };
    Retained { words: runner.retained() }
        .save(&layout(bench), path)
        .map_err(|e| Failure::Write(path.to_path_buf(), e))
}
