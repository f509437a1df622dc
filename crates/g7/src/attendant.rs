//! The one who attends a machine that runs: wishes come as lines of the standard input and from the page,
//! events go to the standard error and to the page.

use std::io::BufRead as _;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use g7_engine::Addr;
use g7_host::{Clock, Value, WallClock};
use g7_model::{Nanos, say};
use g7_online::{Answer, AtDevice, Command, Controller, Happened, Mode, Paces, Panels, Running, What};
use g7_rig::Role;
use g7_store::log::Log;
use serde_json::{Value as Json, json};
use signal_hook::consts::{SIGINT, SIGTERM};

use crate::audit::{Audit, Pending};
use crate::failure::{Failure, Verdict, plain, refused};
use crate::history::{Historian, Kept};
use crate::manager::Manager;
use crate::message::talk;
use crate::monitor::Monitor;
use crate::operator::{Adopted, Asker, Changes, HELP, Names, Stage, Told, Wish, mode_text, operate};
use crate::origin::Origin;
use crate::post::Post;
use crate::who::Who;

/// The pause between two looks at the events.
const PAUSE: Duration = Duration::from_millis(20);
/// Greatest number of orders of pages between two looks at the events.
const ORDERS: usize = 32;
/// The time between two rows of scans that were left out, and between two looks at the log.
const SUM: Nanos = Nanos::SECOND;
/// A command that the scan has not answered after this time is given up.
const PATIENCE: Nanos = Nanos::from_millis(3_000);

/// A command on its way through the scan.
struct Asked {
    number: u64,
    until: Nanos,
    by: Asker,
}

/// The one who looks at the events of a running machine and hands the commands on.
pub(crate) struct Attendant {
    names: Names,
    clock: WallClock,
    mode: Mode,
    paces: Paces,
    monitor: Option<Monitor>,
    post: Option<Post>,
    historian: Option<Historian>,
    stage: Option<Stage>,
    changes: Option<Changes>,
    panels: Panels,
    asked: Vec<Asked>,
    log: Option<Log>,
    audit: Audit,
    /// Wishes of lines that wait for their row in the log.
    held: Vec<(Wish, Pending)>,
    /// Scans that were left out and are no row of the log yet, and the time for it.
    missed: (u64, Nanos),
    /// Lines `NAME := VALUE` set an input or a state.
    sets: bool,
}

impl Attendant {
    pub(crate) fn new(names: Names) -> Attendant {
        Attendant {
            names,
            clock: WallClock::default(),
            mode: Mode::Stop,
            paces: Paces::default(),
            monitor: None,
            post: None,
            historian: None,
            stage: None,
            changes: None,
            panels: Panels::default(),
            asked: Vec::new(),
            log: None,
            audit: Audit::default(),
            held: Vec::new(),
            missed: (0, Nanos::ZERO),
            sets: false,
        }
    }

    /// Tells a monitor what happens, and brokers each event.
    pub(crate) fn with(self, monitor: Option<Monitor>, post: Option<Post>) -> Attendant {
        Attendant { monitor, post, ..self }
    }

    /// Writes what happens into a log, and what the terminal wants.
    pub(crate) fn logging(self, log: Option<Log>, audit: Audit) -> Attendant {
        Attendant { log, audit, ..self }
    }

    /// Tells how the record of the signals does; it ends behind the run.
    pub(crate) fn recording(self, historian: Option<Historian>) -> Attendant {
        Attendant { historian, ..self }
    }

    /// Tells pages what happens, and does what they want.
    pub(crate) fn on(self, stage: Stage) -> Attendant {
        Attendant { stage: Some(stage), ..self }
    }

    /// Changes the chart while it runs, on request: its files are read again.
    pub(crate) fn changing(self, origin: Origin) -> Attendant {
        Attendant { changes: Some(Changes::new(origin)), ..self }
    }

    /// Moves the parts of these panels.
    pub(crate) fn at(self, panels: Panels) -> Attendant {
        Attendant { panels, ..self }
    }

    /// Takes lines that set a value as well.
    pub(crate) fn that_sets(self) -> Attendant {
        Attendant { sets: true, ..self }
    }

