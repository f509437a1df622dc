//! `g7 run --online`: the chart drives the devices of its io file, until it is told to end.

use std::path::Path;

use g7_model::Nanos;
use g7_online::{Clients, Command, KeepError, Options, RealDisk, Slots, Started};

use crate::attendant::{Attendant, HELP, refused};
use crate::cli::Run;
use crate::failure::{Failure, Verdict, plain};
use crate::message::talk;
use crate::monitor::Monitor;
use crate::sources::Source;
use crate::style;
use crate::wiring::{self, Plan, Wanted};

/// Periods without a step after which the watchdog trips, and the least time for them.
const WATCHDOG: (i64, Nanos) = (10, Nanos::from_millis(100));

pub(super) fn run(path: &Path, source: &Source, args: &Run) -> Result<Verdict, Failure> {
    let wanted = Wanted {
        io: args.io.as_deref(),
        simulate: args.simulate.as_deref(),
        plant: args.plant.as_deref(),
        profile: args.profile,
        scan: args.scan,
    };
    let Some(plan) = wiring::plan(path, source, &wanted)? else { return Ok(Verdict::Found) };
    let Plan { bench, setup, wiring, .. } = &plan;
    if !wiring.unwired.is_empty() {
        talk!("{}note:{:#} no device has {}", style::WARN, style::WARN, wiring.unwired.join(", "));
    }
    let monitor = match &setup.controller.metrics {
        None => None,
        Some(at) => Some(Monitor::serve(at.value).map_err(|e| {
            Failure::Usage(format!("cannot listen at {} for `metrics`: {}", at.value, plain(&e)))
        })?),
    };
    let (runner, slots) = kept(&plan, g7_online::runner(bench, wiring, args.seed))?;
    let mut clients = Clients::default();
    let mut machine = g7_online::assemble(runner, wiring, |wired| clients.device(wired)).map_err(refused)?;
    let kept = slots.map(|slots| machine.keep(bench, slots));
    let watchdog = setup.controller.watchdog.as_ref().map(|w| w.value);
    let options = Options {
        watchdog: watchdog.unwrap_or((bench.period * WATCHDOG.0).max(WATCHDOG.1)),
        priority: setup.controller.priority.as_ref().and_then(|p| u8::try_from(p.value).ok()),
    };
    let mut running = g7_online::start(machine, kept, options).map_err(refused)?;
    if setup.controller.run {
        running.command(Command::Run);
    } else {
        talk!("stopped; {HELP}");
    }
    Attendant::new(source, bench, wiring).with(monitor).attend(running, args.duration)
}

/// Opens the file of the values that are kept, and starts the run with them.
fn kept(plan: &Plan, runner: g7_host::Runner) -> Result<(g7_host::Runner, Option<Slots<RealDisk>>), Failure> {
    let Some(name) = &plan.setup.controller.retain else { return Ok((runner, None)) };
    let path = plan.io.with_file_name(&name.value);
    let disk = || RealDisk::new(&path);
    match g7_online::open(disk, &plan.bench, runner, plan.setup.controller.changed) {
        Ok((slots, runner, started)) => {
            match started {
                Started::Cold => {}
                Started::Warm => talk!("warm start with the values of {}", path.display()),
                Started::Fitted(fitted, all) => {
                    talk!("another program: {fitted} of {all} retained variables of {}", path.display());
                }
            }
            Ok((runner, Some(slots)))
        }
        Err(e) => {
            let way = match e {
                KeepError::Changed => {
                    "`changed = \"fit\"` in [controller] takes the retained variables over, \"cold\" begins anew"
                }
                KeepError::Slots(_) => "move it away to begin anew",
            };
            Err(Failure::Usage(format!("cannot use {}: {e}; {way}", path.display())))
        }
    }
}
