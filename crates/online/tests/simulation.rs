//! The controller and its drivers in simulated time, with devices that fail: each seed gives another
//! course of faults, and the same one each time.

use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};

use g7_model::{FileId, Nanos};
use g7_online::setup;
use g7_online::{
    Absent, Command, Device, Driver, Event, Failed, Machine, Mode, Raw, Reason, Target, What, Wired, Worked,
    assemble, runner, wire,
};
use g7_rig::{Bench, Options, Source, build};

const MS: Nanos = Nanos::MILLISECOND;

/// The valve follows the button; the number of presses goes out as well.
const CHART: &str = "\
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

const IO: &str = "\
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

fn bench(chart: &str) -> Bench {
    let source = Source::new("chart.g7", chart.as_bytes().to_vec(), 0);
    let (bench, problems) = build(&source, &Options::default()).expect("no plant is asked for");
    bench.unwrap_or_else(|| panic!("{problems:?}"))
}

/// A small generator (splitmix64).
struct Chance(u64);

impl Chance {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)) % n
    }
}

/// How the device behaves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Fault {
    #[default]
    None,
    /// It refuses connections.
    Gone,
    /// It is reached but does not answer.
    Silent,
    /// It refuses to give its first input.
    NoButton,
}

/// The device as the world sees it.
#[derive(Debug, Default)]
struct World {
    go: bool,
    level: i128,
    fault: Fault,
    /// The values that were written to it last.
    outputs: Vec<Raw>,
    /// How long the latest call took.
    took: Nanos,
}

struct Simulated(Arc<Mutex<World>>);

impl Device for Simulated {
    fn connect(&mut self) -> Result<(), Failed> {
        let mut world = self.0.lock().expect("one thread");
        world.took = if world.fault == Fault::Silent { MS * 200 } else { MS };
        match world.fault {
            Fault::None | Fault::NoButton => Ok(()),
            Fault::Gone | Fault::Silent => Err(Failed("not there".to_owned())),
        }
    }

    fn exchange(
        &mut self,
        outputs: &[Raw],
        write: &[bool],
        inputs: &mut [Result<Raw, Absent>],
        _refused: &mut [Option<String>],
    ) -> Result<(), Failed> {
        let mut world = self.0.lock().expect("one thread");
        match world.fault {
            Fault::Silent => {
                world.took = MS * 200;
                return Err(Failed("no answer".to_owned()));
            }
            Fault::Gone => {
                world.took = MS;
                return Err(Failed("reset".to_owned()));
            }
            Fault::None | Fault::NoButton => world.took = MS * 2,
        }
        world.outputs.resize(outputs.len(), Raw::Whole(-99));
        for ((to, from), write) in world.outputs.iter_mut().zip(outputs).zip(write) {
            if *write {
                *to = *from;
            }
        }
        let button = Raw::Bit(world.go);
        let no_button = world.fault == Fault::NoButton;
        inputs[0] = if no_button { Err(Absent::Refused("exception 2".to_owned())) } else { Ok(button) };
        inputs[1] = Ok(Raw::Whole(world.level));
        Ok(())
    }

    fn close(&mut self) {}
}

/// A machine in simulated time.
struct Simulation {
    now: Nanos,
    machine: Machine,
    /// The order that the driver is carrying out, and when it ends.
    busy: Option<(Nanos, Worked)>,
    world: Arc<Mutex<World>>,
    modes: Vec<(Nanos, Mode)>,
    missed: u64,
}

impl Simulation {
    fn new(chart: &str, io: &str) -> Simulation {
        let bench = bench(chart);
        let (setup, problems) = setup::read(io, FileId(1));
        assert!(problems.is_empty(), "{problems:?}");
        let (wiring, problems) = wire(&bench, &setup);
        assert!(problems.is_empty(), "{problems:?}");
        let world = Arc::new(Mutex::new(World::default()));
        let device = |_: &Wired| Ok::<_, ()>(Box::new(Simulated(Arc::clone(&world))) as Box<dyn Device>);
        let machine = assemble(runner(&bench, &wiring, 0), &wiring, device).expect("a device");
        Simulation { now: MS, machine, busy: None, world, modes: Vec::new(), missed: 0 }
    }

    fn driver(&mut self) -> &mut Driver {
        &mut self.machine.drivers[0]
    }