    /// Looks at the events and hands commands on until the run ends; a run has a length or none.
    pub(crate) fn attend(mut self, mut running: Running, length: Option<Nanos>) -> Result<Verdict, Failure> {
        let ended = Arc::new(AtomicBool::new(false));
        for signal in [SIGINT, SIGTERM] {
            signal_hook::flag::register(signal, Arc::clone(&ended)).map_err(refused)?;
        }
        let lines = lines();
        let begin = json!({ "version": env!("CARGO_PKG_VERSION"), "chart": self.names.source.name });
        self.audit.event("note", "begin", Some(Nanos::ZERO), &begin);
        let mut manager = Manager::ready();
        manager.status(&mode_text(&self.names, self.mode));
        loop {
            let before = self.mode;
            self.tell(&mut running);
            if self.mode != before {
                manager.status(&mode_text(&self.names, self.mode));
            }
            manager.alive();
            self.settle(&mut running);
            self.change(&mut running);
            let over = length.is_some_and(|length| self.clock.now() >= length);
            if over || ended.load(Ordering::Acquire) || !running.is_alive() {
                break;
            }
            self.serve(&mut running);
            self.held(&mut running);
            self.left_out(false);
            match lines.try_recv().as_deref() {
                Ok("quit") => break,
                Ok(line) => self.obey(line, &mut running),
                Err(_) => std::thread::sleep(PAUSE),
            }
        }
        manager.stopping();
        let panicked = !running.is_alive();
        let controller = running.end();
        self.left_out(true);
        let now = self.clock.now();
        self.audit.event(if panicked { "alarm" } else { "note" }, "end", Some(now), &json!({}));
        drop(self.log.take());
        let verdict = verdict(controller.as_ref(), self.mode)?;
        if let Some(controller) = &controller {
            self.status(controller);
        }
        Ok(verdict)
    }

    /// Does what the pages want and shows them what there is. An error of G7 in this ends the pages; the
    /// machine goes on, and the terminal commands it.
    fn serve(&mut self, running: &mut Running) {
        if catch_unwind(AssertUnwindSafe(|| self.show(running))).is_err() {
            self.stage = None;
            talk!("{} the page ended by an error of G7; the controller goes on", self.time());
        }
    }

    fn show(&mut self, running: &mut Running) {
        let now = self.clock.now();
        // However many orders come, the events are looked at.
        for _ in 0..ORDERS {
            let Some(order) = self.stage.as_mut().and_then(|stage| stage.take(now, &self.paces)) else {
                break;
            };
            if let Some((wish, by)) = order {
                self.want(&wish, by, running);
            }
        }
        if let Some(stage) = &mut self.stage {
            if stage.is_watched() {
                self.panels.watched();
            }
            if let Some(changes) = &mut self.changes {
                stage.tell_file(changes.facts(&self.names, now));
            }
            stage.tick(now, &self.paces);
        }
    }

    /// Goes on with the chart of a change that was made.
    fn change(&mut self, running: &mut Running) {
        let Some(changes) = &mut self.changes else { return };
        changes.settle(&self.names, running);
        let Some(Adopted { names, sight, back, lost }) = changes.made() else { return };
        // Events until then have the names of the chart before.
        self.tell(running);
        self.names = names.clone();
        if let Some(stage) = &mut self.stage {
            stage.renew(names, sight);
        }
        let now = self.clock.now();
        self.note(now, &Told::Changed { back, lost });
    }

    /// Does a wish of the terminal, once it stands in the log where it must.
    fn line(&mut self, wish: Wish, running: &mut Running) {
        let Some((kind, data)) = wish.deed() else { return self.want(&wish, Asker::Line, running) };
        let at = Some(self.clock.now());
        if wish.waits_for_log() {
            let pending = self.audit.before(&Who::console(), &kind, at, &data);
            return self.held.push((wish, pending));
        }
        self.audit.note(&Who::console(), &kind, at, &data);
        self.want(&wish, Asker::Line, running);
    }

    /// Does the wishes of the terminal that stand in the log now.
    fn held(&mut self, running: &mut Running) {
        for (wish, pending) in std::mem::take(&mut self.held) {
            match pending.look() {
                None => self.held.push((wish, pending)),
                Some(Err(why)) => talk!("{why}"),
                Some(Ok(())) => self.want(&wish, Asker::Line, running),
            }
        }
    }

