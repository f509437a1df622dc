//! Faults inside a controller in real time, with its real threads: a disk that stalls or fails, code that does
//! not end in time, a device whose driver has an error.
//!
//! No time is asserted: a disk stalls until so many scans were made, and a scan lasts until the outputs are
//! safe. What times there are is printed in the rows.
#![allow(clippy::disallowed_methods, reason = "threads run beside each other, in real time")]

use crate::common;

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

use common::{Ill, Simulated, panics};
use g7_model::{FileId, Nanos};
use g7_online::{
    Absent, Command, Device, Disk, Event, Failed, Happened, Machine, Mode, Options, Raw, Reason, Running,
    Slots, What, Wiring, assemble, runner, setup, start, wire,
};
use g7_peers::faults::{Times, many, row, trials};
use g7_rig::{Bench, Source, build};

/// Longer than anything takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(120);

/// It counts its scans; the valve is open while it runs.
const CHART: &str = "\
profile iec60848
input go : BOOL
input other : BOOL
output valve : BOOL
output lamp : BOOL
var n : LINT retain
var spins : DINT
chart Main {
  initial step 1 { N valve  N lamp  each scan: n := n + 1 }
  step 2 { N valve  each scan: { FOR spins := 1 TO 100000 DO n := n + 1 END_FOR } }
  1 -> 2 when go
}
";

fn io(poll: &str) -> String {
    let device = |name: &str| {
        format!(
            "[devices.{name}]\nkind = 'modbus-tcp'\nhost = '{name}'\npoll = '{poll}'\ntimeout = '200ms'\n\
             retry = '100ms'\n"
        )
    };
    device("a")
        + &device("b")
        + "[inputs]\ngo = { at = 'a.discrete(0)', bad = false }\nother = { at = 'b.discrete(0)', bad = false }\n\
           [outputs]\nvalve = 'a.coil(0)'\nlamp = 'b.coil(0)'\n"
}

/// A device that has one input and one output.
#[derive(Default)]
struct Unit {
    input: AtomicBool,
    output: AtomicBool,
    panics: AtomicBool,
    exchanges: AtomicU64,
}

struct At(Arc<Unit>);

impl Device for At {
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
        if self.0.panics.load(Ordering::Acquire) {
            panics();
        }
        if write[0] {
            self.0.output.store(outputs[0] == Raw::Bit(true), Ordering::Release);
        }
        inputs[0] = Ok(Raw::Bit(self.0.input.load(Ordering::Acquire)));
        self.0.exchanges.fetch_add(1, Ordering::AcqRel);
        Ok(())
    }

    fn close(&mut self) {}
}

/// A controller with two devices.
struct Bed {
    bench: Bench,
    wiring: Wiring,
    units: [Arc<Unit>; 2],
}

impl Bed {
    fn new() -> Bed {
        Bed::of(CHART)
    }

    fn of(chart: &str) -> Bed {
        let source = Source::new("chart.g7", chart.as_bytes().to_vec(), 0);
        let (bench, problems) = build(&source, &g7_rig::Options::default()).expect("no plant");
        let bench = bench.unwrap_or_else(|| panic!("{problems:?}"));
        let (setup, problems) = setup::read(&io("10ms"), FileId(1));
        let (wiring, wrong) = wire(&bench, &setup);
        assert!(problems.is_empty() && wrong.is_empty(), "{problems:?} {wrong:?}");
        Bed { bench, wiring, units: Default::default() }
    }

    fn machine(&self) -> Machine {
        let mut units = self.units.iter();
        let device = |_: &_| {
            let unit = units.next().expect("two devices");
            Ok::<Box<dyn Device>, ()>(Box::new(At(Arc::clone(unit))))
        };
        assemble(runner(&self.bench, &self.wiring, 0), &self.wiring, device).expect("two devices")
    }

