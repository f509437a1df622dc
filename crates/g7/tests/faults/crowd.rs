//! Very many pages before a controller, some of which have stopped to read.

use std::fs::File;
use std::process::Command;
use std::time::{Duration, Instant};

use g7_peers::crowd::Crowd;
use g7_peers::faults::{many, row};
use g7_peers::process::{descriptors, memory};
use snapbox::cmd::cargo_bin;

use crate::common::Folder;
use crate::common::talk::Running;

/// A chart that always has something to show.
const BLINKER: &str = "\
output lamp : BOOL
var n : LINT
chart Main {
  initial step 1 { N lamp  each scan: n := n + 1 }
  step 2 { each scan: n := n + 1 }
  1 -> 2 when 100ms/X1
  2 -> 1 when 100ms/X2
}
";

const PATIENCE: Duration = Duration::from_secs(120);

#[test]
fn row_21_pages_that_stop_reading_are_let_go_and_scans_do_not_notice() {
    let (readers, mute) = if many() { (800, 200) } else { (40, 10) };
    let folder = Folder::with(BLINKER);
    let priority = if many() { "priority = 80\n" } else { "" };
    folder.write("chart.io.toml", format!("[controller]\nperiod = '10ms'\n{priority}"));
    let mut command = Command::new(cargo_bin!("g7"));
    command.args(["serve", "chart.g7", "--online", "--no-open", "--port", "0"]);
    command.current_dir(folder.root()).env("XDG_STATE_HOME", folder.path(".state"));
    // The events go to a file; the address comes through the pipe.
    let sh = "exec \"$0\" \"$@\" 2>events";
    let mut shell = Command::new("sh");
    shell.args(["-c", sh]).arg(command.get_program()).args(command.get_args());
    shell.current_dir(folder.root()).env("XDG_STATE_HOME", folder.path(".state"));
    File::create(folder.path("events")).expect("a file for the events");
    let mut g7 = Running::start(shell, |child| Box::new(child.stdout.take().expect("piped")));
    let address = g7.line();
    let (host, token) =
        address.trim().trim_start_matches("http://").split_once("/operator?token=").expect("an address");
    std::thread::sleep(Duration::from_millis(500));
    let (Some(before), Some(open)) = (memory(g7.pid()), descriptors(g7.pid())) else {
        return g7_peers::skip("the system does not tell what a process takes");
    };
    let host = host.parse().expect("an address");
    let (begin, mut most) = (Instant::now(), before);
    let crowd = Crowd::enter(host, token, readers, mute).expect("a thread");
    let mut wait = |what: &str, is: &mut dyn FnMut() -> bool| {
        let begin = Instant::now();
        while !is() {
            assert!(begin.elapsed() < PATIENCE, "{what}: {:?}, {:?}", crowd.entered(), descriptors(g7.pid()));
            std::thread::sleep(Duration::from_millis(20));
            most = most.max(memory(g7.pid()).unwrap_or(0));
        }
        begin.elapsed()
    };
    wait("all enter", &mut || crowd.entered().0 + crowd.entered().1 == readers + mute);
    let entered = begin.elapsed();
    assert_eq!(crowd.entered(), (readers + mute, 0), "all are let in");
    let gone = wait("those that never read are let go", &mut || {
        descriptors(g7.pid()).is_some_and(|now| now <= open + readers as usize)
    });
    let (frames, begin) = (crowd.frames(), Instant::now());
    let seconds = if many() { 300 } else { 1 };
    wait("frames for all", &mut || {
        crowd.frames() >= frames + 2 * readers && begin.elapsed() >= Duration::from_secs(seconds)
    });
    let rate = (crowd.frames() - frames) as f64 / readers as f64 / begin.elapsed().as_secs_f64();
    assert_eq!(crowd.closed(), 0, "who reads stays");
    assert!(most - before <= 50 << 10, "{} KiB more", most - before);
    drop(crowd);
    assert_eq!(g7.quit(), 0);
    let told = folder.read("events");
    let late = told.lines().find_map(|l| l.strip_prefix("scans were late: ")).expect("it tells");
    let held = format!(
        "all in after {entered:.1?}, {mute} that stopped are out after {gone:.1?} more, {rate:.1} frames a second \
         each, {:.1} MB more memory; scans late: {late}",
        (most - before) as f64 / 1024.0
    );
    row(21, &format!("{} pages, {mute} of them stopped", readers + mute), readers + mute, 0, held);
}
