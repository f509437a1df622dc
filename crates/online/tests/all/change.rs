//! On-line changes of a controller: what goes on, what is refused, and what is taken back.

use std::sync::{Arc, Mutex};

use g7_host::{Force, Value};
use g7_model::{FileId, Nanos};
use g7_online::{
    Absent, Chart, Command, Device, Event, Failed, Machine, Picture, Prepared, Raw, What, Wiring, assemble,
    prepare, runner, setup, wire,
};
use g7_rig::{Bench, Options, Source, build};

const MS: Nanos = Nanos::MILLISECOND;

const CHART: &str = "\
profile iec60848
input go : BOOL
input level : INT
output valve : BOOL
output lamp : BOOL safe TRUE
output count : INT
var presses : INT retain
chart Main {
  initial step 1 { N lamp }
  step 2 { N valve  P1 presses := presses + 1  P1 count := presses + 1 }
  1 -> 2 when go
  2 -> 1 when not go
}
";

const IO: &str = "\
[devices.unit]
kind = 'modbus-tcp'
host = 'simulated'
poll = '10ms'
[inputs]
go = 'unit.discrete(0)'
level = 'unit.input(0)'
[outputs]
valve = 'unit.coil(0)'
lamp = 'unit.coil(1)'
count = 'unit.holding(0)'
";

/// The button of a device, and the values that it got last.
#[derive(Default)]
struct World {
    go: bool,
    outputs: Vec<Raw>,
}

struct Unit(Arc<Mutex<World>>);

impl Device for Unit {
    fn connect(&mut self) -> Result<(), Failed> {
        Ok(())
    }

    fn exchange(
        &mut self,
        outputs: &[Raw],
        write: &[bool],
        inputs: &mut [Result<Raw, Absent>],
        _: &mut [Option<String>],
    ) -> Result<(), Failed> {
        let mut world = self.0.lock().expect("one thread");
        world.outputs.resize(outputs.len(), Raw::Whole(-99));
        let written = world.outputs.iter_mut().zip(outputs).zip(write).filter(|(_, write)| **write);
        written.for_each(|((to, from), _)| *to = *from);
        inputs[0] = Ok(Raw::Bit(world.go));
        inputs[1] = Ok(Raw::Whole(40));
        Ok(())
    }

    fn close(&mut self) {}
}

/// A chart with its wires.
struct Wired {
    source: Source,
    bench: Bench,
    wiring: Wiring,
}

impl Wired {
    fn new(chart: &str, io: &str) -> Wired {
        let source = Source::new("chart.g7", chart.as_bytes().to_vec(), 0);
        let (bench, problems) = build(&source, &Options::default()).expect("no plant");
        let bench = bench.unwrap_or_else(|| panic!("{problems:?}"));
        let (setup, problems) = setup::read(io, FileId(1));
        let (wiring, wrong) = wire(&bench, &setup);
        assert!(problems.is_empty() && wrong.is_empty(), "{problems:?} {wrong:?}");
        Wired { source, bench, wiring }
    }

    fn chart(&self) -> Chart<'_> {
        Chart { bench: &self.bench, document: &self.source.document, wiring: &self.wiring }
    }

    fn force_of(&self, name: &str) -> Force {
        self.bench.item(name).and_then(|item| self.bench.force_of(item)).expect("one word")
    }
}

struct Bed {
    chart: Wired,
    machine: Machine,
    picture: Box<Picture>,
    now: Nanos,
    world: Arc<Mutex<World>>,
}

impl Bed {
    fn new() -> Bed {
        let chart = Wired::new(CHART, IO);
        let world = Arc::new(Mutex::new(World::default()));
        let unit = |_: &_| Ok::<Box<dyn Device>, ()>(Box::new(Unit(Arc::clone(&world))));
        let machine =
            assemble(runner(&chart.bench, &chart.wiring, 0), &chart.wiring, unit).expect("a device");
        let picture = Box::new(Picture::of(machine.controller.runner()));
        let mut bed = Bed { chart, machine, picture, now: Nanos::ZERO, world };
        bed.command(Command::Run);
        bed.scans(5);
        bed
    }

    fn scans(&mut self, count: u32) {
        for _ in 0..count {
            self.now += MS * 10;
            for driver in &mut self.machine.drivers {
                let worked = driver.work(self.now, &mut |_| {});
                driver.settle(self.now, worked, &mut |_| {});
            }
            self.machine.controller.step(self.now);
        }
    }

    fn command(&mut self, command: Command) {
        self.machine.controller.command(self.now, command).expect("it can be carried out");
    }

