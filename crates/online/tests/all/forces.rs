//! Forced values of a controller, what becomes of its commands, and what others see of it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use g7_host::{Force, Value};
use g7_model::{FileId, Nanos};
use g7_online::{
    Absent, Command, Device, Disk, Event, FORCES, Failed, LONGEST, Machine, Mode, Quality, Raw, Refused,
    Slots, What, assemble, runner, setup, wire,
};
use g7_rig::{Bench, Options, Source, build};

const CHART: &str = "\
profile iec60848
input go : BOOL
input level : INT
output valve : BOOL
output lamp : BOOL safe TRUE
output speed : INT
var n : INT
chart Main {
  initial step 1 { N lamp }
  step 2 { N valve  P1 speed := 7 }
  1 -> 2 when go
  2 -> 1 when not go
}
";

const IO: &str = "\
[devices.unit]
kind = 'modbus-tcp'
host = 'simulated'
[inputs]
go = 'unit.discrete(0)'
level = { at = 'unit.input(0)', bad = 3 }
[outputs]
valve = 'unit.coil(0)'
";

/// A device whose button is pressed, and that answers as long as it has answers; its coil is seen from
/// outside.
struct Unit(usize, Arc<AtomicBool>);

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
        self.0 = self.0.checked_sub(1).ok_or_else(|| Failed("gone".to_owned()))?;
        if write[0] {
            self.1.store(outputs[0] == Raw::Bit(true), Ordering::Release);
        }
        inputs[0] = Ok(Raw::Bit(true));
        inputs[1] = Ok(Raw::Whole(40));
        Ok(())
    }

    fn close(&mut self) {}
}

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

struct Bed {
    bench: Bench,
    machine: Machine,
    now: Nanos,
    /// The coil of the device: the valve.
    coil: Arc<AtomicBool>,
}

impl Bed {
    /// A controller with the device, which answers so often, or without one.
    fn new(answers: Option<usize>) -> Bed {
        let source = Source::new("chart.g7", CHART.as_bytes().to_vec(), 0);
        let (bench, problems) = build(&source, &Options::default()).expect("no plant");
        let bench = bench.unwrap_or_else(|| panic!("{problems:?}"));
        let (setup, problems) = setup::read(if answers.is_some() { IO } else { "" }, FileId(1));
        let (wiring, wrong) = wire(&bench, &setup);
        assert!(problems.is_empty() && wrong.is_empty(), "{problems:?} {wrong:?}");
        let coil = Arc::new(AtomicBool::new(false));
        let unit = || Unit(answers.unwrap_or(0), Arc::clone(&coil));
        let device = |_: &_| Ok::<Box<dyn Device>, ()>(Box::new(unit()));
        let machine = assemble(runner(&bench, &wiring, 0), &wiring, device).expect("no device fails");
        Bed { bench, machine, now: Nanos::ZERO, coil }
    }

    fn pass(&mut self, time: Nanos) {
        let end = self.now + time;
        while self.now < end {
            self.now += self.machine.controller.runner().period();
            for driver in &mut self.machine.drivers {
                let worked = driver.work(self.now, &mut |_| {});
                driver.settle(self.now, worked, &mut |_| {});
            }
            self.machine.controller.step(self.now);
        }
    }

    fn command(&mut self, command: Command) -> Result<(), Refused> {
        self.machine.controller.command(self.now, command)
    }

    fn force_of(&self, name: &str) -> Force {
        self.bench.item(name).and_then(|item| self.bench.force_of(item)).expect("one word")
    }

    fn force(&mut self, name: &str, word: u64, lasts: Nanos) -> Result<(), Refused> {
        let what = self.force_of(name);
        self.command(Command::Force(what, word, lasts))
    }

    fn word(&self, name: &str) -> u64 {
        let item = self.bench.item(name).expect("a variable");
        let Value::Word(word) = self.bench.value(self.machine.controller.runner(), item) else {
            panic!("a text")
        };
        word
    }

    /// The events, without those of the pace.
    fn events(&mut self) -> Vec<What> {
        let events = std::iter::from_fn(|| self.machine.events.pop().ok());
        events.map(|Event { what, .. }| what).filter(|what| !matches!(what, What::Missed(_))).collect()
    }
}

const SECOND: Nanos = Nanos::SECOND;

#[test]
fn a_forced_input_is_read_until_its_time_is_over() {
    let mut bed = Bed::new(None);
    bed.command(Command::Run).expect("it is stopped");
    bed.force("go", 1, SECOND * 2).expect("there is room");
    bed.pass(SECOND);
    assert_eq!((bed.word("valve"), bed.word("lamp")), (1, 0));
    let go = bed.force_of("go");
    assert!(
        matches!(bed.events()[..], [What::Mode(Mode::Run), What::Forced(f)] if f.what == go && f.word == 1)
    );
    bed.pass(SECOND + Nanos::from_millis(50));
    assert_eq!((bed.word("valve"), bed.word("lamp")), (0, 1));
    assert_eq!(bed.events(), [What::Ended(go)]);
    assert_eq!(bed.command(Command::Release(go)), Err(Refused::Free));
}

#[test]
fn a_second_force_replaces_the_value_and_the_end_of_the_first() {
    let mut bed = Bed::new(None);
    bed.command(Command::Run).expect("it is stopped");
    bed.force("n", 5, SECOND).expect("there is room");
    bed.force("n", 6, SECOND * 3).expect("it is the same");
    bed.pass(SECOND * 2);
    assert_eq!(bed.word("n"), 6);
    assert_eq!(bed.machine.controller.runner().forces().count(), 1);
    bed.pass(SECOND * 2);
    assert_eq!(bed.machine.controller.runner().forces().count(), 0);
}

