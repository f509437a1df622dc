//! The controller: one step of it reads the inputs, scans and hands on the outputs.
//!
//! A step is called at [`Controller::due`] by the scan thread, or by a simulator. It takes the time
//! as a number, and neither allocates nor waits.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicI64, Ordering};

use g7_engine::Addr;
use g7_host::{Force, Halt, Runner, Start};
use g7_model::Nanos;

use crate::driver::{Quality, Said, from_device};
use crate::exchange::{Reader, Writer};
use crate::forces::{FORCES, Forced, Forces, LONGEST};
use crate::keep::Keep;
use crate::notes::{Noting, Pen};
use crate::parts::{Handles, Keeping, Picture, Successor};
use crate::sight::{Facts, Showing, Sight, sight};
use crate::wire::Worth;
use crate::wired::WhileBad;
use crate::word::Target;

/// The state of a controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// It makes no scans; the outputs are safe.
    Stop,
    /// It makes scans.
    Run,
    /// It makes no scans until a person acknowledges the reason; the outputs are safe.
    Fault(Reason),
}

/// Why a controller is in [`Mode::Fault`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// The charts or the plant had a fault.
    Halt(Halt),
    /// An input is bad, and its channel says that the controller stops then.
    Input(Target),
    /// A scan took longer than the watchdog allows.
    Watchdog,
}

/// A request of a person or of another thread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Make scans.
    Run,
    /// Make no more scans.
    Stop,
    /// End a fault; the controller is stopped then.
    Acknowledge,
    /// Force a variable to a value, for so long.
    Force(Force, u64, Nanos),
    /// Take a force back.
    Release(Force),
    /// Take all forces back.
    ReleaseAll,
    /// Go back to the initial situation; it does what it did before.
    Restart(Start),
    /// Give an input that no device has a value.
    SetInput(u32, u64),
    /// Give a variable a value.
    SetWord(Addr, u64),
    /// Give a state of the plant a value.
    SetPlant(Addr, u64),
}

/// Why a command is not carried out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refused {
    /// It runs already.
    #[error("the controller runs already")]
    Runs,
    /// It does not run.
    #[error("the controller does not run")]
    Rests,
    /// A person has to end the fault first.
    #[error("there is a fault: acknowledge it first")]
    Fault,
    /// There is no fault.
    #[error("there is no fault to acknowledge")]
    NoFault,
    /// There are as many forces as there may be.
    #[error("{FORCES} values are forced already: take one back")]
    Full,
    /// The time of a force is none, or longer than a day.
    #[error("a force lasts longer than 0 and at most {} hours", LONGEST.count() / Nanos::HOUR.count())]
    Time,
    /// Nothing of that kind is forced.
    #[error("it is not forced")]
    Free,
}

/// Something that happened in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    /// The time of the controller.
    pub at: Nanos,
    /// The event itself.
    pub what: What,
}

/// The kinds of events of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum What {
    /// The mode is another one.
    Mode(Mode),
    /// So many scans came too late and were left out.
    Missed(u64),
    /// A value is forced.
    Forced(Forced),
    /// A force was taken back.
    Released(Force),
    /// The time of a force is over.
    Ended(Force),
    /// From here on it runs another chart.
    Changed,
}

/// Flags that the controller shares with its drivers and its watchdog.
#[derive(Clone, Debug, Default)]
pub struct Shared {
    /// True while drivers write safe outputs, whatever the scan says.
    pub safe: Arc<AtomicBool>,
    /// The end of the latest step, in nanoseconds of the controller's clock.
    pub beat: Arc<AtomicI64>,
    /// True where the watchdog has found that a step took too long.
    pub tripped: Arc<AtomicBool>,
}

/// The controller's side of a device.
#[derive(Debug)]
pub struct Port {
    /// The words that the driver gives.
    pub from_device: Reader,
    /// The words that the driver takes: one for each output.
    pub to_device: Writer,
    /// The words of the run.
    pub handles: Handles,
    /// Values older than this are bad, even if the driver says nothing.
    pub stale: Nanos,
}

/// A port with the words that it took last.
#[derive(Debug)]
struct Open {
    port: Port,
    words: Vec<u64>,
    /// The words for the outputs.
    out: Vec<u64>,
}

/// The time between two hand-overs of the values that are kept.
const KEPT_EACH: Nanos = Nanos::from_millis(100);

