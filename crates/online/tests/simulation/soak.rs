//! Days on end in simulated time: no scan too few or too many, and no memory that grows.

use g7_model::Nanos;
use g7_online::Command;
use g7_peers::faults::{many, row};
use g7_peers::process;

use crate::clock;
use crate::world::{CHART, Fault, IO, MS, Simulation};

/// Presses are counted up to this number.
const MANY: u64 = 30_000;

/// Days on end at a scan of so many ms; a device is asked at every second scan.
fn days(scan: i64, hours: i64) {
    // The number of presses of a year is beyond an INT.
    let chart = CHART.replace("presses + 1", &format!("(presses + 1) mod {MANY}"));
    let chart = chart.replace("input go", &format!("scan {scan}ms\ninput go"));
    let io = IO.replace("poll = '20ms'", &format!("poll = '{}ms'", 2 * scan));
    let mut s = Simulation::new(&chart, &io);
    s.start();
    s.command(Command::Run);
    s.pass(MS * 10_000);
    let (before, scans) = (process::memory(std::process::id()), s.scans());
    let (end, begin) = (s.now + Nanos::HOUR * hours, clock());
    let mut turns = 0;
    while s.now < end {
        // A press each minute; the device is away for three seconds each hour.
        s.set(|w| {
            w.go = !w.go;
            w.fault = if turns % 120 == 7 { Fault::Gone } else { Fault::None };
        });
        s.pass(MS * 3_000);
        s.set(|w| w.fault = Fault::None);
        s.pass(MS * 27_000);
        s.modes.clear();
        turns += 1;
    }
    let a_minute = hours as f64 * 60.0 / begin.elapsed().as_secs_f64();
    let made = s.scans() - scans;
    let wanted = (Nanos::HOUR * hours).count_of(MS * scan) as u64;
    assert!(made.abs_diff(wanted) <= 1, "{made} scans, {wanted} periods");
    assert_eq!(s.missed, 0);
    let (present, saved) = s.presses();
    assert_eq!((present, saved), ((turns / 2) % MANY, present), "each press is counted and kept");
    let grown =
        process::memory(std::process::id()).zip(before).map_or(0, |(now, before)| now.saturating_sub(before));
    assert!(grown <= 1024, "{grown} KiB more than at the start");
    let held = format!(
        "scans in {hours} simulated hours, {wanted} periods; {grown} KiB more memory; {a_minute:.0} hours a minute"
    );
    row(26, &format!("simulated, {scan} ms"), made, 0, held);
}

fn is_long() -> bool {
    many() || std::env::var_os("G7_SEEDS").is_some()
}

#[test]
fn row_26_days_on_end_have_as_many_scans_as_periods() {
    days(10, if is_long() { 72 } else { 1 });
}

#[test]
fn row_26_a_year_of_a_slower_scan_has_as_many_scans_as_periods() {
    days(100, if is_long() { 365 * 24 } else { 4 });
}
