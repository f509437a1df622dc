//! `g7 service`: a controller that the system starts, by a unit of systemd.
//!
//! ```text
//! install -> wiring::plan (the chart can run) -> unit::text -> the file of the unit -> systemctl
//! the unit -> `run --online` or `serve --online`, which tell systemd how it goes (`manager.rs`)
//! ```

mod unit;

use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};
use std::process::Command as Program;

use clap::{Args, Subcommand};
use g7_online::setup::Kind;

use g7_model::say;

use crate::failure::{Failure, Verdict, plain, raw};
use crate::message::{done, note, tell};
use crate::wiring::{self, Plan, Wanted};
use crate::{files, sources};

use unit::{Runs, Unit};

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  g7 service install sorter --print         the unit, to look at
  sudo g7 service install sorter            /etc/systemd/system/g7-sorter.service
  sudo systemctl enable --now g7-sorter     starts it, now and with the system
  systemctl status g7-sorter                how it goes: running, stopped, fault
  journalctl -u g7-sorter                   what happened
  sudo g7 service remove g7-sorter          stops it and takes the unit away
  g7 service install sorter --user          a service of your own, without sudo

The io file says whether the controller runs as soon as it is started (`start`), and
which values outlive it (`retain`).

Exit codes:
  0  done
  1  the chart or the io file has a problem
  2  bad usage, or something outside the chart: no such file, no systemd")]
pub(crate) struct Service {
    #[command(subcommand)]
    command: Work,
}

#[derive(Subcommand, Debug)]
enum Work {
    /// Write the unit of a chart and make it known to systemd.
    Install(Install),
    /// Stop a service and take its unit away.
    Remove(Remove),
}

#[derive(Args, Debug)]
struct Install {
    /// A chart with an io file, or a folder with a chart.g7.
    #[arg(default_value = ".")]
    path: PathBuf,
    /// The io file [default: chart.io.toml for chart.g7].
    #[arg(long, value_name = "FILE")]
    io: Option<PathBuf>,
    /// The name of the service [default: g7- with the name of the chart or its folder].
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// A service of this user, which runs while he or she is logged in.
    #[arg(long)]
    user: bool,
    /// The user whose rights the service has [default: the owner of the chart].
    #[arg(long, value_name = "USER", conflicts_with = "user")]
    run_as: Option<String>,
    /// With the page of the operator; the journal has its address.
    #[arg(long)]
    page: bool,
    /// Start it again after a crash. The machine may then move without a person at it.
    #[arg(long)]
    restart: bool,
    /// Print the unit and write nothing.
    #[arg(long)]
    print: bool,
}

#[derive(Args, Debug)]
struct Remove {
    /// The name of the service.
    name: String,
    /// A service of this user.
    #[arg(long)]
    user: bool,
}

pub(crate) fn service(args: &Service) -> Result<Verdict, Failure> {
    match &args.command {
        Work::Install(args) => install(args),
        Work::Remove(args) => remove(args),
    }
}

fn install(args: &Install) -> Result<Verdict, Failure> {
    let found = files::one(&args.path)?;
    let path = found.canonicalize().map_err(|e| Failure::Read(found.clone(), e))?;
    let source = sources::load(&path, 0)?;
    let wanted = Wanted { io: args.io.as_deref(), ..Wanted::default() };
    let Some(plan) = wiring::plan(&path, &source, &wanted)? else { return Ok(Verdict::Found) };
    let io = plan.io.canonicalize().map_err(|e| Failure::Read(plan.io.clone(), e))?;
    let name = match &args.name {
        Some(name) => name.clone(),
        None => format!("g7-{}", called(&path)),
    };
    unit::check_name(&name).map_err(Failure::Usage)?;
    let binary = std::env::current_exe().map_err(|e| Failure::Read(PathBuf::from("g7"), e))?;
    let unit = Unit {
        binary: &binary,
        chart: &path,
        io: &io,
        name: &name,
        runs: if args.page { Runs::Serve } else { Runs::Run },
        of_user: args.user,
        run_as: owner(args, &path)?,
        restart: args.restart,
        keeps: writes(&plan.setup),
        serial: has(&plan, |kind| matches!(kind, Kind::ModbusRtu(..))),
        low_port: has(&plan, |kind| kind.listens().is_some_and(|address| address.port() < 1024))
            || plan.setup.server.port.as_ref().is_some_and(|port| (1..1024).contains(&port.value)),
        realtime: plan.setup.controller.priority.is_some(),
    };
    let text = unit.text().map_err(Failure::Usage)?;
    if args.print {
        files::deliver(None, text.as_bytes())?;
        return Ok(Verdict::Fine);
    }
    let folder = folder(args.user)?;
    std::fs::create_dir_all(&folder).map_err(|e| Failure::Write(folder.clone(), e))?;
    let file = folder.join(format!("{name}.service"));
    files::deliver(Some(&file), text.as_bytes())?;
    systemctl(args.user, &["daemon-reload"])?;
    let user = if args.user { "--user " } else { "" };
    tell(say!("start it with `systemctl {user}enable --now {name}`"));
    Ok(Verdict::Fine)
}

