//! Days on end in simulated time: no scan too few or too many, and no memory that grows.

use g7_model::Nanos;
use g7_online::Command;
use g7_peers::faults::{many, row};
use g7_peers::process;

use crate::world::{CHART, IO, MS, Simulation};

#[test]
fn row_26_days_on_end_have_as_many_scans_as_periods() {
    let hours = if many() || std::env::var_os("G7_SEEDS").is_some() { 72 } else { 1 };
    let mut s = Simulation::new(CHART, IO);
    s.start();
    s.command(Command::Run);
    s.pass(MS * 10_000);
    let (before, scans) = (process::memory(std::process::id()), s.scans());
    let end = s.now + Nanos::HOUR * hours;
    let mut turns = 0;
    while s.now < end {
        // A press each minute; the device is away for three seconds each hour.
        s.set(|w| {
            w.go = !w.go;
            w.fault = if turns % 120 == 7 { crate::world::Fault::Gone } else { crate::world::Fault::None };
        });
        s.pass(MS * 3_000);
        s.set(|w| w.fault = crate::world::Fault::None);
        s.pass(MS * 27_000);
        s.modes.clear();
        turns += 1;
    }
    let made = s.scans() - scans;
    let wanted = (Nanos::HOUR * hours).count_of(MS * 10) as u64;
    assert!(made.abs_diff(wanted) <= 1, "{made} scans, {wanted} periods");
    assert_eq!(s.missed, 0);
    let (present, saved) = s.presses();
    assert_eq!((present, saved), ((turns / 2) & 0x7fff, present), "each press is counted and kept");
    let grown =
        process::memory(std::process::id()).zip(before).map_or(0, |(now, before)| now.saturating_sub(before));
    assert!(grown <= 1024, "{grown} KiB more than at the start");
    row(
        26,
        "simulated",
        made,
        0,
        format!("scans in {hours} simulated hours, {wanted} periods; {grown} KiB more memory"),
    );
}