    /// Lets time pass until an instant.
    fn until(&mut self, end: Nanos) {
        loop {
            let scan = self.machine.controller.due();
            let device = self.busy.as_ref().map_or_else(|| self.machine.drivers[0].due(), |(at, _)| *at);
            let next = scan.min(device).max(self.now);
            if next > end {
                self.now = end;
                return;
            }
            self.now = next;
            if device <= scan {
                self.device();
            } else {
                self.machine.controller.step(next);
                self.take_events();
            }
        }
    }

    fn device(&mut self) {
        let now = self.now;
        match self.busy.take() {
            Some((_, worked)) => self.driver().settle(now, worked, &mut |_| {}),
            None => {
                let worked = self.driver().work(now, &mut |_| {});
                let took = self.world.lock().expect("one thread").took;
                self.busy = Some((now + took, worked));
            }
        }
    }

    fn take_events(&mut self) {
        while let Ok(Event { at, what }) = self.machine.events.pop() {
            match what {
                What::Mode(mode) => self.modes.push((at, mode)),
                What::Missed(n) => self.missed += n,
                What::Forced(_) | What::Released(_) | What::Ended(_) | What::Changed => {}
            }
        }
    }

    fn command(&mut self, command: Command) {
        // A refused command changes nothing, which the tests see in the mode.
        self.machine.controller.command(self.now, command).ok();
        self.take_events();
    }

    fn pass(&mut self, time: Nanos) {
        self.until(self.now + time);
    }

    fn set(&self, change: impl FnOnce(&mut World)) {
        change(&mut self.world.lock().expect("one thread"));
    }

    /// Valve, lamp and count of the device.
    fn outputs(&self) -> Vec<Raw> {
        self.world.lock().expect("one thread").outputs.clone()
    }
}

fn wrote(valve: bool, lamp: bool, count: i128) -> Vec<Raw> {
    vec![Raw::Bit(valve), Raw::Bit(lamp), Raw::Whole(count)]
}

/// The safe values of the chart.
fn safe() -> Vec<Raw> {
    wrote(false, true, -1)
}

#[test]
fn a_controller_that_is_stopped_writes_safe_values() {
    let mut s = Simulation::new(CHART, IO);
    s.set(|w| w.go = true);
    s.pass(MS * 200);
    assert_eq!(s.outputs(), safe());
    assert_eq!(s.machine.controller.runner().state().scans(), 0);
}

#[test]
fn a_running_controller_drives_the_device_within_a_poll_and_a_scan() {
    let mut s = Simulation::new(CHART, IO);
    s.command(Command::Run);
    s.pass(MS * 200);
    assert_eq!(s.outputs(), wrote(false, true, 0));
    s.set(|w| w.go = true);
    // Read in the next poll, scanned, written in the poll after.
    s.pass(MS * (20 + 10 + 20 + 5));
    assert_eq!(s.outputs(), wrote(true, false, 1));
    s.command(Command::Stop);
    s.pass(MS * (10 + 20 + 5));
    assert_eq!(s.outputs(), safe());
    assert_eq!(s.modes.iter().map(|(_, m)| *m).collect::<Vec<_>>(), [Mode::Run, Mode::Stop]);
}

#[test]
fn time_stands_still_while_the_controller_is_stopped() {
    let timed = CHART.replace("when not go", "when 1s/X2");
    let mut s = Simulation::new(&timed, IO);
    s.command(Command::Run);
    s.set(|w| w.go = true);
    s.pass(MS * 500);
    s.command(Command::Stop);
    s.set(|w| w.go = false);
    s.pass(MS * 5_000);
    s.command(Command::Run);
    s.pass(MS * 100);
    assert_eq!(s.outputs(), wrote(true, false, 1), "the second has not passed");
    s.pass(MS * 500);
    assert_eq!(s.outputs()[0], Raw::Bit(false));
}

#[test]
fn an_input_takes_its_substitute_or_holds_while_the_device_is_silent() {
    let mut s = Simulation::new(CHART, IO);
    s.command(Command::Run);
    s.set(|w| (w.go, w.level) = (true, 42));
    s.pass(MS * 200);
    let word = |s: &Simulation, k: usize| s.machine.controller.runner().read()[k];
    assert_eq!([0, 1, 2].map(|k| word(&s, k)), [1, 42, 1]);
    s.set(|w| w.fault = Fault::Silent);
    // The poll, its time-out, a scan.
    s.pass(MS * (20 + 200 + 10 + 5));
    assert_eq!([0, 1, 2].map(|k| word(&s, k)), [0, 42, 0]);
    s.set(|w| w.fault = Fault::None);
    s.pass(MS * 1_500);
    assert_eq!([0, 1, 2].map(|k| word(&s, k)), [1, 42, 1]);
}