fn remove(args: &Remove) -> Result<Verdict, Failure> {
    unit::check_name(&args.name).map_err(Failure::Usage)?;
    let file = folder(args.user)?.join(format!("{}.service", args.name));
    let text = std::fs::read(&file).map_err(|e| Failure::Read(file.clone(), e))?;
    if !unit::is_ours(&text) {
        return Err(Failure::Usage(say!("{} was not written by g7: it is left alone", raw(file.display()))));
    }
    systemctl(args.user, &["disable", "--now", &args.name])?;
    std::fs::remove_file(&file).map_err(|e| Failure::Write(file.clone(), e))?;
    systemctl(args.user, &["daemon-reload"])?;
    done(&say!("removed"), file.display());
    Ok(Verdict::Fine)
}

fn has(plan: &Plan, of: impl Fn(&Kind) -> bool) -> bool {
    plan.wiring.devices.iter().any(|wired| of(&wired.device.kind))
}

/// The usual name of a chart: that of its file or, for `chart.g7`, of its folder.
fn called(path: &Path) -> String {
    let stem = |path: &Path| path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let name = stem(path);
    match path.parent() {
        Some(folder) if name == "chart" && folder.file_name().is_some() => stem(folder),
        _ => name,
    }
}

/// The user of a service of the system: as named, or the owner of the chart by number.
fn owner(args: &Install, path: &Path) -> Result<Option<String>, Failure> {
    if args.user {
        return Ok(None);
    }
    if let Some(name) = &args.run_as {
        return Ok(Some(name.clone()));
    }
    let uid = std::fs::metadata(path).map_err(|e| Failure::Read(path.to_path_buf(), e))?.uid();
    if uid == 0 {
        note(say!(
            "the chart belongs to root, and so the service would have all rights; --run-as names another user"
        ));
    }
    Ok(Some(uid.to_string()))
}

/// The folder of units: of the system, or of the user.
fn folder(user: bool) -> Result<PathBuf, Failure> {
    if !user {
        return Ok(PathBuf::from("/etc/systemd/system"));
    }
    let config = std::env::var_os("XDG_CONFIG_HOME")
        .map(PathBuf::from)
        .or_else(|| std::env::var_os("HOME").map(|home| Path::new(&home).join(".config")));
    config
        .map(|config| config.join("systemd/user"))
        .ok_or_else(|| Failure::Usage(say!("neither XDG_CONFIG_HOME nor HOME is set")))
}

fn systemctl(user: bool, arguments: &[&str]) -> Result<(), Failure> {
    let mut program = Program::new("systemctl");
    if user {
        program.arg("--user");
    }
    let line = format!("systemctl {}{}", if user { "--user " } else { "" }, arguments.join(" "));
    let done = program.args(arguments).output();
    let done = done.map_err(|e| Failure::Usage(say!("`{line}` cannot be started: {}", plain(&e))))?;
    if done.status.success() {
        return Ok(());
    }
    let why = String::from_utf8_lossy(&done.stderr);
    Err(Failure::Usage(say!("`{line}` failed: {}", raw(why.trim()))))
}

/// True if the controller writes files beside its io file.
fn writes(setup: &g7_online::setup::Setup) -> bool {
    let controller = &setup.controller;
    let kept = controller.retain.is_some() || controller.log.is_some();
    kept || setup.server.users.is_some() || setup.history.is_some()
}