    fn press(&mut self, go: bool) {
        self.world.lock().expect("one thread").go = go;
        self.scans(3);
    }

    fn prepared(&mut self, new: &Wired) -> Result<Prepared, String> {
        self.machine.controller.look(&mut self.picture);
        prepare(self.chart.chart(), new.chart(), &self.picture)
    }

    /// Goes on with another chart; returns the losses, and the chart before.
    fn change(&mut self, new: Wired) -> (Vec<String>, Wired) {
        let mut prepared = self.prepared(&new).expect("it can be made");
        assert!(self.machine.controller.change(self.now, &mut prepared.successor), "nothing happened since");
        self.picture = prepared.picture;
        (prepared.lost, std::mem::replace(&mut self.chart, new))
    }

    fn why_not(&mut self, chart: &str, io: &str) -> String {
        self.prepared(&Wired::new(chart, io)).err().expect("it is refused")
    }

    fn situation(&self) -> String {
        self.chart.bench.situation(self.machine.controller.runner().state()).join(",")
    }

    fn word(&self, name: &str) -> u64 {
        let item = self.chart.bench.item(name).expect("a variable");
        match self.chart.bench.value(self.machine.controller.runner(), item) {
            Value::Word(word) => word,
            Value::Text(text) => panic!("{text}"),
        }
    }

    /// Valve, lamp and count of the device.
    fn outputs(&self) -> Vec<Raw> {
        self.world.lock().expect("one thread").outputs.clone()
    }

    fn events(&mut self) -> Vec<What> {
        std::iter::from_fn(|| self.machine.events.pop().ok()).map(|Event { what, .. }| what).collect()
    }
}

fn device(valve: bool, lamp: bool, count: i128) -> Vec<Raw> {
    vec![Raw::Bit(valve), Raw::Bit(lamp), Raw::Whole(count)]
}

/// The chart with variables and steps before those that were there, so that no word stays at its place.
fn moved() -> String {
    CHART
        .replace("input go", "input spare : BOOL\ninput go")
        .replace("output valve", "output horn : BOOL\noutput valve")
        .replace("var presses", "var first : LREAL := 2.5\nvar presses")
        .replace("initial step 1", "step 0 { N horn }\n  initial step 1")
        .replace("2 -> 1 when not go", "2 -> 0 when not go\n  0 -> 1 when X0.t >= 50ms")
}

#[test]
fn the_machine_goes_on_where_it_was() {
    let mut bed = Bed::new();
    bed.press(true);
    assert_eq!((bed.situation().as_str(), bed.outputs()), ("2", device(true, false, 1)));
    bed.events();
    let scans = bed.machine.controller.runner().state().scans();
    let (lost, _) = bed.change(Wired::new(&moved(), IO));
    assert_eq!(lost, Vec::<String>::new());
    assert_eq!(bed.events(), [What::Changed]);
    bed.scans(3);
    assert_eq!((bed.situation().as_str(), bed.outputs()), ("2", device(true, false, 1)));
    let runner = bed.machine.controller.runner();
    assert_eq!((runner.state().scans(), bed.machine.controller.missed()), (scans + 3, 0));
    assert_eq!((bed.word("presses"), bed.word("level")), (1, 40));
    // The step that is new is there.
    bed.press(false);
    assert_eq!(bed.situation(), "0");
    bed.scans(8);
    assert_eq!((bed.situation().as_str(), bed.outputs()), ("1", device(false, true, 1)));
    bed.press(true);
    assert_eq!((bed.situation().as_str(), bed.outputs()), ("2", device(true, false, 2)));
}

#[test]
fn a_change_is_taken_back() {
    let mut bed = Bed::new();
    bed.press(true);
    let (_, before) = bed.change(Wired::new(&moved(), IO));
    bed.scans(3);
    let (lost, _) = bed.change(before);
    assert_eq!(lost, Vec::<String>::new());
    bed.press(false);
    assert_eq!((bed.situation().as_str(), bed.outputs()), ("1", device(false, true, 1)));
}

#[test]
fn what_would_be_lost_is_said_before_anything_changes() {
    let mut bed = Bed::new();
    bed.press(true);
    let without = CHART.replace("step 2", "step 3").replace("1 -> 2", "1 -> 3").replace("2 -> 1", "3 -> 1");
    let prepared = bed.prepared(&Wired::new(&without, IO)).expect("it could be made");
    assert_eq!(prepared.lost, ["step `2` is active and no longer exists"]);
    bed.press(false);
    assert_eq!((bed.situation().as_str(), bed.word("presses")), ("1", 1));
}

