//! `g7 run`: interactively in the terminal, or without it for scripts.

mod headless;
mod keep;
mod outside;

use std::io::{IsTerminal, stdin, stdout};
use std::path::Path;

pub(crate) use headless::{tape_of, taped};
pub(crate) use keep::Keeper;
pub(crate) use outside::is_fmu;

use g7_model::say;

use crate::attendant::Attendant;
use crate::cli::Run;
use crate::failure::{Failure, Verdict};
use crate::message::tell;
use crate::sources::{self, Source};
use crate::station::{self, More, Settings, Station};
use crate::{files, view, wiring};
use g7_rig::Options;

pub(crate) fn run(args: &Run) -> Result<Verdict, Failure> {
    let path = files::one(&args.path)?;
    let source = sources::load(&path, 0)?;
    if args.drive.online {
        if outside::is_fmu(args.plant.as_deref()) {
            return Err(Failure::Usage(say!("an FMU is a plant of runs without --online")));
        }
        return online(&path, source, args);
    }
    for output in [&args.trace, &args.record] {
        let from = [Some(path.as_path()), args.replay.as_deref(), args.retain.as_deref()];
        let from: Vec<&Path> = from.into_iter().flatten().collect();
        files::refuse_foreign(output.as_deref(), &from, args.force)?;
    }
    files::refuse_source(args.retain.as_deref(), &[&path])?;
    let is_fmu = outside::is_fmu(args.plant.as_deref());
    if !is_fmu && !args.wire.is_empty() {
        return Err(Failure::Usage(say!("--wire is for a plant that is an FMU: --plant FILE.fmu")));
    }
    let plant = if is_fmu { Some("none") } else { args.plant.as_deref() };
    let options = Options { profile: args.profile, scan: args.scan, plant, asks: &[] };
    let Some(bench) = wiring::build(&source, &options)? else { return Ok(Verdict::Found) };
    if let Some(tape) = &args.replay {
        return headless::replay(&bench, args, tape);
    }
    let asked = args.headless || is_fmu || args.trace.is_some() || args.record.is_some() || args.real_time;
    if asked || !stdin().is_terminal() || !stdout().is_terminal() {
        if !asked {
            tell(say!("no terminal: running headless; `g7 run --help` has the options"));
        }
        return headless::run(&bench, &source, args);
    }
    let mut runner = bench.runner(args.seed);
    keep::load(&bench, &mut runner, args.retain.as_deref())?;
    let mut keeper = Keeper::new(&bench, &runner, args.retain.as_deref());
    view::run(&bench, runner, &source.name, args, &mut keeper)?;
    Ok(Verdict::Fine)
}

/// The chart drives the devices of its io file, until it is told to end.
fn online(path: &Path, source: Source, args: &Run) -> Result<Verdict, Failure> {
    let Settings { log, audit, users, .. } = station::settings(path, &args.drive, None)?;
    let more = More {
        profile: args.profile,
        scan: args.scan,
        plant: args.plant.as_deref(),
        seed: args.seed,
        users: users.as_deref(),
        logged: audit.is_kept(),
    };
    let station = station::start(path, source, &args.drive, more)?;
    let Some(station) = station else { return Ok(Verdict::Found) };
    let Station { names, origin, running, monitor, post, historian, panels, claims: _claims, .. } = station;
    let attendant = Attendant::new(names).with(monitor, post).logging(log, audit).recording(historian);
    attendant.at(panels).changing(origin).attend(running, args.duration)
}
