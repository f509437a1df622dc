//! The one who attends a machine that runs: commands come as lines on the standard input, events go to
//! the standard error.

use std::io::BufRead as _;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use g7_engine::Addr;
use g7_host::{Clock, Start, Value, WallClock};
use g7_model::Nanos;
use g7_online::{
    AtDevice, Command, Controller, Happened, Mode, Paces, Reason, Running, Target, What, Wired, Wiring,
};
use g7_rig::{Bench, Item, Role};
use signal_hook::consts::{SIGINT, SIGTERM};

use crate::failure::{Failure, Verdict, plain};
use crate::message::talk;
use crate::monitor::Monitor;
use crate::sources::Source;
use crate::{style, values};

/// The pause between two looks at the events.
const PAUSE: Duration = Duration::from_millis(20);
pub(crate) const HELP: &str =
    "commands: run, stop, ack (ends a fault), cold (initial situation), status, quit";

/// The system has no resources for a thread or a connection.
pub(crate) fn refused(error: std::io::Error) -> Failure {
    Failure::Usage(format!("the system refuses: {}", plain(&error)))
}

/// The one who looks at the events of a running machine and hands the commands on.
pub(crate) struct Attendant<'a> {
    source: &'a Source,
    bench: &'a Bench,
    wiring: &'a Wiring,
    clock: WallClock,
    mode: Mode,
    paces: Paces,
    monitor: Option<Monitor>,
    /// Lines `NAME := VALUE` set an input or a state.
    sets: bool,
}

impl<'a> Attendant<'a> {
    pub(crate) fn new(source: &'a Source, bench: &'a Bench, wiring: &'a Wiring) -> Attendant<'a> {
        let (clock, paces) = (WallClock::default(), Paces::default());
        Attendant { source, bench, wiring, clock, mode: Mode::Stop, paces, monitor: None, sets: false }
    }

    /// Tells a monitor what happens.
    pub(crate) fn with(self, monitor: Option<Monitor>) -> Attendant<'a> {
        Attendant { monitor, ..self }
    }

    /// Takes lines that set a value as well.
    pub(crate) fn that_sets(self) -> Attendant<'a> {
        Attendant { sets: true, ..self }
    }

    /// Looks at the events and hands commands on until the run ends; a run has a length or none.
    pub(crate) fn attend(mut self, mut running: Running, length: Option<Nanos>) -> Result<Verdict, Failure> {
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
            assigned if self.sets && assigned.contains('=') => match self.assigned(assigned) {
                Ok(command) => command,
                Err(why) => return talk!("{why}"),
            },
            "status" => {
                talk!("{} {}", self.time(), self.mode_text(self.mode));
                return self.tell_pace();
            }
            _ if self.sets => return talk!("{HELP}, NAME := VALUE"),
            _ => return talk!("{HELP}"),
        };
        if !running.command(command) {
            talk!("the scan takes no commands");
        }
    }

    /// Reads `NAME := VALUE`.
    fn assigned(&self, line: &str) -> Result<Command, String> {
        let (name, value) = line.split_once('=').unwrap_or((line, ""));
        let name = name.trim_end_matches(':').trim();
        let item = self.bench.item(name).ok_or_else(|| self.bench.unknown(name))?;
        let word = match values::read(value, item.kind)? {
            Value::Word(word) => word,
            Value::Text(_) => return Err(format!("`{name}` is a text: it cannot be set here")),
        };
        Ok(match item.role {
            Role::Input(index) => Command::SetInput(index, word),
            Role::Output | Role::Variable => Command::SetWord(Addr(item.addr), word),
            Role::Plant => Command::SetPlant(Addr(item.addr), word),
        })
    }

    /// Prints what happened since the last call.
    fn tell(&mut self, running: &mut Running) {
        while let Ok(event) = running.events.pop() {
            match event.what {
                What::Mode(mode) => {
                    self.mode = mode;
                    self.monitored(|m| m.mode(mode));
                    talk!("{} {}", self.time(), self.mode_text(mode));
                }
                What::Missed(n) => {
                    self.monitored(|m| m.missed(n));
                    talk!("{} {n} scans came too late and were left out", self.time());
                }
            }
        }
        while let Ok(pace) = running.paces.pop() {
            self.paces.add(pace);
            self.monitored(|m| m.pace(pace));
        }
        while let Ok(AtDevice { device, happened }) = running.devices.try_recv() {
            if let (Happened::Up | Happened::Down(_), Some(wired)) =
                (&happened, self.wiring.devices.get(device))
            {
                self.monitored(|m| m.device(&wired.device.name.value, happened == Happened::Up));
            }
            talk!("{} {}", self.time(), self.device_text(device, &happened));
        }
        while let Ok(why) = running.no_priority.try_recv() {
            talk!("{}note:{:#} {why}", style::WARN, style::WARN);
        }
        while let Ok(e) = running.disk.try_recv() {
            self.monitored(Monitor::unsaved);
            talk!("{} {}values cannot be saved:{:#} {}", self.time(), style::BAD, style::BAD, plain(&e));
        }
    }

    fn monitored(&self, tell: impl FnOnce(&Monitor)) {
        if let Some(monitor) = &self.monitor {
            tell(monitor);
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
                let bench = self.bench;
                let why = match reason {
                    Reason::Watchdog => "a scan took longer than the watchdog allows".to_owned(),
                    Reason::Input(target) => format!("the input `{}` is bad", input(bench, target)),
                    Reason::Halt(halt) => {
                        let place = bench.halt_place(halt).map(|at| format!("{}: ", self.source.place(at)));
                        format!("{}{}", place.unwrap_or_default(), kind(halt))
                    }
                };
                format!("{bad}fault:{bad:#} {why}; outputs are safe (`ack` ends it)")
            }
        }
    }

    fn device_text(&self, device: usize, happened: &Happened) -> String {
        let Some(Wired { device, inputs, outputs, .. }) = self.wiring.devices.get(device) else {
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

    fn tell_pace(&self) {
        if self.paces.scans() > 0 {
            talk!("scans were late: {}", self.paces.late());
            talk!("scans took: {}", self.paces.took());
        }
    }

    fn status(&self, controller: &Controller) {
        let (state, bench) = (controller.runner().state(), self.bench);
        let situation = bench.situation(state).join(", ");
        let (scans, missed) = (state.scans(), controller.runner().missed());
        talk!("{scans} scans, {missed} left out; the situation is {{{situation}}}");
        self.tell_pace();
    }
}

/// The name of what a device gives.
fn input(bench: &Bench, target: Target) -> &str {
    let is = |item: &&Item| match target {
        Target::Input(index) => item.role == Role::Input(index),
        Target::Word(addr) => item.role != Role::Plant && item.addr == addr.0,
    };
    let found = bench.items.iter().find(is);
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
