//! A controller that runs on and on: no scan too few, no memory or descriptor more.

use std::time::{Duration, Instant};

use g7_peers::faults::{many, row};
use g7_peers::process::{descriptors, memory};

use super::COUNTER;
use crate::common::Folder;
use crate::common::talk::{Running, free_port};

#[test]
fn row_26_a_controller_that_runs_on_takes_no_more_of_the_machine() {
    let _alone = super::alone();
    let (folder, port) = (Folder::with(COUNTER), free_port());
    folder.write(
        "chart.io.toml",
        format!(
            "[controller]\nperiod = '10ms'\nretain = 'kept'\n[devices.panel]\nkind = 'modbus-server'\n\
             listen = '127.0.0.1:{port}'\n[outputs]\nlamp = 'panel.discrete(0)'\n"
        ),
    );
    let (warm, long) = if many() { (60, 600) } else { (1, 3) };
    let outside = Instant::now();
    let mut g7 = Running::online(&folder, &[]);
    g7.until("running");
    let inside = Instant::now();
    std::thread::sleep(Duration::from_secs(warm));
    let take = |g7: &Running| (memory(g7.pid()), descriptors(g7.pid()));
    let before = take(&g7);
    std::thread::sleep(Duration::from_secs(long));
    let after = take(&g7);
    let inside = inside.elapsed();
    g7.say("quit");
    let told = g7.rest();
    let outside = outside.elapsed();
    let line = told.iter().find(|l| l.contains(" left out; ")).expect("it tells");
    let mut numbers = line.split(|c: char| !c.is_ascii_digit()).filter_map(|n| n.parse::<u64>().ok());
    let (scans, left_out) = (numbers.next().expect("scans"), numbers.next().expect("left out"));
    // As many as the time between two instants within its life, and no more than its life.
    let (run, scan) = (Duration::from_millis(10 * (scans + left_out)), Duration::from_millis(10));
    assert!(inside <= run + scan && run <= outside + scan, "{inside:?} {run:?} {outside:?}");
    assert_eq!(before.1, after.1, "descriptors");
    let grown = after.0.zip(before.0).map_or(0, |(after, before)| after.saturating_sub(before));
    assert!(grown <= 1024, "{grown} KiB more");
    let held =
        format!("scans in {long} s and before, {left_out} left out; {grown} KiB more, descriptors as before");
    row(26, "a real controller", scans, 0, held);
}
