//! `g7 run --online`: the chart drives the devices of its io file, until it is told to end.
//!
//! Commands come as lines on the standard input, events go to the standard error.

use std::io::BufRead as _;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use g7_host::{Clock, Start, WallClock};
use g7_model::Nanos;
use g7_online::{
    AtDevice, Clients, Command, Controller, Happened, KeepError, Mode, Options, RealDisk, Reason, Running,
    Slots, Started, What, Wired,
};
use g7_rig::{Bench, Role};
use signal_hook::consts::{SIGINT, SIGTERM};

use crate::cli::Run;
use crate::failure::{Failure, Verdict, plain};
use crate::message::talk;
use crate::sources::Source;
use crate::style;
use crate::wiring::{self, Plan, Wanted};

/// The pause between two looks at the events.
const PAUSE: Duration = Duration::from_millis(20);
/// Periods without a step after which the watchdog trips, and the least time for them.
const WATCHDOG: (i64, Nanos) = (10, Nanos::from_millis(100));
const HELP: &str = "commands: run, stop, ack (ends a fault), cold (initial situation), status, quit";

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
    Attendant { plan: &plan, clock: WallClock::default(), mode: Mode::Stop }.attend(running, args.duration)
}

/// The system has no resources for a thread or a connection.
fn refused(error: std::io::Error) -> Failure {
    Failure::Usage(format!("the system refuses: {}", plain(&error)))
}

/// Opens the file of the values that are kept, and starts the run with them.
fn kept(
    plan: &Plan<'_>,
    runner: g7_host::Runner,
) -> Result<(g7_host::Runner, Option<Slots<RealDisk>>), Failure> {
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

/// The one who looks at the events of a running machine and hands the commands on.
struct Attendant<'a> {
    plan: &'a Plan<'a>,
    clock: WallClock,
    mode: Mode,
}

