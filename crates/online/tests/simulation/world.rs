//! A controller in simulated time: its scan, its driver, its saver and its watchdog take turns; the device and
//! the disk do what a test wants.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use g7_host::{Force, Value};
use g7_model::{FileId, Nanos};
use g7_online::setup::{self, Changed};
use g7_online::{
    Absent, Chart, Command, Device, Driver, Event, Failed, Machine, Mode, Picture, Raw, Saver, Started, What,
    Wired, Wiring, Worked, assemble, open, prepare, runner, wire,
};
use g7_rig::{Bench, Options, Source, build};

use crate::common::{Chance, Simulated as Disk, panics};

pub(crate) const MS: Nanos = Nanos::MILLISECOND;

/// The valve follows the button; the number of presses goes out as well.
pub(crate) const CHART: &str = "\
profile iec60848
input go : BOOL
input level : INT
input online : BOOL
output valve : BOOL safe FALSE
output lamp : BOOL safe TRUE
output count : INT safe -1
var presses : INT := 0 retain
chart Main {
  initial step 1 { N lamp }
  step 2 { N valve  P1 presses := presses + 1  P1 count := presses + 1 }
  1 -> 2 when go and level < 100
  2 -> 1 when not go
}
";

pub(crate) const IO: &str = "\
[devices.line1]
kind = 'modbus-tcp'
host = 'simulated'
poll = '20ms'
timeout = '200ms'
retry = '1s'
[inputs]
go = { at = 'line1.discrete(0)', bad = false }
level = 'line1.input(0)'
online = 'line1.good()'
[outputs]
valve = 'line1.coil(0)'
lamp = 'line1.coil(1)'
count = 'line1.holding(0)'
";

/// The time between two saves, and between two looks of the watchdog.
const PAUSE: Nanos = Nanos::from_millis(20);

/// How the device behaves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Fault {
    #[default]
    None,
    /// It refuses connections.
    Gone,
    /// It is reached but does not answer.
    Silent,
    /// It refuses to give its first input.
    NoButton,
    /// It gives what no variable can hold.
    Nonsense,
    /// It answers just within its time-out.
    Slow,
    /// It refuses all outputs.
    Stubborn,
    /// The library behind it has an error.
    Panics,
}

/// The device as the world sees it.
#[derive(Debug, Default)]
pub(crate) struct World {
    pub(crate) go: bool,
    pub(crate) level: i128,
    pub(crate) fault: Fault,
    /// The values that were written to it last.
    pub(crate) outputs: Vec<Raw>,
    /// How long the latest call took.
    took: Nanos,
}

#[derive(Clone, Default)]
struct Shared(Arc<Mutex<World>>);

impl Shared {
    fn world(&self) -> MutexGuard<'_, World> {
        // A device that panics is wanted.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Device for Shared {
    fn connect(&mut self) -> Result<(), Failed> {
        let mut world = self.world();
        world.took = if world.fault == Fault::Silent { MS * 200 } else { MS };
        match world.fault {
            Fault::Gone | Fault::Silent => Err(Failed("not there".to_owned())),
            _ => Ok(()),
        }
    }

    fn exchange(
        &mut self,
        outputs: &[Raw],
        write: &[bool],
        inputs: &mut [Result<Raw, Absent>],
        refused: &mut [Option<String>],
    ) -> Result<(), Failed> {
        let mut world = self.world();
        let fault = world.fault;
        world.took = match fault {
            Fault::Silent => MS * 200,
            Fault::Slow => MS * 190,
            Fault::Gone | Fault::Panics => MS,
            Fault::None | Fault::NoButton | Fault::Nonsense | Fault::Stubborn => MS * 2,
        };
        match fault {
            Fault::Silent => return Err(Failed("no answer".to_owned())),
            Fault::Gone => return Err(Failed("reset".to_owned())),
            Fault::Panics => panics(),
            Fault::Stubborn => refused.fill(Some("exception 4".to_owned())),
            _ => {
                world.outputs.resize(outputs.len(), Raw::Whole(-99));
                let written = world.outputs.iter_mut().zip(outputs).zip(write).filter(|(_, write)| **write);
                written.for_each(|((to, from), _)| *to = *from);
            }
        }
        inputs[0] = match fault {
            Fault::NoButton => Err(Absent::Refused("exception 2".to_owned())),
            Fault::Nonsense => Ok(Raw::Real(f64::NAN)),
            _ => Ok(Raw::Bit(world.go)),
        };
        inputs[1] = Ok(if fault == Fault::Nonsense { Raw::Whole(1 << 90) } else { Raw::Whole(world.level) });
        Ok(())
    }