#[test]
fn a_substitute_stands_from_the_start_and_is_a_value_of_the_chart() {
    let io = IO.replace("bad = false", "bad = true").replace(
        "level = 'line1.input(0)'",
        "level = { at = 'line1.input(0)', scale = 10, offset = 3, bad = 42 }",
    );
    let mut s = Simulation::new(CHART, &io);
    s.set(|w| w.fault = Fault::Gone);
    s.command(Command::Run);
    s.pass(MS * 1_000);
    assert_eq!(s.machine.controller.runner().read(), [1, 42, 0]);
    s.set(|w| w.fault = Fault::None);
    s.pass(MS * 1_500);
    assert_eq!(s.machine.controller.runner().read(), [0, 3, 1]);
}

#[test]
fn values_of_a_driver_that_hangs_become_bad() {
    let mut s = Simulation::new(CHART, IO);
    s.set(|w| w.go = true);
    s.command(Command::Run);
    s.pass(MS * 200);
    assert_eq!(s.machine.controller.runner().read(), [1, 0, 1]);
    // The driver gets no time any more, though the device is well.
    let worked = s.driver().work(MS * 200, &mut |_| {});
    s.busy = Some((Nanos::HOUR, worked));
    s.pass(MS * 5_000);
    assert_eq!(s.machine.controller.runner().read(), [0, 0, 0]);
}

#[test]
fn a_device_that_forgets_its_outputs_gets_them_again() {
    let mut s = Simulation::new(CHART, IO);
    s.command(Command::Run);
    s.pass(MS * 200);
    s.set(|w| w.outputs = wrote(true, false, 77));
    s.pass(MS * 1_050);
    assert_eq!(s.outputs(), wrote(false, true, 0), "within the time of `refresh`, 1 s");
    // One that was gone gets them at once.
    s.set(|w| (w.fault, w.outputs) = (Fault::Gone, wrote(true, false, 77)));
    s.pass(MS * 50);
    s.set(|w| w.fault = Fault::None);
    s.pass(MS * 130);
    assert_eq!(s.outputs(), wrote(false, true, 0));
}

#[test]
fn an_input_that_the_device_refuses_is_bad_alone() {
    let mut s = Simulation::new(CHART, IO);
    s.command(Command::Run);
    s.set(|w| (w.go, w.level, w.fault) = (true, 7, Fault::NoButton));
    s.pass(MS * 200);
    let read = s.machine.controller.runner().read().to_vec();
    assert_eq!(read, [0, 7, 1]);
}

#[test]
fn a_bad_input_stops_the_controller_where_the_file_says_so() {
    let io = IO.replace("bad = false", "bad = 'fault'");
    let mut s = Simulation::new(CHART, &io);
    s.command(Command::Run);
    s.set(|w| w.go = true);
    s.pass(MS * 200);
    assert_eq!(s.outputs()[0], Raw::Bit(true));
    s.set(|w| w.fault = Fault::NoButton);
    s.pass(MS * 100);
    assert_eq!(s.machine.controller.mode(), Mode::Fault(Reason::Input(Target::Input(0))));
    assert_eq!(s.outputs(), safe());
    // The fault stays until someone acknowledges it, and then nothing runs by itself.
    s.set(|w| w.fault = Fault::None);
    s.command(Command::Run);
    s.pass(MS * 100);
    assert_eq!(s.machine.controller.mode(), Mode::Fault(Reason::Input(Target::Input(0))));
    s.command(Command::Acknowledge);
    s.pass(MS * 100);
    assert_eq!((s.machine.controller.mode(), s.outputs()), (Mode::Stop, safe()));
    s.command(Command::Run);
    s.pass(MS * 100);
    assert_eq!(s.outputs()[0], Raw::Bit(true));
}

#[test]
fn a_fault_of_the_chart_makes_outputs_safe() {
    let chart = CHART.replace("presses + 1", "presses + 10 / level");
    let mut s = Simulation::new(&chart, IO);
    s.command(Command::Run);
    s.pass(MS * 100);
    s.set(|w| w.go = true);
    s.pass(MS * 100);
    assert!(matches!(s.machine.controller.mode(), Mode::Fault(Reason::Halt(_))));
    assert_eq!(s.outputs(), safe());
}