    /// Writes the scans that were left out as one row a second, and tells the monitor how the log is.
    fn left_out(&mut self, end: bool) {
        let now = self.clock.now();
        let (count, due) = self.missed;
        if now < due && !end {
            return;
        }
        self.missed = (0, now + SUM);
        if count > 0 {
            self.logged(now, &Told::Missed(count));
        }
        if let (Some(monitor), Some(state)) = (&self.monitor, self.audit.state()) {
            monitor.log(&state);
        }
    }

    /// Writes an event into the log.
    fn logged(&self, at: Nanos, told: &Told) {
        let mut data = told.json(&self.names);
        let kind = data.as_object_mut().and_then(|fields| fields.remove("kind"));
        if let (Some(fields), Some(text)) = (data.as_object_mut(), told.text(&self.names)) {
            fields.retain(|_, value| !value.is_null());
            fields.insert("text".to_owned(), json!(anstream::adapter::strip_str(&text).to_string()));
        }
        let kind = kind.as_ref().and_then(Json::as_str).unwrap_or_default();
        self.audit.event(told.level(&self.names).word(), kind, Some(at), &data);
    }

    /// Hands the command of a wish on.
    fn want(&mut self, wish: &Wish, by: Asker, running: &mut Running) {
        if let (Wish::Change { anyway } | Wish::Back { anyway }, Some(changes)) = (wish, &mut self.changes) {
            let back = matches!(wish, Wish::Back { .. });
            return changes.begin(&self.names, by, back, *anyway, running);
        }
        if let Wish::Press { .. } | Wish::Set { .. } = wish {
            return self.operate(wish, by);
        }
        let given = self.names.command(wish).and_then(|command| {
            let command = command.ok_or("this belongs to a page")?;
            running.command(command).ok_or_else(|| "the scan takes no commands".to_owned())
        });
        match given {
            Ok(number) => self.asked.push(Asked { number, until: self.clock.now() + PATIENCE, by }),
            Err(why) => answer(by, Err(why)),
        }
    }

    /// Moves a part of a panel.
    fn operate(&mut self, wish: &Wish, by: Asker) {
        let done = operate(&self.panels, &self.names, wish, &by);
        if let Ok(Some(told)) = &done {
            let now = self.clock.now();
            self.note(now, told);
        }
        answer(by, done.map(|_| ()));
    }

    /// Gives the answers of the scan to those who asked.
    fn settle(&mut self, running: &mut Running) {
        while let Ok(Answer { number, done }) = running.answers.pop() {
            if let Some(at) = self.asked.iter().position(|asked| asked.number == number) {
                answer(self.asked.remove(at).by, done.map_err(|why| why.to_string()));
            }
        }
        let now = self.clock.now();
        for late in self.asked.extract_if(.., |asked| now >= asked.until) {
            answer(late.by, Err("the scan does not answer".to_owned()));
        }
    }

    fn obey(&mut self, line: &str, running: &mut Running) {
        if line.is_empty() {
            return;
        }
        let given = match Wish::of_line(line) {
            Some(Ok(wish)) => return self.line(wish, running),
            Some(Err(why)) => Err(why),
            None if line == "status" => {
                talk!("{} {}", self.time(), mode_text(&self.names, self.mode));
                return self.tell_pace();
            }
            None if self.sets && line.contains('=') => self.assigned(line),
            None if self.sets => Err(format!("{HELP}, NAME := VALUE")),
            None => Err(HELP.to_owned()),
        };
        match given {
            Err(why) => talk!("{why}"),
            Ok(command) if running.command(command).is_none() => talk!("the scan takes no commands"),
            Ok(_) => {}
        }
    }

    /// Reads `NAME := VALUE`.
    fn assigned(&self, line: &str) -> Result<Command, String> {
        let (name, value) = line.split_once('=').unwrap_or((line, ""));
        let name = name.trim_end_matches(':').trim();
        let bench = &self.names.bench;
        let item = bench.item(name).ok_or_else(|| bench.unknown(name).to_string())?;
        let word = match item.read(value).map_err(|e| e.to_string())? {
            Value::Word(word) => word,
            Value::Text(_) => return Err(format!("`{name}` is a text: it cannot be set here")),
        };
        Ok(match item.role {
            Role::Input(index) => Command::SetInput(index, word),
            Role::Output | Role::Variable => Command::SetWord(Addr(item.addr), word),
            Role::Plant => Command::SetPlant(Addr(item.addr), word),
        })
    }