    fn close(&mut self) {}
}

/// A chart with its wires.
struct Program {
    source: Source,
    bench: Bench,
    wiring: Wiring,
}

impl Program {
    /// Compiled once for each text: courses take two charts again and again.
    fn new(chart: &str, io: &str) -> Rc<Program> {
        thread_local!(static COMPILED: RefCell<HashMap<String, Rc<Program>>> = RefCell::default());
        let known = |known: &RefCell<HashMap<_, _>>| {
            let mut known = known.borrow_mut();
            Rc::clone(
                known.entry(format!("{chart}{io}")).or_insert_with(|| Rc::new(Program::compile(chart, io))),
            )
        };
        COMPILED.with(known)
    }

    fn compile(chart: &str, io: &str) -> Program {
        let source = Source::new("chart.g7", chart.as_bytes().to_vec(), 0);
        let (bench, problems) = build(&source, &Options::default()).expect("no plant is asked for");
        let bench = bench.unwrap_or_else(|| panic!("{problems:?}"));
        let (setup, problems) = setup::read(io, FileId(1));
        let (wiring, wrong) = wire(&bench, &setup);
        assert!(problems.is_empty() && wrong.is_empty(), "{problems:?} {wrong:?}");
        Program { source, bench, wiring }
    }

    fn chart(&self) -> Chart<'_> {
        Chart { bench: &self.bench, document: &self.source.document, wiring: &self.wiring }
    }

    fn assemble(&self, runner: g7_host::Runner, device: &Shared) -> Machine {
        let device = |_: &Wired| Ok::<_, ()>(Box::new(device.clone()) as Box<dyn Device>);
        assemble(runner, &self.wiring, device).expect("a device")
    }
}

/// A machine in simulated time.
pub(crate) struct Simulation {
    pub(crate) now: Nanos,
    pub(crate) machine: Machine,
    program: Rc<Program>,
    /// The order that the driver is carrying out, and when it ends.
    pub(crate) busy: Option<(Nanos, Worked)>,
    device: Shared,
    pub(crate) modes: Vec<(Nanos, Mode)>,
    pub(crate) missed: u64,
    /// The system gives the scan no time until then.
    held: Nanos,
    watchdog: Option<Nanos>,
    /// The one who saves values, on this disk, and the instant of its next turn.
    saver: Option<(Saver<Disk>, Nanos)>,
    pub(crate) disk: Disk,
    /// How often saving began to fail.
    pub(crate) unsaved: u64,
}

impl Simulation {
    pub(crate) fn new(chart: &str, io: &str) -> Simulation {
        let (program, device) = (Program::new(chart, io), Shared::default());
        let machine = program.assemble(runner(&program.bench, &program.wiring, 0), &device);
        Simulation {
            now: MS,
            machine,
            program,
            busy: None,
            device,
            modes: Vec::new(),
            missed: 0,
            held: Nanos::ZERO,
            watchdog: None,
            saver: None,
            disk: Disk::default(),
            unsaved: 0,
        }
    }

    /// From here on a step that takes longer is a fault.
    pub(crate) fn guard(&mut self, watchdog: Nanos) {
        self.machine.controller.guard(watchdog);
        self.watchdog = Some(watchdog);
    }

    /// Starts the program anew with the values on its disk; says how it starts.
    pub(crate) fn start(&mut self) -> Started {
        let Program { bench, wiring, .. } = &*self.program;
        let begun = open(|| self.disk.clone(), bench, runner(bench, wiring, 0), Changed::Fit);
        let (slots, runner, started) = begun.expect("a slot is whole");
        self.machine = self.program.assemble(runner, &self.device);
        let kept = self.machine.keep(bench, slots);
        self.saver = Some((Saver::new(kept), self.now));
        self.busy = None;
        if let Some(watchdog) = self.watchdog {
            self.guard(watchdog);
        }
        started
    }

    /// Loses power and starts anew.
    pub(crate) fn lose_power(&mut self, chance: &mut Chance) -> Started {
        self.disk.plates().fail(chance);
        self.start()
    }

    pub(crate) fn driver(&mut self) -> &mut Driver {
        &mut self.machine.drivers[0]
    }

