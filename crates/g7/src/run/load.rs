//! The chart of a run, compiled, or its problems on the standard error.

use g7_model::{Nanos, Problem};
use g7_rig::{self as bench, Bench};

use crate::cli::Run;
use crate::failure::Failure;
use crate::message::talk;
use crate::report::{self, Tally};
use crate::sources::Source;

/// Compiles a source, or prints its problems.
pub(super) fn load(source: &Source, args: &Run) -> Result<Option<Bench>, Failure> {
    build(source, args, args.plant.as_deref(), args.scan)
}

pub(super) fn build(
    source: &Source,
    args: &Run,
    plant: Option<&str>,
    scan: Option<Nanos>,
) -> Result<Option<Bench>, Failure> {
    let options = bench::Options { profile: args.profile, scan, plant, asks: &[] };
    let (bench, problems) = bench::build(source, &options)?;
    show(source, &problems);
    Ok(bench)
}

/// Prints the problems of a file, if it has any.
pub(super) fn show(source: &Source, problems: &[Problem]) {
    if !problems.is_empty() {
        talk!("{}", report::text(source, problems).trim_end());
        talk!("{}: {}", source.name, Tally::of(problems));
    }
}
