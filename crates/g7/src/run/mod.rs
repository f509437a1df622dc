//! `g7 run`: interactively in the terminal, or without it for scripts.

mod headless;
mod keep;

use std::io::{IsTerminal, stdin, stdout};

pub(crate) use keep::Keeper;

use crate::cli::Run;
use crate::failure::{Failure, Verdict};
use crate::message::talk;
use crate::report::{self, Tally};
use crate::sources::{self, Source};
use crate::{files, view};
use g7_rig::{self as bench, Bench};

pub(crate) fn run(args: &Run) -> Result<Verdict, Failure> {
    let source = sources::load(&files::one(&args.path)?, 0)?;
    let Some(bench) = load(&source, args)? else { return Ok(Verdict::Found) };
    if let Some(tape) = &args.replay {
        return headless::replay(&bench, args, tape);
    }
    let asked = args.headless || args.trace.is_some() || args.record.is_some() || args.real_time;
    if asked || !stdin().is_terminal() || !stdout().is_terminal() {
        if !asked {
            talk!("no terminal: running headless; `g7 run --help` has the options");
        }
        return headless::run(&bench, &source, args);
    }
    let mut runner = bench.runner(args.seed);
    keep::load(&bench, &mut runner, args.retain.as_deref())?;
    let mut keeper = Keeper::new(&bench, &runner, args.retain.as_deref());
    view::run(&bench, runner, &source.name, args, &mut keeper)?;
    Ok(Verdict::Fine)
}

/// Compiles a source, or prints its problems.
fn load(source: &Source, args: &Run) -> Result<Option<Bench>, Failure> {
    let options =
        bench::Options { profile: args.profile, scan: args.scan, plant: args.plant.as_deref(), asks: &[] };
    let (bench, problems) = bench::build(source, &options)?;
    if !problems.is_empty() {
        talk!("{}", report::text(source, &problems).trim_end());
        talk!("{}: {}", source.name, Tally::of(&problems));
    }
    Ok(bench)
}