#[test]
fn an_output_that_is_taken_back_has_the_value_of_the_charts_again() {
    let mut bed = Bed::new(None);
    bed.command(Command::Run).expect("it is stopped");
    bed.pass(SECOND);
    bed.force("lamp", 0, SECOND * 60).expect("there is room");
    bed.force("valve", 1, SECOND * 60).expect("there is room");
    bed.pass(SECOND);
    assert_eq!((bed.word("lamp"), bed.word("valve")), (0, 1));
    bed.command(Command::ReleaseAll).expect("two are forced");
    assert_eq!((bed.word("lamp"), bed.word("valve")), (1, 0));
    assert_eq!(bed.command(Command::ReleaseAll), Err(Refused::Free));
}

#[test]
fn a_forced_output_reaches_the_device_only_while_it_runs() {
    let mut bed = Bed::new(Some(usize::MAX));
    let mut sight = bed.machine.show();
    let coil = |bed: &Bed| bed.coil.load(Ordering::Acquire);
    // The button is held up, so the charts leave the valve shut.
    bed.force("go", 0, SECOND * 60).expect("there is room");
    bed.force("valve", 1, SECOND * 60).expect("there is room");
    bed.pass(SECOND);
    assert!(sight.look() && !sight.drives() && !coil(&bed), "stopped");
    bed.command(Command::Run).expect("it is stopped");
    bed.pass(SECOND);
    assert!(sight.look() && sight.drives() && coil(&bed), "running");
    bed.command(Command::Stop).expect("it runs");
    bed.pass(SECOND);
    assert!(sight.look() && !sight.drives() && !coil(&bed), "stopped again");
    let valve = bed.force_of("valve");
    bed.command(Command::Run).expect("it is stopped");
    bed.command(Command::Release(valve)).expect("it is forced");
    bed.pass(SECOND);
    assert!(!coil(&bed), "the value of the charts");
}

#[test]
fn what_is_kept_is_the_value_of_the_charts_and_not_the_forced_one() {
    let kept = |forced: Option<u64>| {
        let mut bed = Bed::new(None);
        let slots = Slots::begin(Nowhere, 0, 0).expect("the disk takes all");
        let bench = std::mem::replace(&mut bed.bench, Bed::new(None).bench);
        let _kept = bed.machine.keep(&bench, slots);
        bed.bench = bench;
        bed.command(Command::Run).expect("it is stopped");
        bed.pass(SECOND);
        if let Some(word) = forced {
            bed.force("lamp", word, SECOND * 60).expect("there is room");
        }
        bed.pass(SECOND);
        let words = bed.machine.controller.kept().to_vec();
        assert_eq!(bed.word("lamp"), forced.unwrap_or(1), "what the device gets stays forced");
        words
    };
    assert_eq!(kept(Some(0)), kept(None));
}

#[test]
fn commands_that_cannot_be_carried_out_say_why() {
    let mut bed = Bed::new(None);
    assert_eq!(bed.command(Command::Stop), Err(Refused::Rests));
    assert_eq!(bed.command(Command::Acknowledge), Err(Refused::NoFault));
    assert_eq!(bed.command(Command::Run), Ok(()));
    assert_eq!(bed.command(Command::Run), Err(Refused::Runs));
    for time in [Nanos::ZERO, Nanos::new(-1), LONGEST + Nanos::new(1)] {
        assert_eq!(bed.force("go", 1, time), Err(Refused::Time));
    }
    assert_eq!(bed.force("go", 1, LONGEST), Ok(()));
    bed.command(Command::ReleaseAll).expect("one is forced");
    for index in 0..FORCES as u32 {
        assert_eq!(bed.command(Command::Force(Force::Input(1000 + index), 0, SECOND)), Ok(()));
    }
    assert_eq!(bed.force("go", 1, SECOND), Err(Refused::Full));
    bed.pass(SECOND * 2);
    assert_eq!(bed.force("go", 1, SECOND), Ok(()), "they have ended");
}

#[test]
fn who_looks_sees_values_qualities_forces_and_the_situation() {
    let mut bed = Bed::new(Some(20));
    let mut sight = bed.machine.show();
    assert!(!sight.look(), "nothing was shown yet");
    assert_eq!(sight.quality(0, 0), Quality::Unread);
    bed.pass(Nanos::from_millis(100));
    assert!(sight.look() && sight.is_up(0) && !sight.drives());
    // The inputs are those of the device, although nothing runs.
    assert_eq!((sight.input(0), sight.input(1), sight.quality(0, 1)), (1, 40, Quality::Good));
    bed.command(Command::Run).expect("it is stopped");
    bed.force("level", 9, SECOND * 10).expect("there is room");
    bed.pass(Nanos::from_millis(100));
    assert!(sight.look() && sight.drives());
    let situation = bed.bench.situation(sight.state()).join(" ");
    assert_eq!((situation.as_str(), sight.input(1)), ("2", 9));
    let forces: Vec<_> = sight.forces().collect();
    assert_eq!((forces.len(), forces[0].what, forces[0].word), (1, bed.force_of("level"), 9));
    // The device falls silent: its inputs are bad, and hold or take their substitute.
    bed.pass(SECOND * 5);
    bed.command(Command::ReleaseAll).expect("one is forced");
    bed.pass(SECOND);
    assert!(sight.look() && !sight.is_up(0));
    assert_eq!((sight.quality(0, 0), sight.input(0), sight.input(1)), (Quality::Bad, 1, 3));
    assert_eq!(sight.forces().count(), 0);
    assert!(!sight.look(), "it is told once");
}