/// A controller.
pub struct Controller {
    runner: Runner,
    ports: Vec<Open>,
    shared: Shared,
    mode: Mode,
    /// The controller's time at which the run's clock shows 0. While it is stopped the run's clock
    /// stands still.
    base: Nanos,
    due: Nanos,
    /// True after the first scan of this controller.
    begun: bool,
    /// Until this instant a run waits for the first values of the devices.
    grace: Nanos,
    missed: u64,
    events: rtrb::Producer<Event>,
    lost: u64,
    keeping: Option<Keeping>,
    forces: Forces,
    showing: Option<Showing>,
    /// The pen, and what it notes.
    noting: Option<(Pen, Noting)>,
    /// Counts whatever changes the run.
    revision: u64,
    /// The longest time between the ends of two steps.
    watchdog: Nanos,
}

impl Controller {
    /// A controller that is stopped.
    ///
    /// `grace` is the longest time that the first scan waits for values of all devices.
    pub fn new(
        mut runner: Runner,
        ports: Vec<Port>,
        shared: Shared,
        grace: Nanos,
        events: rtrb::Producer<Event>,
    ) -> Controller {
        let open = |port: Port| Open {
            words: vec![0; from_device::words(port.handles.inputs.len())],
            out: port.handles.outputs.iter().map(|(_, safe)| safe.unwrap_or(0)).collect(),
            port,
        };
        shared.safe.store(true, Ordering::Release);
        Controller {
            forces: Forces::new(&mut runner),
            showing: None,
            noting: None,
            runner,
            ports: ports.into_iter().map(open).collect(),
            shared,
            mode: Mode::Stop,
            base: Nanos::ZERO,
            due: Nanos::ZERO,
            begun: false,
            grace,
            missed: 0,
            events,
            lost: 0,
            keeping: None,
            revision: 0,
            watchdog: Nanos::new(i64::MAX),
        }
    }

    /// From here on a step that comes later than this after the one before is a fault. A thread of its own
    /// sees a step that does not end (`runtime.rs`); this sees a program that stood still as a whole.
    pub fn guard(&mut self, watchdog: Nanos) {
        self.watchdog = watchdog;
    }

    /// From here on hands the values that outlive the program on, each 100 ms.
    pub(crate) fn keep_by(&mut self, keep: Keep, to_disk: Writer) {
        self.keeping = Some(Keeping::new(keep, to_disk));
    }

    /// From here on notes each change of the signals.
    pub(crate) fn note_by(&mut self, pen: Pen, noting: Noting) {
        self.noting = Some((pen, noting));
    }

    /// From here on shows itself.
    pub(crate) fn show(&mut self) -> Sight {
        let ports = self.ports.iter().map(|open| (open.port.handles.inputs.len(), open.port.stale));
        let (showing, seen) = sight(&self.runner, ports);
        self.showing = Some(showing);
        seen
    }

    /// The values that outlive the program, as they are now; empty where none are kept.
    pub fn kept(&mut self) -> &[u64] {
        match &mut self.keeping {
            Some(keeping) => {
                self.runner.without_forced_outputs(|runner| keeping.keep.take(runner).len());
                keeping.keep.words()
            }
            None => &[],
        }
    }

    /// The instant of the next step.
    pub fn due(&self) -> Nanos {
        self.due
    }

    /// Its state.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// The run.
    pub fn runner(&self) -> &Runner {
        &self.runner
    }

    /// The scans that came too late and were left out.
    pub fn missed(&self) -> u64 {
        self.missed
    }

    /// Takes a picture, between two steps. Allocates nothing.
    pub fn look(&self, picture: &mut Picture) {
        // A picture of another chart is told by its number: no controller has seen so many changes.
        let same = picture.runner.copy_from(&self.runner).is_ok();
        picture.revision = if same { self.revision } else { u64::MAX };
        picture.forces.clear();
        picture.forces.extend_from_slice(self.forces.all());
    }

    /// Goes on with another chart at `now`, between two steps, unless something has changed since the
    /// picture from which it was prepared: false then. The parts of the chart before are in `successor`
    /// behind it. Allocates and frees nothing.
    pub fn change(&mut self, now: Nanos, successor: &mut Successor) -> bool {
        use std::mem::swap;
        if successor.revision != self.revision || successor.handles.len() != self.ports.len() {
            return false;
        }
        swap(&mut self.runner, &mut successor.runner);
        self.forces.swap(&mut successor.forces);
        for (open, handles) in self.ports.iter_mut().zip(&mut successor.handles) {
            swap(&mut open.port.handles, handles);
        }
        if self.keeping.is_some() {
            swap(&mut self.keeping, &mut successor.keeping);
        }
        if self.showing.is_some() {
            swap(&mut self.showing, &mut successor.showing);
        }
        if let (Some((pen, noting)), Some(other)) = (&mut self.noting, &mut successor.noting) {
            swap(noting, other);
            pen.begin();
        }
        self.revision += 1;
        self.tell(now, What::Changed);
        true
    }

