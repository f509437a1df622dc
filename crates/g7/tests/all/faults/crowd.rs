//! Very many pages before a controller, some of which have stopped to read.

use std::collections::{BTreeMap, VecDeque};
use std::fs::File;
use std::io::{BufRead as _, BufReader, Write as _};
use std::net::TcpStream;
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

/// Longer than the longest look at the pages, which is five minutes.
const PATIENCE: Duration = Duration::from_secs(420);

/// Serves the chart on line; returns the address of the operator's page without `http://`. The events go to the
/// file `events`.
fn serve(folder: &Folder) -> (Running, String) {
    let priority = if many() { "priority = 80\n" } else { "" };
    folder.write("chart.io.toml", format!("[controller]\nperiod = '10ms'\n{priority}"));
    let mut command = Command::new(cargo_bin!("g7"));
    command.args(["serve", "chart.g7", "--online", "--no-open", "--port", "0"]);
    // The events go to a file; the address comes through the pipe.
    let mut shell = Command::new("sh");
    shell.args(["-c", "exec \"$0\" \"$@\" 2>events"]).arg(command.get_program()).args(command.get_args());
    shell.current_dir(folder.root()).env("XDG_STATE_HOME", folder.path(".state"));
    File::create(folder.path("events")).expect("a file for the events");
    let mut g7 = Running::start(shell, |child| Box::new(child.stdout.take().expect("piped")));
    let address = g7.line().trim().trim_start_matches("http://").to_owned();
    (g7, address)
}

/// The scans of a controller that has ended, in its own words.
fn scans(folder: &Folder) -> String {
    let told = folder.read("events");
    let of = |what: &str| told.lines().find(|l| l.contains(what)).expect("it tells").to_owned();
    let late = of("scans were late: ").replace("scans were late: ", "");
    let count = of(" left out; ");
    format!("{}; scans late: {late}", count.split(';').next().unwrap_or_default())
}

#[test]
fn row_22_a_storm_of_connections_is_refused_while_the_scan_goes_on() {
    let folder = Folder::with(BLINKER);
    let (g7, address) = serve(&folder);
    let host = address.split('/').next().expect("an address");
    let before = memory(g7.pid()).unwrap_or(0);
    let (begin, seconds) = (Instant::now(), if many() { 600 } else { 1 });
    let (mut connections, mut most, mut answers) = (0, before, BTreeMap::<String, u64>::new());
    // Heads that never end, some at a time.
    let mut slow: VecDeque<TcpStream> = VecDeque::new();
    while begin.elapsed() < Duration::from_secs(seconds) {
        connections += 1;
        // The queue of the system may be full for a moment.
        let Ok(mut stream) = TcpStream::connect(host) else { continue };
        if connections % 100 == 0 {
            most = most.max(memory(g7.pid()).unwrap_or(0));
            stream.set_read_timeout(Some(Duration::from_secs(20))).expect("set");
            let head = format!(
                "PUT /api/file?path=chart.g7 HTTP/1.1\r\nHost: {host}\r\nContent-Length: 99999999999\r\n\r\n"
            );
            let mut answer = String::new();
            // A connection that is refused at once may be reset while the head is on its way.
            let sent = stream
                .write_all(head.as_bytes())
                .and_then(|()| BufReader::new(stream).read_line(&mut answer));
            let status = answer.split(' ').nth(1).filter(|_| sent.is_ok()).unwrap_or("reset");
            *answers.entry(status.to_owned()).or_default() += 1;
        } else if connections % 10 == 0 && stream.write_all(b"GET / HTTP/1.1\r\nHost: ").is_ok() {
            slow.push_back(stream);
            slow.drain(..slow.len().saturating_sub(500));
        }
    }
    let rate = connections as f64 / begin.elapsed().as_secs_f64();
    drop(slow);
    assert!(!answers.keys().any(|status| status.starts_with('2')), "a giant is never taken: {answers:?}");
    assert!(most - before <= 50 << 10, "{} KiB more", most - before);
    assert_eq!(g7.quit(), 0);
    let held = format!("{rate:.0} a second, giants hear {answers:?}; {}", scans(&folder));
    row(22, "a storm before a controller", connections, 0, held);
}

#[test]
fn row_21_pages_that_stop_reading_are_let_go_and_scans_do_not_notice() {
    let (readers, mute) = if many() { (800, 200) } else { (40, 10) };
    let folder = Folder::with(BLINKER);
    let (g7, address) = serve(&folder);
    let (host, token) = address.split_once("/operator?token=").expect("an address");
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
    let held = format!(
        "all in after {entered:.1?}, {mute} that stopped are out after {gone:.1?} more, {rate:.1} frames a second \
         each, {:.1} MB more memory; {}",
        (most - before) as f64 / 1024.0,
        scans(&folder)
    );
    row(21, &format!("{} pages, {mute} of them stopped", readers + mute), readers + mute, 0, held);
}