    /// Starts it with its values on a disk, and waits until it scans.
    fn start<D: Disk + Send + 'static>(&self, disk: D, watchdog: Nanos) -> Running {
        let mut machine = self.machine();
        // The bench is that of the machine, so there are as many words.
        let words = machine.keep(&self.bench, Slots::begin(Simulated::default(), 0, 0).expect("well")).words;
        let kept = machine.keep(&self.bench, Slots::begin(disk, 0, words).expect("the disk is well"));
        let mut running = start(machine, Some(kept), Options { watchdog, priority: None }).expect("threads");
        running.command(Command::Run);
        wait("both outputs", || {
            // On a busy machine a short watchdog may trip before anything was asked of the chart.
            let mut mode = None;
            missed(&mut running, &mut mode);
            if let Some(Mode::Fault(Reason::Watchdog)) = mode {
                running.command(Command::Acknowledge);
                running.command(Command::Run);
            }
            self.outputs() == [true, true]
        });
        running
    }

    fn outputs(&self) -> [bool; 2] {
        [0, 1].map(|k| self.units[k].output.load(Ordering::Acquire))
    }

    fn exchanges(&self, unit: usize) -> u64 {
        self.units[unit].exchanges.load(Ordering::Acquire)
    }
}

#[track_caller]
fn wait(what: &str, mut is: impl FnMut() -> bool) {
    let begin = Instant::now();
    while !is() {
        assert!(begin.elapsed() < PATIENCE, "{what} does not come");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Waits until so many scans more were made.
#[track_caller]
fn scans(running: &mut Running, more: usize) {
    while running.paces.pop().is_ok() {}
    let mut seen = 0;
    wait("a scan", || {
        while running.paces.pop().is_ok() {
            seen += 1;
        }
        seen >= more
    });
}

/// The scans that were left out so far, and the mode that was told last.
fn missed(running: &mut Running, mode: &mut Option<Mode>) -> u64 {
    let mut missed = 0;
    while let Ok(Event { what, .. }) = running.events.pop() {
        match what {
            What::Missed(n) => missed += n,
            What::Mode(is) => *mode = Some(is),
            _ => {}
        }
    }
    missed
}

/// A disk whose sync lasts until it is let go, or so long.
#[derive(Clone, Default)]
struct Stalls(Arc<(Mutex<Stall>, Condvar)>);

#[derive(Default)]
struct Stall {
    /// A sync waits from here on.
    wanted: bool,
    waits: bool,
    done: u64,
}

impl Stalls {
    fn with<T>(&self, act: impl FnOnce(&mut Stall) -> T) -> T {
        let done = act(&mut self.0.0.lock().unwrap_or_else(PoisonError::into_inner));
        self.0.1.notify_all();
        done
    }
}

impl Disk for Stalls {
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
        let mut stall = self.0.0.lock().unwrap_or_else(PoisonError::into_inner);
        stall.waits = stall.wanted;
        while stall.wanted {
            stall = self.0.1.wait(stall).unwrap_or_else(PoisonError::into_inner);
        }
        stall.waits = false;
        stall.done += 1;
        Ok(())
    }
}

#[test]
fn row_5_scans_go_on_while_the_disk_stalls() {
    let (count, beside) = (trials(10, 2), trials(10, 1));
    let stalled = if many() { Duration::from_secs(5) } else { Duration::ZERO };
    // In the long version several controllers have their disks stalled at the same time.
    let controllers = (0..beside).map(|_| {
        std::thread::spawn(move || {
            let (bed, disk) = (Bed::new(), Stalls::default());
            let mut running = bed.start(disk.clone(), Nanos::SECOND * 60);
            let (mut scans_made, mut left_out) = (0, 0);
            for _ in 0..count {
                disk.with(|stall| stall.wanted = true);
                wait("a sync", || disk.with(|stall| stall.waits));
                let begin = Instant::now();
                missed(&mut running, &mut None);
                // The stall ends after these scans, so each of them is made within it.
                scans(&mut running, 20);
                scans_made += 20;
                while begin.elapsed() < stalled {
                    scans(&mut running, 10);
                    scans_made += 10;
                }
                left_out += missed(&mut running, &mut None);
                assert!(disk.with(|stall| stall.waits), "it still stalls");
                let done = disk.with(|stall| {
                    stall.wanted = false;
                    stall.done
                });
                wait("the next save", || disk.with(|stall| stall.done > done + 1));
            }
            assert!(running.end().is_some(), "the scan is well");
            (scans_made, left_out)
        })
    });
    let all: Vec<_> = controllers.collect();
    let sums =
        all.into_iter().map(|c| c.join().expect("it holds")).fold((0u64, 0), |s, c| (s.0 + c.0, s.1 + c.1));
    let held = format!("{} scans within the stalls of {stalled:?}, left out {}", sums.0, sums.1);
    row(5, "", u64::from(count * beside), 0, held);
}

#[test]
fn row_4_a_disk_that_fails_is_told_once_and_values_are_saved_when_it_is_well() {
    let (bed, disk, count) = (Bed::new(), Simulated::default(), trials(100, 3));
    let mut running = bed.start(disk.clone(), Nanos::SECOND * 60);
    wait("a first save", || !disk.plates().safe.is_empty());
    for k in 0..count {
        let ill = [Ill::NoWrite, Ill::NoSync, Ill::Panics][k as usize % 3];
        disk.plates().ill = ill;
        let mut told = 0;
        wait("an event", || {
            told += running.disk.try_iter().count();
            told > 0
        });
        // Values come each 100 ms: several saves fail meanwhile.
        scans(&mut running, 30);
        told += running.disk.try_iter().count();
        assert_eq!(told, 1, "{ill:?} is told once");
        let before = disk.plates().safe.clone();
        disk.plates().ill = Ill::Well;
        wait("a save", || disk.plates().safe != before);
    }
    assert!(running.end().is_some(), "the scan is well");
    row(4, "writes and syncs fail", count.into(), 0, "told once each, saved again by the same program");
}

#[test]
fn row_17_outputs_are_safe_while_a_scan_overruns_its_watchdog() {
    let (mut times, count) = (Times::default(), trials(20, 1));
    for _ in 0..count {
        let bed = Bed::of(&CHART.replace("iec60848", "iec60848\nscan 1ms"));
        // The chart counts up to 100,000 in each scan of step 2. This watchdog leaves it no time for that.
        let mut running = bed.start(Simulated::default(), Nanos::from_millis(5));
        bed.units[0].input.store(true, Ordering::Release);
        let begin = Instant::now();
        let mut mode = None;
        wait("safe outputs", || bed.outputs() == [false, false]);
        times.add(begin.elapsed());
        wait("the fault", || {
            missed(&mut running, &mut mode);
            matches!(mode, Some(Mode::Fault(Reason::Watchdog | Reason::Halt(_))))
        });
        running.end().expect("it did not panic");
    }
    row(17, "an overrun of the watchdog (5 ms)", count.into(), 0, format!("outputs safe after {times}"));
}

#[test]
fn row_18_a_device_that_panics_is_lost_and_comes_back_while_all_else_goes_on() {
    let (bed, count) = (Bed::new(), trials(100, 3));
    let mut running = bed.start(Simulated::default(), Nanos::SECOND * 60);
    let (mut lost, mut back) = (Times::default(), Times::default());
    let mut hears = |running: &Running, device: usize, up: bool| {
        let begin = Instant::now();
        wait("an event of the device", || {
            running.devices.try_iter().any(|at| {
                assert!(
                    at.device == device || at.happened == Happened::Up,
                    "the other is unaffected: {at:?}"
                );
                at.device == device && matches!(at.happened, Happened::Up) == up
            })
        });
        if up { back.add(begin.elapsed()) } else { lost.add(begin.elapsed()) }
    };
    for _ in 0..count {
        bed.units[1].panics.store(true, Ordering::Release);
        hears(&running, 1, false);
        scans(&mut running, 5);
        let before = bed.exchanges(0);
        wait("the other device", || bed.exchanges(0) > before + 2);
        assert!(bed.outputs()[0], "the output of the other device");
        // Outputs that the device has forgotten are written again.
        bed.units[1].output.store(false, Ordering::Release);
        bed.units[1].panics.store(false, Ordering::Release);
        hears(&running, 1, true);
        wait("its output", || bed.outputs()[1]);
    }
    assert!(running.is_alive());
    running.end().expect("the scan did not panic");
    assert_eq!(bed.outputs(), [false, false], "safe at the end");
    row(
        18,
        "a device",
        count.into(),
        0,
        format!("lost after {lost}; back after {back}; scans and the other go on"),
    );
}
