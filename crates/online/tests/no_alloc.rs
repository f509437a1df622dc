//! A step of the controller allocates nothing: with values and events of a device, with values that are
//! kept, forced ones, commands, and a plant in place of other devices.
#![allow(unsafe_code, reason = "counting allocations needs a GlobalAlloc")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use g7_model::{FileId, Nanos};
use g7_online::{Absent, Command, Device, Disk, Failed, Raw, Slots, assemble, runner, setup, wire};
use g7_rig::{Options, Source, build};

struct Counting;

thread_local! {
    static COUNT: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: forwards to `System`, which upholds the contract.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.with(|c| c.set(c.get() + 1));
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, ptr: *mut u8, layout: Layout) {
        unsafe { System.dealloc(ptr, layout) }
    }
    unsafe fn realloc(&self, ptr: *mut u8, layout: Layout, new: usize) -> *mut u8 {
        COUNT.with(|c| c.set(c.get() + 1));
        unsafe { System.realloc(ptr, layout, new) }
    }
}

#[global_allocator]
static ALLOC: Counting = Counting;

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
fn a_step_allocates_nothing() {
    let text = include_str!("../../../examples/bead-sorter/chart.g7")
        .replace("var Sort : BOOL", "var Kept : INT retain\nvar Sort : BOOL");
    let source = Source::new("chart.g7", text.into_bytes(), 0);
    let (bench, problems) = build(&source, &Options::default()).expect("it has one plant");
    let bench = bench.unwrap_or_else(|| panic!("{problems:?}"));
    let (setup, problems) = setup::read(IO, FileId(1));
    let (wiring, wrong) = wire(&bench, &setup);
    assert!(problems.is_empty() && wrong.is_empty(), "{problems:?} {wrong:?}");
    let mut run = runner(&bench, &wiring, 0);
    let led = bench.item("LED").expect("an output");
    bench.force(&mut run, led, &g7_host::Value::Word(1));
    let device = |_: &_| Ok::<Box<dyn Device>, std::io::Error>(Box::new(Unit(0)));
    let mut machine = assemble(run, &wiring, device).expect("no device fails");
    let slots = Slots::begin(Nowhere, 0, 0).expect("the disk takes all");
    let _kept = machine.keep(&bench, slots);
    let period = machine.controller.runner().period();
    let (mut now, mut allocating, mut events) = (Nanos::ZERO, 0, 0);
    for k in 0..20_000 {
        now += period;
        let driver = &mut machine.drivers[0];
        let worked = driver.work(now, &mut |_| {});
        driver.settle(now, worked, &mut |_| {});
        let before = COUNT.get();
        match k % 1000 {
            0 => machine.controller.command(now, Command::Run),
            // Late by several periods.
            700 => now += period * 5,
            900 => machine.controller.command(now, Command::Stop),
            _ => {}
        }
        machine.controller.step(now);
        allocating += usize::from(COUNT.get() > before);
        while machine.events.pop().is_ok() {
            events += 1;
        }
    }
    assert!(events > 20 && machine.controller.runner().state().scans() > 10_000, "{events} events");
    assert_eq!(allocating, 0, "steps that allocate");
}