impl Attendant<'_> {
    fn attend(mut self, mut running: Running, length: Option<Nanos>) -> Result<Verdict, Failure> {
        let ended = Arc::new(AtomicBool::new(false));
        for signal in [SIGINT, SIGTERM] {
            signal_hook::flag::register(signal, Arc::clone(&ended)).map_err(refused)?;
        }
        let lines = lines();
        loop {
            self.tell(&mut running);
            let over = length.is_some_and(|length| self.clock.now() >= length);
            if over || ended.load(Ordering::Acquire) || !running.is_alive() {
                break;
            }
            match lines.try_recv().as_deref() {
                Ok("quit") => break,
                Ok(line) => self.obey(line, &mut running),
                Err(_) => std::thread::sleep(PAUSE),
            }
        }
        let panicked = !running.is_alive();
        let controller = running.end();
        if panicked || controller.is_none() {
            return Err(Failure::Usage("the scan ended by an error of G7; outputs are safe".to_owned()));
        }
        if let Some(controller) = &controller {
            self.status(controller);
        }
        Ok(if matches!(self.mode, Mode::Fault(_)) { Verdict::Found } else { Verdict::Fine })
    }

    fn obey(&mut self, line: &str, running: &mut Running) {
        let command = match line {
            "run" => Command::Run,
            "stop" => Command::Stop,
            "ack" => Command::Acknowledge,
            "cold" => Command::Restart(Start::Cold),
            "" => return,
            "status" => return talk!("{} {}", self.time(), self.mode_text(self.mode)),
            _ => return talk!("{HELP}"),
        };
        if !running.command(command) {
            talk!("the scan takes no commands");
        }
    }

    /// Prints what happened since the last call.
    fn tell(&mut self, running: &mut Running) {
        while let Ok(event) = running.events.pop() {
            match event.what {
                What::Mode(mode) => {
                    self.mode = mode;
                    talk!("{} {}", self.time(), self.mode_text(mode));
                }
                What::Missed(n) => talk!("{} {n} scans came too late and were left out", self.time()),
            }
        }
        while let Ok(AtDevice { device, happened }) = running.devices.try_recv() {
            talk!("{} {}", self.time(), self.device_text(device, &happened));
        }
        while let Ok(why) = running.no_priority.try_recv() {
            talk!("{}note:{:#} {why}", style::WARN, style::WARN);
        }
        while let Ok(e) = running.disk.try_recv() {
            talk!("{} {}values cannot be saved:{:#} {}", self.time(), style::BAD, style::BAD, plain(&e));
        }
    }

    fn time(&mut self) -> String {
        format!("{:>10.3}s", self.clock.now().count() as f64 / 1e9)
    }

    fn mode_text(&self, mode: Mode) -> String {
        let (good, bad) = (style::GOOD, style::BAD);
        match mode {
            Mode::Stop => "stopped".to_owned(),
            Mode::Run => format!("{good}running{good:#}"),
            Mode::Fault(reason) => {
                let bench = &self.plan.bench;
                let why = match reason {
                    Reason::Watchdog => "a scan took longer than the watchdog allows".to_owned(),
                    Reason::Input(index) => format!("the input `{}` is bad", input(bench, index)),
                    Reason::Halt(halt) => {
                        let place =
                            bench.halt_place(halt).map(|at| format!("{}: ", self.plan.source.place(at)));
                        format!("{}{}", place.unwrap_or_default(), kind(halt))
                    }
                };
                format!("{bad}fault:{bad:#} {why}; outputs are safe (`ack` ends it)")
            }
        }
    }

    fn device_text(&self, device: usize, happened: &Happened) -> String {
        let Some(Wired { device, inputs, outputs, .. }) = self.plan.wiring.devices.get(device) else {
            return String::new();
        };
        let name = &device.name.value;
        let input = |k: &usize| inputs.get(*k).map_or("", |i| &i.name);
        let output = |k: &usize| outputs.get(*k).map_or("", |o| &o.name);
        let (good, bad, warn) = (style::GOOD, style::BAD, style::WARN);
        match happened {
            Happened::Up if device.kind.is_server() => format!("{name} {good}has a master{good:#}"),
            Happened::Up => format!("{name} {good}answers{good:#}"),
            Happened::Down(why) if device.kind.is_server() => {
                format!("{name} {warn}has no master:{warn:#} {why}")
            }
            Happened::Down(why) => format!("{name} {bad}does not answer:{bad:#} {why}"),
            Happened::NoInput(k, why) => format!("{name}: {warn}no value{warn:#} for `{}`: {why}", input(k)),
            Happened::Input(k) => format!("{name}: `{}` has a value again", input(k)),
            Happened::NoOutput(k, why) => format!("{name} {warn}refuses{warn:#} `{}`: {why}", output(k)),
            Happened::Output(k) => format!("{name} takes `{}` again", output(k)),
            Happened::Limited(k) => {
                format!("{name}: {warn}`{}` is limited{warn:#} to what its point holds", output(k))
            }
        }
    }

    fn status(&self, controller: &Controller) {
        let (state, bench) = (controller.runner().state(), &self.plan.bench);
        let situation = bench.situation(state).join(", ");
        let (scans, missed) = (state.scans(), controller.runner().missed());
        talk!("{scans} scans, {missed} left out; the situation is {{{situation}}}");
    }
}

/// The name of an input word.
fn input(bench: &Bench, index: u32) -> &str {
    let found = bench.items.iter().find(|i| i.role == Role::Input(index));
    found.map_or("", |i| &i.name)
}

fn kind(halt: g7_host::Halt) -> String {
    match halt {
        g7_host::Halt::Charts(fault) => fault.kind.to_string(),
        g7_host::Halt::Plant(fault) => format!("the plant: {}", fault.kind),
    }
}

/// The lines of the standard input, as they come; at its end there are no more.
fn lines() -> Receiver<String> {
    let (give, lines) = channel();
    std::thread::spawn(move || {
        for line in std::io::stdin().lock().lines().map_while(Result::ok) {
            if give.send(line.trim().to_owned()).is_err() {
                return;
            }
        }
    });
    lines
}
