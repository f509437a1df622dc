//! The threads around the scan, when the scan itself has an error.

use g7_model::FileId;
use g7_peers::faults::{Times, row, trials};
use g7_rig::{Source, build};

use super::*;
use crate::{Absent, Device, Failed, Raw, RealDisk, assemble, runner, setup, wire};

const CHART: &str = "\
output valve : BOOL
output lamp : BOOL safe TRUE
chart Main {
  initial step 1 { N valve }
  1 -> 1 when FALSE
}
";

const IO: &str = "\
[devices.line1]
kind = 'modbus-tcp'
host = 'simulated'
poll = '5ms'
[outputs]
valve = 'line1.coil(0)'
lamp = 'line1.coil(1)'
";

/// A device whose outputs are seen from outside.
struct Unit(Arc<Mutex<Vec<Raw>>>);

impl Device for Unit {
    fn connect(&mut self) -> Result<(), Failed> {
        Ok(())
    }

    fn exchange(
        &mut self,
        outputs: &[Raw],
        write: &[bool],
        _: &mut [Result<Raw, Absent>],
        _: &mut [Option<String>],
    ) -> Result<(), Failed> {
        let mut seen = self.0.lock().expect("no test panics with it");
        seen.resize(outputs.len(), Raw::Whole(-1));
        let written = seen.iter_mut().zip(outputs).zip(write).filter(|(_, write)| **write);
        written.for_each(|((to, from), _)| *to = *from);
        Ok(())
    }

    fn close(&mut self) {}
}

/// A scan thread that has an error after some steps: when the test says so.
fn breaks(told: Arc<AtomicBool>) -> impl FnOnce(Controller, WallClock, Ends, &Stop) -> Controller + Send {
    move |mut controller, mut clock, mut ends, _| {
        loop {
            realtime::sleep_until(&mut clock, controller.due());
            while let Ok((_, command)) = ends.commands.pop() {
                controller.command(clock.now(), command).expect("it is stopped");
            }
            controller.step(clock.now());
            if told.load(Ordering::Acquire) {
                // A panic of which nobody reads on the terminal.
                std::panic::resume_unwind(Box::new("as the test wants it"));
            }
        }
    }
}

#[test]
fn row_18_outputs_are_safe_when_the_scan_panics() {
    let source = Source::new("chart.g7", CHART.as_bytes().to_vec(), 0);
    let (bench, problems) = build(&source, &g7_rig::Options::default()).expect("no plant");
    let bench = bench.unwrap_or_else(|| panic!("{problems:?}"));
    let (setup, problems) = setup::read(IO, FileId(1));
    let (wiring, wrong) = wire(&bench, &setup);
    assert!(problems.is_empty() && wrong.is_empty(), "{problems:?} {wrong:?}");
    let (mut times, count) = (Times::default(), trials(100, 3));
    for _ in 0..count {
        let (seen, told) = (Arc::new(Mutex::new(Vec::new())), Arc::new(AtomicBool::new(false)));
        let is =
            |valve, lamp| *seen.lock().expect("no test panics with it") == [Raw::Bit(valve), Raw::Bit(lamp)];
        let unit = |_: &_| Ok::<Box<dyn Device>, ()>(Box::new(Unit(Arc::clone(&seen))));
        let machine = assemble(runner(&bench, &wiring, 0), &wiring, unit).expect("a device");
        let options = Options { watchdog: Nanos::HOUR, priority: None };
        let scan = breaks(Arc::clone(&told));
        let mut running = begin::<RealDisk>(machine, None, options, scan).expect("threads");
        running.command(Command::Run);
        let wait = |is: &dyn Fn() -> bool| {
            let mut clock = WallClock::default();
            while !is() {
                assert!(clock.now() < Nanos::MINUTE, "it does not come");
                std::thread::sleep(Duration::from_millis(1));
            }
            Duration::from_nanos(clock.now().count().unsigned_abs())
        };
        wait(&|| is(true, false));
        assert!(running.is_alive());
        told.store(true, Ordering::Release);
        times.add(wait(&|| is(false, true)));
        wait(&|| !running.is_alive());
        assert!(running.end().is_none(), "there is no controller any more");
    }
    row(18, "the scan", count.into(), 0, format!("outputs safe after {times}; the program ends"));
}