    /// Tells what happened since the last call.
    fn tell(&mut self, running: &mut Running) {
        while let Ok(event) = running.events.pop() {
            let told = match event.what {
                What::Mode(mode) => {
                    self.mode = mode;
                    self.monitored(|m| m.mode(mode));
                    Told::Mode(mode)
                }
                What::Missed(n) => {
                    self.monitored(|m| m.missed(n));
                    Told::Missed(n)
                }
                What::Forced(force) => Told::Forced(force),
                What::Released(what) => Told::Released(what),
                What::Ended(what) => Told::Ended(what),
                // Told with its losses by `Attendant::change`.
                What::Changed => continue,
            };
            self.note(event.at, &told);
        }
        while let Ok(pace) = running.paces.pop() {
            self.paces.add(pace);
            self.monitored(|m| m.pace(pace));
        }
        while let Ok(AtDevice { device, happened }) = running.devices.try_recv() {
            if let Happened::Up | Happened::Down(_) = happened
                && let Some(wired) = self.names.wired(device)
            {
                self.monitored(|m| m.device(&wired.device.name.value, happened == Happened::Up));
            }
            let now = self.clock.now();
            self.note(now, &Told::Device(device, happened));
        }
        while let Ok(why) = running.no_priority.try_recv() {
            let now = self.clock.now();
            self.note(now, &Told::NoPriority(why));
        }
        while let Some(kept) = self.historian.as_ref().and_then(|h| h.told.try_recv().ok()) {
            let now = self.clock.now();
            self.note(
                now,
                &match kept {
                    Kept::Fails(why) => Told::Unrecorded(why),
                    Kept::Goes(lost) => Told::Recorded(lost),
                },
            );
        }
        while let Ok(e) = running.disk.try_recv() {
            self.monitored(Monitor::unsaved);
            let now = self.clock.now();
            self.note(now, &Told::Unsaved(plain(&e).to_string()));
        }
        for (device, trouble) in self.post.as_ref().map(Post::troubles).unwrap_or_default() {
            let now = self.clock.now();
            self.note(now, &Told::Events(device, trouble));
        }
    }

    /// Tells the terminal, the pages and the brokers of an event.
    fn note(&mut self, at: Nanos, told: &Told) {
        if let Some(text) = told.text(&self.names) {
            talk!("{} {text}", self.time());
        }
        if let Some(stage) = &mut self.stage {
            stage.note(at, told);
        }
        if let Some(post) = &self.post {
            post.send(told.event(&self.names));
        }
        match told {
            Told::Missed(more) => self.missed.0 = self.missed.0.saturating_add(*more),
            _ => self.logged(at, told),
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

    fn tell_pace(&self) {
        if self.paces.scans() > 0 {
            talk!("scans were late: {}", self.paces.late());
            talk!("scans took: {}", self.paces.took());
        }
    }

    fn status(&self, controller: &Controller) {
        let state = controller.runner().state();
        let situation = self.names.bench.situation(state).join(", ");
        let (scans, missed) = (state.scans(), controller.runner().missed());
        talk!("{scans} scans, {missed} left out; the situation is {{{situation}}}");
        self.tell_pace();
    }
}

/// Answers who asked; the terminal hears of refusals alone.
fn answer(by: Asker, done: Result<(), String>) {
    match (&by, &done) {
        (Asker::Line, Err(why)) => talk!("{why}"),
        (Asker::Line, Ok(())) => {}
        (Asker::Page(..), _) => by.answer(done.map(|()| Json::Null)),
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

/// How the program ends: with an error where the scan panicked and left no controller.
fn verdict(controller: Option<&Controller>, mode: Mode) -> Result<Verdict, Failure> {
    match (controller, mode) {
        (None, _) => Err(Failure::Usage(say!("the scan ended by an error of G7; outputs are safe"))),
        (Some(_), Mode::Fault(_)) => Ok(Verdict::Found),
        (Some(_), _) => Ok(Verdict::Fine),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scan_that_panicked_is_an_error_of_the_program_in_every_mode() {
        for mode in [Mode::Run, Mode::Stop, Mode::Fault(g7_online::Reason::Watchdog)] {
            let ended = verdict(None, mode);
            assert!(matches!(ended, Err(ref failure) if !failure.is_quiet()), "exit code 2: {ended:?}");
        }
    }
}
