//! The files of `g7 test`, shared among threads; results come in the order of the files.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use g7_host::WallClock;
use g7_rig::testing::{self, Coverage, Options, Outcome, Unproved};

use crate::cli::Test;
use crate::failure::Failure;
use crate::report::{self, Tally};
use crate::{share, sources};

/// The results of a file.
pub(super) struct Done {
    pub(super) name: String,
    pub(super) outcomes: Vec<Outcome>,
    pub(super) coverage: Coverage,
    pub(super) unproved: Vec<Unproved>,
    /// Its problems, if there are errors among them: then no test of it was run.
    pub(super) told: Option<String>,
    /// The tests that were left out behind a failure.
    pub(super) not_run: usize,
}

/// Runs the tests of the files and hands each result on.
pub(super) fn share(
    args: &Test,
    paths: &[PathBuf],
    take: impl FnMut(Done) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let failed = AtomicBool::new(false);
    share::in_order(args.jobs, paths, |path| one(args, path, &failed), take)
}

fn one(args: &Test, path: &Path, failed: &AtomicBool) -> Result<Done, Failure> {
    let source = sources::load(path, 0)?;
    let filter = args.filter.as_deref();
    let wanted = source.tests().filter(|t| filter.is_none_or(|f| t.title.contains(f))).count();
    let mut done = Done {
        name: source.name.clone(),
        outcomes: Vec::new(),
        coverage: Coverage::default(),
        unproved: testing::unproved(&source),
        told: None,
        not_run: 0,
    };
    if args.fail_fast && failed.load(Ordering::Relaxed) {
        done.not_run = wanted;
        return Ok(done);
    }
    let options = Options {
        profile: args.profile,
        scan: args.scan,
        filter,
        limit: Some(args.timeout),
        fail_fast: args.fail_fast,
        causes: Some(testing::causes),
        record: false,
    };
    let (outcomes, problems) =
        testing::file(&source, options, &mut done.coverage, &mut WallClock::default(), &mut || {})?;
    if Tally::of(&problems).errors > 0 {
        done.told = Some(report::text(&source, &problems));
    } else {
        done.not_run = wanted - outcomes.len();
    }
    if done.told.is_some() || outcomes.iter().any(|o| o.defect.is_some()) {
        failed.store(true, Ordering::Relaxed);
    }
    done.outcomes = outcomes;
    Ok(done)
}
