//! The time of day changes under a controller: its timers and its events do not notice.

use std::time::{Duration, Instant};

use g7_peers::faults::{row, trials};
use snapbox::cmd::cargo_bin;

use super::saved;
use crate::common::Folder;
use crate::common::talk::Running;

/// It leaves each step after 100 ms: `n` counts the times.
const TIMED: &str = "\
output lamp : BOOL
var n : LINT retain
chart Main {
  initial step 1 { N lamp  P1 n := n + 1 }
  step 2 { P1 n := n + 1 }
  1 -> 2 when 100ms/X1
  2 -> 1 when 100ms/X2
}
";

/// Times of day, one after the other: behind each the clock goes on from there.
const JUMPS: [&str; 9] = [
    // An hour on, and back.
    "@2026-03-01 13:00:00",
    "@2026-03-01 12:00:00",
    // Ten years on, and back beyond.
    "@2036-03-01 12:00:00",
    "@2016-03-01 12:00:00",
    // The second before a leap second, and the same second once more.
    "@2016-12-31 23:59:59",
    "@2016-12-31 23:59:59",
    // The last second of 32 bits passes.
    "@2038-01-19 03:14:07",
    "@1970-01-01 00:00:00",
    "@2026-03-01 12:00:01",
];

#[test]
fn row_6_timers_and_events_do_not_follow_the_time_of_day() {
    let Some(library) = g7_peers::faketime() else { return };
    let _alone = super::alone();
    let folder = Folder::with(TIMED);
    folder.write("chart.io.toml", "[controller]\nperiod = '10ms'\nretain = 'kept'\n");
    folder.write("time", "@2026-03-01 12:00:00");
    let mut command = std::process::Command::new(cargo_bin!("g7"));
    command.args(["run", "chart.g7", "--online"]).current_dir(folder.root());
    command.env("LD_PRELOAD", library).env("FAKETIME_TIMESTAMP_FILE", folder.path("time"));
    command.env("FAKETIME_NO_CACHE", "1").env("FAKETIME_DONT_FAKE_MONOTONIC", "1").env("TZ", "UTC");
    let outside = Instant::now();
    let mut g7 = Running::start(command, |child| Box::new(child.stderr.take().expect("piped")));
    g7.until("running");
    let inside = Instant::now();
    let mut stamps = Vec::new();
    let rounds = trials(10, 1);
    let jumps = JUMPS.iter().cycle().take(JUMPS.len() * rounds as usize);
    for (k, jump) in jumps.enumerate() {
        folder.write("time", jump);
        std::thread::sleep(Duration::from_millis(120));
        // Events, in this order.
        g7.say(&format!("force lamp := {} for 1h", ["TRUE", "FALSE"][k % 2]));
        stamps.push(stamp(&g7.until("forced")));
        g7.say("release lamp");
        stamps.push(stamp(&g7.until("no longer forced")));
    }
    let inside = inside.elapsed();
    g7.say("quit");
    let told = g7.rest();
    let outside = outside.elapsed();
    assert!(stamps.is_sorted(), "{stamps:?}");
    // `12 scans, 0 left out; …`
    let line = told.iter().find(|l| l.contains(" left out; ")).expect("it tells");
    let mut numbers = line.split(|c: char| !c.is_ascii_digit()).filter_map(|n| n.parse::<u64>().ok());
    let (scans, left_out) = (numbers.next().expect("scans"), numbers.next().expect("left out"));
    // The time of the controller, by its scans: not shorter than what this saw of it, and not longer than its life.
    let run = Duration::from_millis(10 * (scans + left_out));
    let scan = Duration::from_millis(10);
    assert!(inside <= run + scan && run <= outside + scan, "{inside:?} {run:?} {outside:?}");
    // A step of 100 ms lasts 10 or 11 scans; one that is left out may make it longer.
    let steps = saved(&folder.path("kept"));
    let (least, most) =
        (((scans + left_out) / (11 + left_out)).saturating_sub(1), (scans + left_out) / 10 + 1);
    assert!((least..=most).contains(&steps), "{steps} steps in {scans} scans, {left_out} left out");
    let count = JUMPS.len() as u64 * u64::from(rounds);
    let held = format!("{steps} steps of 100 ms in {run:?}, {left_out} scans left out; events in order");
    row(6, "±1 h, ±10 years, leap second, 2038, 1970", count, 0, held);
}

/// The time in front of an event.
fn stamp(line: &str) -> f64 {
    let time = line.trim_start().split('s').next().expect("a time");
    time.parse().unwrap_or_else(|e| panic!("{e}: {line}"))
}