#[test]
fn a_change_that_comes_after_the_next_scan_is_not_taken() {
    let mut bed = Bed::new();
    let new = Wired::new(&moved(), IO);
    let mut late = bed.prepared(&new).expect("it can be made");
    bed.press(true);
    assert!(!bed.machine.controller.change(bed.now, &mut late.successor), "a scan was made since");
    bed.scans(3);
    assert_eq!((bed.situation().as_str(), bed.outputs()), ("2", device(true, false, 1)));
    // So is one that comes after a command.
    let mut late = bed.prepared(&new).expect("it can be made");
    bed.command(Command::Stop);
    assert!(!bed.machine.controller.change(bed.now, &mut late.successor));
    // Nothing happens to a controller that is stopped: its change waits.
    let mut prepared = bed.prepared(&new).expect("it can be made");
    bed.scans(5);
    assert!(bed.machine.controller.change(bed.now, &mut prepared.successor));
    bed.chart = new;
    bed.command(Command::Run);
    bed.press(false);
    assert_eq!(bed.situation(), "0");
}

#[test]
fn forces_go_on_to_their_end_and_a_forced_output_keeps_its_own_value() {
    let stored = CHART.replace("N valve", "S valve").replace("{ N lamp }", "{ N lamp  R valve }");
    let mut bed = Bed::new();
    bed.change(Wired::new(&stored, IO));
    bed.scans(2);
    for (name, word, lasts) in [("go", 1, MS * 300), ("valve", 0, MS * 200)] {
        let what = bed.chart.force_of(name);
        bed.command(Command::Force(what, word, lasts));
    }
    bed.scans(5);
    assert_eq!((bed.situation().as_str(), bed.outputs()), ("2", device(false, false, 1)));
    let moved = stored
        .replace("input go", "input spare : BOOL\ninput go")
        .replace("output valve", "output horn : BOOL\noutput valve");
    let (lost, _) = bed.change(Wired::new(&moved, IO));
    assert_eq!(lost, Vec::<String>::new());
    bed.events();
    bed.scans(10);
    assert_eq!(bed.outputs(), device(false, false, 1), "still forced");
    bed.scans(8);
    assert_eq!(bed.events(), [What::Ended(bed.chart.force_of("valve"))]);
    assert_eq!((bed.situation().as_str(), bed.outputs()), ("2", device(true, false, 1)), "S holds it");
    bed.scans(12);
    assert_eq!(bed.events(), [What::Ended(bed.chart.force_of("go"))]);
    assert_eq!((bed.situation().as_str(), bed.outputs()), ("1", device(false, true, 1)));
}

#[test]
fn what_lies_outside_the_chart_needs_a_new_start() {
    let mut bed = Bed::new();
    let mut refuses = |chart: &str, io: &str, why: &str| {
        assert_eq!(bed.why_not(chart, io), format!("{why}: this needs a new start"));
    };
    let period = CHART.replace("profile iec60848", "profile iec60848\nscan 20ms");
    refuses(&period, IO, "the scan time changes from 10 ms to 20 ms");
    let safe = CHART.replace("safe TRUE", "safe FALSE");
    refuses(&safe, IO, "`unit`: the output `lamp` has another wire, type or safe value");
    let other = IO.replace("coil(1)", "coil(2)");
    refuses(CHART, &other, "`unit`: the output `lamp` has another wire, type or safe value");
    let other = IO.replace("discrete(0)", "discrete(9)");
    refuses(CHART, &other, "`unit`: the input `go` has another wire or type");
    let fewer = IO.replace("count = 'unit.holding(0)'\n", "");
    refuses(CHART, &fewer, "`unit`: a channel is gone");
    let more = IO.replace("valve =", "horn = 'unit.coil(7)'\nvalve =");
    let chart = CHART.replace("output valve", "output horn : BOOL\noutput valve");
    refuses(&chart, &more, "`unit`: the output `horn` has another wire, type or safe value");
    refuses(CHART, &IO.replace("10ms", "20ms"), "`unit`: the device is declared otherwise");
    refuses(CHART, &IO.replace("unit", "other"), "the device `other` is a new one");
    refuses(CHART, "", "the device `unit` has no channels any more");
}

#[test]
fn a_fault_of_the_chart_is_ended_first() {
    let chart = CHART.replace("P1 presses := presses + 1", "P1 presses := 1 / presses");
    let mut bed = Bed::new();
    bed.change(Wired::new(&chart, IO));
    bed.press(true);
    assert_eq!(bed.why_not(CHART, IO), "a fault has stopped the run: restart it");
}