    /// Lets time pass until an instant.
    pub(crate) fn until(&mut self, end: Nanos) {
        loop {
            let scan = self.machine.controller.due().max(self.held);
            let device = self.busy.as_ref().map_or_else(|| self.machine.drivers[0].due(), |(at, _)| *at);
            let saver = self.saver.as_ref().map_or(Nanos::MAX, |(_, due)| *due);
            let next = scan.min(device).min(saver).max(self.now);
            if next > end {
                self.now = end;
                return;
            }
            self.now = next;
            self.watch();
            if device <= scan && device <= saver {
                self.device();
            } else if scan <= saver {
                self.machine.controller.step(next);
                self.take_events();
            } else if let Some((saver, due)) = &mut self.saver {
                self.unsaved += u64::from(saver.save().is_err());
                *due = next + PAUSE;
            }
        }
    }

    /// The watchdog, as its thread works.
    fn watch(&mut self) {
        let shared = &self.machine.shared;
        let silent = self.now - Nanos::new(shared.beat.load(Ordering::Acquire));
        let safe = shared.safe.load(Ordering::Acquire);
        if self.watchdog.is_some_and(|most| silent > most + PAUSE) && !safe {
            shared.tripped.store(true, Ordering::Release);
            shared.safe.store(true, Ordering::Release);
        }
    }

    pub(crate) fn device(&mut self) {
        let now = self.now;
        match self.busy.take() {
            Some((_, worked)) => self.driver().settle(now, worked, &mut |_| {}),
            None => {
                let worked = self.driver().work(now, &mut |_| {});
                let took = self.device.world().took;
                self.busy = Some((now + took, worked));
            }
        }
    }

    pub(crate) fn take_events(&mut self) {
        while let Ok(Event { at, what }) = self.machine.events.pop() {
            match what {
                What::Mode(mode) => self.modes.push((at, mode)),
                What::Missed(n) => self.missed += n,
                What::Forced(_) | What::Released(_) | What::Ended(_) | What::Changed => {}
            }
        }
    }

    pub(crate) fn command(&mut self, command: Command) {
        // A refused command changes nothing, which the tests see in the mode.
        self.machine.controller.command(self.now, command).ok();
        self.take_events();
    }

    /// Goes on with a changed chart, if the scan lets it: between picture and change it may do something.
    pub(crate) fn change(&mut self, chart: &str, io: &str, between: Nanos) {
        let new = Program::new(chart, io);
        let mut picture = Box::new(Picture::of(self.machine.controller.runner()));
        self.machine.controller.look(&mut picture);
        let mut prepared =
            prepare(self.program.chart(), new.chart(), &picture).expect("the wires are the same");
        self.pass(between);
        if !self.machine.controller.change(self.now, &mut prepared.successor) {
            return;
        }
        if let Some((saver, _)) = &mut self.saver {
            saver.renew(prepared.kept);
        }
        self.program = new;
        self.take_events();
    }

    pub(crate) fn pass(&mut self, time: Nanos) {
        self.until(self.now + time);
    }

    /// The system gives the scan no time for so long, while all other threads go on.
    pub(crate) fn hold_scan(&mut self, time: Nanos) {
        self.held = self.now + time;
        self.pass(time);
    }

    pub(crate) fn set(&self, change: impl FnOnce(&mut World)) {
        change(&mut self.device.world());
    }

    /// Valve, lamp and count of the device.
    pub(crate) fn outputs(&self) -> Vec<Raw> {
        self.device.world().outputs.clone()
    }

    pub(crate) fn go(&self) -> bool {
        self.device.world().go
    }

    /// The number of scans of the charts.
    pub(crate) fn scans(&self) -> u64 {
        self.machine.controller.runner().state().scans()
    }

    pub(crate) fn force_of(&self, name: &str) -> Force {
        let bench = &self.program.bench;
        bench.item(name).and_then(|item| bench.force_of(item)).expect("one word")
    }

    /// The number of presses: of the run, and as it is safe on the disk.
    pub(crate) fn presses(&self) -> (u64, u64) {
        let Program { bench, wiring, .. } = &*self.program;
        let of = |runner: &g7_host::Runner| {
            let item = bench.item("presses").expect("it is declared");
            let Value::Word(word) = bench.value(runner, item) else { panic!("a number") };
            word
        };
        let copy = self.disk.copy();
        let saved = open(|| copy.clone(), bench, runner(bench, wiring, 0), Changed::Fit);
        let (_, saved, _) = saved.expect("a slot is whole");
        (of(self.machine.controller.runner()), of(&saved))
    }
}
