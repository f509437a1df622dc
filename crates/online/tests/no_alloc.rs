//! A step of the controller allocates nothing: with values and events of a device, with values that are
//! kept, forced ones, commands, one who looks, a history of all signals, on-line changes, and a plant in
//! place of other devices.

use allocation_counter::measure;
use g7_model::{FileId, Nanos};
use g7_online::{
    Absent, Chart, Command, Device, Disk, Failed, Picture, Raw, Slots, assemble, prepare, runner, setup, wire,
};
use g7_rig::{Options, Source, build};

const IO: &str = "\
[devices.unit]
kind = 'modbus-tcp'
host = 'simulated'
[inputs]
Tilt = { at = 'unit.discrete(0)', bad = false }
Col = { at = 'unit.input(2)', as = 'f32' }
[outputs]
Sol1 = 'unit.coil(0)'
LED = 'unit.coil(6)'
[history]
file = 'record'
deadband = { Col = 2.5 }
";

/// Each exchange turns the unit over, and from time to time it does not answer.
struct Unit(u64);

impl Device for Unit {
    fn connect(&mut self) -> Result<(), Failed> {
        Ok(())
    }

    fn exchange(
        &mut self,
        _: &[Raw],
        _: &[bool],
        inputs: &mut [Result<Raw, Absent>],
        _: &mut [Option<String>],
    ) -> Result<(), Failed> {
        self.0 += 1;
        if self.0.is_multiple_of(50) {
            return Err(Failed("asleep".to_owned()));
        }
        inputs[0] = Ok(Raw::Bit(self.0 % 200 < 100));
        inputs[1] = Ok(Raw::Real(self.0 as f64));
        Ok(())
    }

    fn close(&mut self) {}
}

/// A disk that forgets.
struct Nowhere;

impl Disk for Nowhere {
    fn read(&mut self) -> std::io::Result<Vec<u8>> {
        Ok(Vec::new())
    }
    fn create(&mut self, _: &[u8]) -> std::io::Result<()> {
        Ok(())
    }
    fn write(&mut self, _: u64, _: &[u8]) -> std::io::Result<()> {
        Ok(())
    }
    fn sync(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn row_27_a_step_allocates_nothing() {
    let text = include_str!("../../../examples/bead-sorter/chart.g7")
        .replace("var Sort : BOOL", "var Kept : INT retain\nvar Sort : BOOL");
    let source = Source::new("chart.g7", text.into_bytes(), 0);
    let (bench, problems) = build(&source, &Options::default()).expect("it has one plant");
    let bench = bench.unwrap_or_else(|| panic!("{problems:?}"));
    let (setup, problems) = setup::read(IO, FileId(1));
    let (wiring, wrong) = wire(&bench, &setup);
    assert!(problems.is_empty() && wrong.is_empty(), "{problems:?} {wrong:?}");
    let run = runner(&bench, &wiring, 0);
    let force = |name: &str| bench.item(name).and_then(|item| bench.force_of(item)).expect("one word");
    let (led, tilt) = (force("LED"), force("Tilt"));
    let device = |_: &_| Ok::<Box<dyn Device>, std::io::Error>(Box::new(Unit(0)));
    let mut machine = assemble(run, &wiring, device).expect("no device fails");
    let slots = Slots::begin(Nowhere, 0, 0).expect("the disk takes all");
    let _kept = machine.keep(&bench, slots);
    let mut sight = machine.show();
    let mut notes = machine.record(&wiring).expect("signals are chosen");
    let chart = Chart { bench: &bench, document: &source.document, wiring: &wiring };
    let mut picture = Box::new(Picture::of(machine.controller.runner()));
    let mut changes = 0;
    let period = machine.controller.runner().period();
    let (mut now, mut allocating, mut events, mut looks, mut noted) = (Nanos::ZERO, 0, 0, 0, 0);
    let steps = g7_peers::faults::trials(1_000_000, 20_000).into();
    for k in 0..steps {
        now += period;
        let driver = &mut machine.drivers[0];
        let worked = driver.work(now, &mut |_| {});
        driver.settle(now, worked, &mut |_| {});
        // Late by several periods.
        now += period * i64::from(k % 1000 == 700) * 5;
        let counted = measure(|| {
            match k % 1000 {
                0 => machine.controller.command(now, Command::Run).expect("it is stopped"),
                100 => machine.controller.command(now, Command::Force(led, 1, period * 400)).expect("room"),
                200 => machine.controller.command(now, Command::Force(tilt, 0, period * 10)).expect("room"),
                800 => machine.controller.command(now, Command::ReleaseAll).err().map_or((), drop),
                900 => machine.controller.command(now, Command::Stop).expect("it runs"),
                _ => {}
            }
            machine.controller.step(now);
        });
        allocating += usize::from(counted.count_total > 0);
        if k % 250 == 220 {
            let looked = measure(|| machine.controller.look(&mut picture));
            let mut prepared = prepare(chart, chart, &picture).expect("the same chart");
            let mut taken = false;
            let changed = measure(|| taken = machine.controller.change(now, &mut prepared.successor));
            assert!(taken, "{k}");
            for counted in [looked, changed] {
                assert_eq!((counted.count_total, counted.count_current), (0, 0), "{k}");
            }
            (picture, sight) = (prepared.picture, prepared.sight);
            changes += 1;
        }
        while machine.events.pop().is_ok() {
            events += 1;
        }
        looks += usize::from(sight.look());
        while notes.notes.pop().is_ok() {
            noted += 1;
        }
    }
    assert!(events > 20 && machine.controller.runner().state().scans() > 10_000, "{events} events");
    assert!(looks > 4_000 && changes == steps / 250, "{looks} times shown, {changes} changes");
    assert!(noted > 10_000, "{noted} notes");
    // Nobody takes the notes, and their ring is full.
    machine.controller.command(now, Command::Run).expect("it is stopped");
    for k in 0..80_000 {
        now += period;
        let counted = measure(|| {
            machine.controller.command(now, Command::Force(led, k & 1, period * 2)).expect("room");
            machine.controller.step(now);
        });
        allocating += usize::from(counted.count_total > 0);
        while machine.events.pop().is_ok() {}
    }
    assert!(notes.notes.slots() > 60_000, "{} notes", notes.notes.slots());
    assert_eq!(allocating, 0, "steps that allocate");
    g7_peers::faults::row(27, "allocations", steps, 0, "none, with commands, forces, changes and events");
}
