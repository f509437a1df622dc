//! The controller and its drivers in simulated time, with devices that fail: the rules one by one here, any
//! course of faults in `courses.rs`, faults of the chart in `overrun.rs`, days on end in `soak.rs`.

#[path = "../common/mod.rs"]
mod common;
mod courses;
mod overrun;
mod soak;
mod world;

use std::sync::atomic::Ordering;

use g7_model::Nanos;
use g7_online::{Command, Mode, Raw, Reason, Target};

use world::{CHART, Fault, IO, MS, Simulation};

fn wrote(valve: bool, lamp: bool, count: i128) -> Vec<Raw> {
    vec![Raw::Bit(valve), Raw::Bit(lamp), Raw::Whole(count)]
}

/// The safe values of the chart.
fn safe() -> Vec<Raw> {
    wrote(false, true, -1)
}

/// The time that the machine takes is told, never judged.
#[allow(clippy::disallowed_methods, reason = "how fast the simulation is")]
fn clock() -> std::time::Instant {
    std::time::Instant::now()
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