#[test]
fn outputs_are_safe_while_the_watchdog_says_so_whatever_the_scan_gave() {
    let mut s = Simulation::new(CHART, IO);
    s.command(Command::Run);
    s.set(|w| w.go = true);
    s.pass(MS * 200);
    assert_eq!(s.outputs()[0], Raw::Bit(true));
    // The watchdog has tripped; no step follows, as in an endless loop.
    s.machine.shared.safe.store(true, Ordering::Release);
    s.machine.shared.tripped.store(true, Ordering::Release);
    for _ in 0..4 {
        s.now += MS * 10;
        s.device();
    }
    assert_eq!(s.outputs(), safe());
    s.pass(MS * 20);
    assert_eq!(s.machine.controller.mode(), Mode::Fault(Reason::Watchdog));
}

#[test]
fn a_program_that_stood_still_for_too_long_is_in_fault_before_its_next_scan() {
    let mut s = Simulation::new(CHART, IO);
    s.machine.controller.guard(MS * 100);
    s.set(|w| w.go = true);
    s.command(Command::Run);
    s.pass(MS * 300);
    assert_eq!(s.outputs(), wrote(true, false, 1));
    let scans = s.machine.controller.runner().state().scans();
    // No thread has worked meanwhile, the one of the watchdog neither.
    s.now += MS * 150;
    s.machine.controller.step(s.now);
    s.take_events();
    assert_eq!(s.modes.last().map(|(_, mode)| *mode), Some(Mode::Fault(Reason::Watchdog)));
    assert_eq!(s.machine.controller.runner().state().scans(), scans, "it makes no scan");
    s.pass(MS * 50);
    assert_eq!(s.outputs(), safe());
    // After a stop of any length it runs again.
    s.command(Command::Acknowledge);
    s.pass(MS * 500);
    s.command(Command::Run);
    s.pass(MS * 100);
    assert_eq!(s.outputs(), wrote(true, false, 1));
}

#[test]
fn the_first_scan_waits_for_the_devices_but_not_for_ever() {
    let mut s = Simulation::new(CHART, IO);
    s.set(|w| w.fault = Fault::Silent);
    s.command(Command::Run);
    s.pass(MS * 150);
    assert_eq!(s.machine.controller.runner().state().scans(), 0);
    s.pass(MS * 500);
    assert!(s.machine.controller.runner().state().scans() > 0);
    assert_eq!(s.missed, 0, "waiting is no lateness");
}

#[test]
fn scans_that_come_too_late_are_counted_and_left_out() {
    let mut s = Simulation::new(CHART, IO);
    s.command(Command::Run);
    s.pass(MS * 100);
    let before = s.machine.controller.runner().state().scans();
    // The system gives the scan no time for 55 ms.
    s.now += MS * 55;
    s.pass(MS * 45);
    let scans = s.machine.controller.runner().state().scans() - before;
    // Five were due meanwhile; the latest of them is made.
    assert_eq!((scans + s.missed, s.missed), (10, 4));
}

/// The seeds of this run: 200, as many as `G7_SEEDS` says, or `G7_SEED` alone, to look at one that failed.
fn seeds() -> std::ops::Range<u64> {
    let number = |name| std::env::var(name).ok().map(|n| n.parse().unwrap_or_else(|e| panic!("{name}: {e}")));
    match number("G7_SEED") {
        Some(seed) => seed..seed + 1,
        None => 0..number("G7_SEEDS").unwrap_or(200),
    }
}

/// Faults at random: the laws that hold in any course of them.
#[test]
fn outputs_follow_the_inputs_after_any_course_of_faults() {
    for seed in seeds() {
        let mut chance = Chance(seed);
        let mut s = Simulation::new(CHART, IO);
        s.command(Command::Run);
        for _ in 0..40 {
            match chance.below(8) {
                0..=2 => s.set(|w| w.go = !w.go),
                3 => s.set(|w| w.fault = Fault::Silent),
                4 => s.set(|w| w.fault = Fault::Gone),
                5 => s.set(|w| w.fault = Fault::None),
                6 => s.command(Command::Stop),
                _ => s.command(Command::Run),
            }
            s.pass(MS * (1 + chance.below(700) as i64));
        }
        // The device is well again and the controller runs: within 5 s all is as it should be.
        s.set(|w| w.fault = Fault::None);
        s.command(Command::Run);
        s.pass(MS * 5_000);
        let go = s.world.lock().expect("one thread").go;
        assert_eq!(s.outputs()[..2], [Raw::Bit(go), Raw::Bit(!go)], "seed {seed}");
        s.command(Command::Stop);
        s.pass(MS * 50);
        assert_eq!(s.outputs(), safe(), "seed {seed}");
        assert_eq!(s.missed, 0, "seed {seed}");
        assert_eq!(s.machine.controller.lost(), 0, "seed {seed}");
    }
}