    /// The number of events that nobody took in time.
    pub fn lost(&self) -> u64 {
        self.lost
    }

    /// Carries out a command at `now`, between two steps.
    ///
    /// # Errors
    ///
    /// It cannot be carried out; nothing has changed.
    pub fn command(&mut self, now: Nanos, command: Command) -> Result<(), Refused> {
        self.revision += 1;
        match (command, self.mode) {
            (Command::Run, Mode::Stop) => {
                // The grid of scans begins anew here.
                self.base = now - self.runner.due();
                self.due = now;
                self.shared.tripped.store(false, Ordering::Release);
                self.shared.beat.store(now.count(), Ordering::Release);
                self.shared.safe.store(false, Ordering::Release);
                self.enter(now, Mode::Run);
            }
            (Command::Run, Mode::Run) => return Err(Refused::Runs),
            (Command::Run, Mode::Fault(_)) => return Err(Refused::Fault),
            (Command::Stop, Mode::Run) => self.leave(now, Mode::Stop),
            (Command::Stop, Mode::Stop | Mode::Fault(_)) => return Err(Refused::Rests),
            (Command::Acknowledge, Mode::Fault(_)) => self.enter(now, Mode::Stop),
            (Command::Acknowledge, Mode::Run | Mode::Stop) => return Err(Refused::NoFault),
            (Command::Restart(start), _) => self.runner.restart(start),
            (Command::SetInput(index, word), _) => self.runner.set_input(index, word),
            (Command::SetWord(addr, word), _) => self.runner.set_word(addr, word),
            (Command::SetPlant(addr, word), _) => self.runner.set_plant_word(addr, word),
            (Command::Force(what, word, lasts), _) => return self.force(now, what, word, lasts),
            (Command::Release(what), _) if self.forces.release(&mut self.runner, what) => {
                self.tell(now, What::Released(what));
            }
            (Command::Release(_), _) => return Err(Refused::Free),
            (Command::ReleaseAll, _) if self.forces.all().is_empty() => return Err(Refused::Free),
            (Command::ReleaseAll, _) => {
                while let Some(what) = self.forces.pop(&mut self.runner) {
                    self.tell(now, What::Released(what));
                }
            }
        }
        Ok(())
    }

    fn force(&mut self, now: Nanos, what: Force, word: u64, lasts: Nanos) -> Result<(), Refused> {
        if lasts <= Nanos::ZERO || lasts > LONGEST {
            return Err(Refused::Time);
        }
        let force = Forced { what, word, until: now + lasts };
        if !self.forces.force(&mut self.runner, force) {
            return Err(Refused::Full);
        }
        self.tell(now, What::Forced(force));
        Ok(())
    }

    /// Makes the step that is due.
    pub fn step(&mut self, now: Nanos) {
        let silent = now - Nanos::new(self.shared.beat.load(Ordering::Acquire));
        let tripped = silent > self.watchdog || self.shared.tripped.load(Ordering::Acquire);
        if self.mode == Mode::Run && tripped {
            self.leave(now, Mode::Fault(Reason::Watchdog));
        }
        for open in &mut self.ports {
            open.port.from_device.take(&mut open.words);
        }
        while let Some(what) = self.forces.end_one(&mut self.runner, now) {
            self.revision += 1;
            self.tell(now, What::Ended(what));
        }
        // Also while it does not run, so that who starts it sees the inputs as they are.
        let fatal = self.read(now);
        if self.mode == Mode::Run && self.has_values(now) {
            match fatal {
                Some(input) => self.leave(now, Mode::Fault(Reason::Input(input))),
                None => self.scan(now),
            }
        }
        self.write(now);
        self.keep(now);
        self.note(now);
        self.put_in_sight(now);
        self.shared.beat.store(now.count(), Ordering::Release);
        let period = self.runner.period();
        self.due = match self.mode {
            Mode::Run if self.begun => self.base + self.runner.due(),
            Mode::Run | Mode::Stop | Mode::Fault(_) => self.due.max(now - period) + period,
        };
    }

    /// True as soon as each driver has told of its device, or the time of grace is over.
    fn has_values(&mut self, now: Nanos) -> bool {
        let told = |open: &Open| open.words.first().is_some_and(|stamp| *stamp != 0);
        if self.begun || now >= self.grace || self.ports.iter().all(told) {
            return true;
        }
        // The run begins with its first scan.
        self.base = now + self.runner.period() - self.runner.due();
        false
    }

