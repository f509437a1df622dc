//! A controller with all that belongs to it, from its files: for `run --online` and for
//! `serve --online`.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use clap::Args;
use g7_model::{Nanos, ProfileName, say};
use g7_online::setup::{Kind, Setup};
use g7_online::{Command, KeepError, Options, Panels, RealDisk, Running, Sight, Slots, Started};
use g7_store::log::Log;

use crate::audit::{self, Audit};
use crate::brought;
use crate::failure::{Failure, plain, raw, refused};
use crate::history::{self, Historian};
use crate::message::talk;
use crate::monitor::Monitor;
use crate::operator::{HELP, Names};
use crate::origin::Origin;
use crate::post::Post;
use crate::sole::{self, Sole};
use crate::sources::Source;
use crate::style;
use crate::wiring::{self, Plan};

/// Periods without a step after which the watchdog trips, and the least time for them.
const WATCHDOG: (i64, Nanos) = (10, Nanos::from_millis(250));

/// The arguments that put a chart on line.
#[derive(Args, Debug)]
pub(crate) struct Drive {
    /// Drive real devices, those of the io file beside the chart.
    #[arg(long)]
    pub(crate) online: bool,
    /// With --online: the io file [default: chart.io.toml for chart.g7].
    #[arg(long, value_name = "FILE", requires = "online")]
    pub(crate) io: Option<PathBuf>,
    /// With --online: take the plant in place of these devices, or of all.
    #[arg(long, value_name = "DEVICES", requires = "online", num_args = 0.., value_delimiter = ',')]
    pub(crate) simulate: Option<Vec<String>>,
}

/// The other arguments that change how a chart is driven.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct More<'a> {
    pub(crate) profile: Option<ProfileName>,
    pub(crate) scan: Option<Nanos>,
    pub(crate) plant: Option<&'a str>,
    pub(crate) seed: u64,
    /// The file of the users.
    pub(crate) users: Option<&'a Path>,
    /// True if what people do is written down.
    pub(crate) logged: bool,
}

/// A controller that works.
pub(crate) struct Station {
    pub(crate) names: Names,
    pub(crate) origin: Origin,
    pub(crate) running: Running,
    pub(crate) sight: Sight,
    pub(crate) monitor: Option<Monitor>,
    pub(crate) post: Option<Post>,
    pub(crate) panels: Panels,
    pub(crate) historian: Option<Historian>,
    /// The files that it alone writes.
    pub(crate) claims: Vec<Sole>,
}

/// The settings of those who use the controller, from the io file, read before anything else: a log that cannot be
/// written is found before anything moves.
pub(crate) struct Settings {
    pub(crate) setup: Setup,
    /// The io file.
    pub(crate) io: PathBuf,
    pub(crate) log: Option<Log>,
    pub(crate) audit: Audit,
    /// The file of the log.
    pub(crate) log_file: Option<PathBuf>,
    /// The file of the users.
    pub(crate) users: Option<PathBuf>,
}

/// Reads them. What is wrong with the file is told by [`start`], which reads it again.
pub(crate) fn settings(path: &Path, drive: &Drive, log: Option<&Path>) -> Result<Settings, Failure> {
    let io = wiring::io_file(path, drive.io.as_deref());
    let setup = wiring::settings(&io);
    let (mut kept, mut log_file) = (None, None);
    if let Some(path) = log {
        log_file = Some(path.to_path_buf());
        kept = Some(audit::open(path, None, None)?);
    } else if let Some(file) = &setup.controller.log {
        log_file = Some(io.with_file_name(&file.file.value));
        kept = Some(audit::of_file(&io, file)?);
    }
    let (log, audit) = kept.map_or_else(Default::default, |(log, audit)| (Some(log), audit));
    let users = setup.server.users.as_ref().map(|users| io.with_file_name(&users.value));
    Ok(Settings { setup, io, log, audit, log_file, users })
}

/// Starts the controller of a chart, or prints the problems of its files.
pub(crate) fn start(
    path: &Path,
    source: Source,
    drive: &Drive,
    more: More<'_>,
) -> Result<Option<Station>, Failure> {
    let origin = Origin {
        path: path.to_path_buf(),
        io: drive.io.clone(),
        simulate: drive.simulate.clone(),
        plant: more.plant.map(str::to_owned),
        profile: more.profile,
        scan: more.scan,
    };
    let Some(plan) = wiring::plan(path, &source, &origin.wanted())? else { return Ok(None) };
    let Plan { bench, setup, wiring, .. } = &plan;
    if !wiring.unwired.is_empty() {
        talk!("{}note:{:#} no device has {}", style::WARN, style::WARN, wiring.unwired.join(", "));
    }
    let monitor = match &setup.controller.metrics {
        None => None,
        Some(at) => Some(Monitor::serve(at.value).map_err(|e| {
            Failure::Usage(say!("cannot listen at {} for `metrics`: {}", raw(at.value), plain(&e)))
        })?),
    };
    let claims = claims(&plan)?;
    let (runner, slots) = kept(&plan, g7_online::runner(bench, wiring, more.seed))?;
    let mut clients = brought::serving(wiring, more.users, more.logged)?;
    let post = Post::open(wiring, &plan.io, &mut clients)?;
    let mut machine = g7_online::assemble(runner, wiring, |wired| clients.device(wired)).map_err(refused)?;
    let kept = slots.map(|slots| machine.keep(bench, slots));
    let sight = machine.show();
    let record = wiring.history.as_ref().map(|chosen| history::open(&plan.io, chosen)).transpose()?;
    let notes = machine.record(wiring);
    let watchdog = setup.controller.watchdog.as_ref().map(|w| w.value);
    let options = Options {
        watchdog: watchdog.unwrap_or((bench.period * WATCHDOG.0).max(WATCHDOG.1)),
        priority: setup.controller.priority.as_ref().and_then(|p| u8::try_from(p.value).ok()),
    };
    let mut running = g7_online::start(machine, kept, options).map_err(refused)?;
    let clock = running.clock;
    let historian = record.zip(notes).map(|(record, notes)| Historian::start(record, notes, clock));
    let historian = historian.transpose().map_err(refused)?;
    if setup.controller.run {
        running.command(Command::Run);
    } else {
        talk!("stopped; {HELP}");
    }
    let names = Names::new(source, plan.bench, plan.wiring);
    let panels = clients.panels;
    Ok(Some(Station { names, origin, running, sight, monitor, post, panels, historian, claims }))
}

/// Takes the files that the controller writes, before it opens any of them.
fn claims(plan: &Plan) -> Result<Vec<Sole>, Failure> {
    let events = plan.wiring.devices.iter().filter_map(|wired| match &wired.device.kind {
        Kind::Mqtt(broker) => broker.events.as_ref().map(|events| events.file.value.as_str()),
        _ => None,
    });
    let retain = plan.setup.controller.retain.as_ref().map(|name| name.value.as_str());
    let history = plan.wiring.history.as_ref().map(|chosen| chosen.file.as_str());
    let files: BTreeSet<&str> = retain.into_iter().chain(history).chain(events).collect();
    files.into_iter().map(|file| sole::claim(&plan.io.with_file_name(file))).collect()
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
                    say!(
                        "`changed = \"fit\"` in [controller] takes the retained variables over, \"cold\" begins anew"
                    )
                }
                KeepError::Slots(_) => say!("move it away to begin anew"),
            };
            Err(Failure::Usage(say!("cannot use {}: {e}; {way}", raw(path.display()), e = raw(&e))))
        }
    }
}