    /// Hands the values of the devices to the run. Returns an input whose value is bad and may not be.
    fn read(&mut self, now: Nanos) -> Option<Target> {
        let mut fatal = None;
        for Open { port, words, .. } in &self.ports {
            let said = Said::new(words, now, port.stale);
            for (k, (target, bad)) in port.handles.inputs.iter().enumerate() {
                let (word, quality) = said.input(k);
                let value = match bad {
                    _ if quality == Quality::Good => word,
                    WhileBad::Word(substitute) => *substitute,
                    WhileBad::Hold => continue,
                    WhileBad::Fault => {
                        fatal = fatal.or(Some(*target));
                        continue;
                    }
                };
                match target {
                    Target::Input(index) => self.runner.set_input(*index, value),
                    Target::Word(addr) => self.runner.set_word(*addr, value),
                }
            }
            for index in &port.handles.good {
                self.runner.set_input(*index, u64::from(said.is_up()));
            }
        }
        fatal
    }

    fn scan(&mut self, now: Nanos) {
        self.revision += 1;
        self.begun = true;
        let before = self.runner.missed();
        self.runner.catch_up(now - self.base);
        if self.runner.missed() > before {
            self.missed += self.runner.missed() - before;
            self.tell(now, What::Missed(self.runner.missed() - before));
        }
        if let Err(halt) = self.runner.scan() {
            self.leave(now, Mode::Fault(Reason::Halt(halt)));
        }
    }

    /// Hands the outputs to the drivers: those of the run, or the safe ones.
    fn write(&mut self, now: Nanos) {
        let running = self.drives();
        for k in 0..self.ports.len() {
            // Aside, because what is shown of an input is with the port of its device.
            let Some(mut out) = self.ports.get_mut(k).map(|open| std::mem::take(&mut open.out)) else {
                return;
            };
            let outputs = self.ports.get(k).map_or(&[][..], |open| &open.port.handles.outputs);
            for (word, (source, safe)) in out.iter_mut().zip(outputs) {
                *word = match safe {
                    Some(safe) if !running => *safe,
                    Some(_) | None => {
                        let worth = |device, input| self.worth(device, input, now);
                        source.word(&self.runner, self.runner.state(), worth)
                    }
                };
            }
            let Some(open) = self.ports.get_mut(k) else { return };
            open.port.to_device.put(out.iter().copied());
            open.out = out;
        }
    }

    /// How good an input is, by the numbers of its device and of itself.
    fn worth(&self, device: usize, input: usize, now: Nanos) -> Worth {
        let Some(Open { port, words, .. }) = self.ports.get(device) else { return Worth::None };
        let (_, quality) = Said::new(words, now, port.stale).input(input);
        match (quality, port.handles.inputs.get(input)) {
            (Quality::Good, _) => Worth::Good,
            (_, Some((_, WhileBad::Word(_)))) => Worth::Substitute,
            (Quality::Unread, _) => Worth::Unread,
            (Quality::Bad, Some((_, WhileBad::Hold))) => Worth::Last,
            (Quality::Bad, Some((_, WhileBad::Fault)) | None) => Worth::None,
        }
    }

    fn keep(&mut self, now: Nanos) {
        if let Some(Keeping { keep, to_disk, due }) = &mut self.keeping
            && now >= *due
            && self.begun
        {
            self.runner.without_forced_outputs(|runner| to_disk.put(keep.take(runner).iter().copied()));
            *due = now + KEPT_EACH;
        }
    }

    /// True while the charts give the outputs.
    fn drives(&self) -> bool {
        self.mode == Mode::Run && self.begun
    }

    fn note(&mut self, now: Nanos) {
        let drives = self.drives();
        if let Some((pen, noting)) = &mut self.noting {
            pen.note(now, drives, &self.runner, noting);
        }
    }

    fn put_in_sight(&mut self, now: Nanos) {
        let drives = self.drives();
        if let Some(showing) = &mut self.showing {
            let (missed, lost, forces) = (self.missed, self.lost, self.forces.all());
            let facts = Facts { now, drives, missed, lost, forces };
            showing.put(facts, &self.runner, self.ports.iter().map(|open| &*open.words));
        }
    }

    /// Ends the scans: outputs are safe from here on.
    fn leave(&mut self, now: Nanos, mode: Mode) {
        self.shared.safe.store(true, Ordering::Release);
        self.enter(now, mode);
    }

    fn enter(&mut self, now: Nanos, mode: Mode) {
        self.mode = mode;
        self.tell(now, What::Mode(mode));
    }

    fn tell(&mut self, at: Nanos, what: What) {
        if self.events.push(Event { at, what }).is_err() {
            self.lost += 1;
        }
    }
}
