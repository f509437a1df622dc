//! The history of a controller: what it recorded is listed and exported, over starts and over clocks of the
//! wall that jump.
#![allow(clippy::disallowed_methods, reason = "programs run beside each other, in real time")]

use crate::common;

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use common::Folder;
use serde_json::Value;

/// Step 2 lasts 100 ms, step 1 as long, and each step 3 is one scan.
const CHART: &str = "\
profile iec61131
output lamp : BOOL
var `a, b` : REAL
var n : INT
chart Main {
  initial step 1
  step 2 { N lamp  P1 n := n + 1  P1 `a, b` := `a, b` + 0.25 }
  step 3
  1 -> 2 when 100ms/X1
  2 -> 3 when 100ms/X2
  3 -> 1 when TRUE
}
plant Hall { state x : REAL := 0.0 }
";
const IO: &str = "[history]\nfile = 'hall.history'\nsignals = ['lamp', 'n', 'a, b', 'X2', 'X3']\n";
/// Longer than anything takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

fn folder() -> Folder {
    let folder = Folder::with(CHART);
    folder.write("chart.io.toml", IO);
    folder
}

/// Rows of CSV: time of day, time of the record in s, signal, value.
fn rows(folder: &Folder, args: &[&str]) -> Vec<(String, f64, String, String)> {
    let ran = folder.g7(&[&["history", "hall.history", "--csv", "-"], args].concat());
    assert_eq!(ran.code, 0, "{}", ran.err);
    let mut lines = ran.out.lines();
    assert_eq!(lines.next(), Some("time,record,signal,value"));
    let row = |line: &str| {
        let line = line.replace("\"a, b\"", "ab");
        let cells: Vec<&str> = line.split(',').collect();
        let [time, record, signal, value] = cells[..] else { panic!("{line}") };
        (time.to_owned(), record.parse().expect("seconds"), signal.to_owned(), value.to_owned())
    };
    lines.map(row).collect()
}

fn run(folder: &Folder, time: &str) {
    let ran = folder.g7(&["run", "chart.g7", "--online", "--simulate", "--for", time]);
    assert_eq!(ran.code, 0, "{}", ran.err);
}

#[test]
fn what_a_controller_did_is_in_its_history_over_two_starts() {
    let folder = folder();
    run(&folder, "2s");
    let first = rows(&folder, &[]);
    let of = |rows: &[(String, f64, String, String)], name: &str| -> Vec<(f64, String)> {
        rows.iter().filter(|row| row.2 == name).map(|row| (row.1, row.3.clone())).collect()
    };
    assert!(first.windows(2).all(|two| two[0].1 <= two[1].1), "in the order of time");
    let lamp = of(&first, "lamp");
    assert!(lamp.len() >= 5, "{lamp:?}");
    assert_eq!((lamp[0].1.as_str(), lamp[1].1.as_str()), ("0", "1"));
    assert!(lamp.windows(2).all(|two| two[0].1 != two[1].1), "edges alone: {lamp:?}");
    let values: Vec<String> = of(&first, "n").into_iter().map(|(_, n)| n).collect();
    let counted: Vec<String> = (0..values.len()).map(|k| k.to_string()).collect();
    assert_eq!(values, counted);
    let real: Vec<String> = of(&first, "ab").into_iter().map(|(_, x)| x).collect();
    assert_eq!(real[1..3], ["0.25", "0.5"]);
    // A step of one scan is there with both of its edges.
    let short = of(&first, "X3");
    assert!(short.iter().filter(|(_, on)| on == "1").count() >= 2, "{short:?}");

    run(&folder, "1s");
    let both = rows(&folder, &[]);
    // A signal that changed in the last scan changes and ends at the same time.
    let (gap, known): (Vec<_>, Vec<_>) = both.iter().cloned().partition(|row| row.3.is_empty());
    assert_eq!(known[..first.len()], first, "what was there stays");
    // Between the two runs nothing is known.
    assert_eq!(gap.len(), 5, "one end for each signal: {gap:?}");
    let (last, next) = (&known[first.len() - 1], &known[first.len()]);
    assert!(gap.iter().all(|end| last.1 <= end.1 && end.1 < next.1), "{last:?}, {gap:?}, {next:?}");
    let only = rows(&folder, &["--signal", "lamp", "--from", "1s"]);
    assert!(!only.is_empty() && only.iter().all(|row| row.2 == "lamp"));
    let end = both[both.len() - 1].1;
    assert!(only.iter().all(|row| row.1 >= end - 1.5), "{only:?}");
    let none = rows(&folder, &["--from", "2020-01-01", "--to", "2020-01-02T03:04:05"]);
    assert_eq!(none, []);

    let listed = folder.g7(&["history", "hall.history"]);
    assert_eq!(listed.out.lines().filter(|line| line.contains(" to ")).count(), 2, "{}", listed.out);
    assert!(listed.out.contains("outputs    lamp  BOOL") && listed.out.contains("steps      X3  BOOL"));
    let dumped = folder.g7(&["history", "hall.history", "--vcd", "hall.vcd"]);
    assert_eq!(dumped.code, 0, "{}", dumped.err);
    let dump = folder.read("hall.vcd");
    assert!(dump.contains("$var wire 1 ! recorded $end") && dump.contains("lamp $end"), "{dump}");

    for (args, what) in [
        (&["history", "none"] as &[&str], "cannot read none: "),
        (&["history", "chart.g7"], "it is not a file of this kind"),
        (&["history", "hall.history", "--signal", "lump"], "the record has no signal `lump`"),
        (&["history", "hall.history", "--from", "soon"], "2026-11-25T10:00"),
    ] {
        let ran = folder.g7(args);
        assert!(ran.code == 2 && ran.err.contains(what), "{args:?}: {}", ran.err);
    }
    // A record that is none is left alone, before anything moves.
    folder.write("hall.history", vec![b'x'; 5000]);
    let ran = folder.g7(&["run", "chart.g7", "--online", "--simulate", "--for", "1s"]);
    assert!(ran.code == 2 && ran.err.contains("it is not a file of this kind"), "{}", ran.err);
    assert_eq!(folder.read("hall.history"), "x".repeat(5000));
}

#[test]
fn a_program_that_is_not_ours_reads_the_same_values_from_parquet() {
    let Some(python) = g7_peers::python("pyarrow") else { return };
    let folder = folder();
    run(&folder, "1s");
    let made = folder.g7(&["history", "hall.history", "--parquet", "hall.parquet"]);
    assert_eq!(made.code, 0, "{}", made.err);
    let script = "import pyarrow.parquet as p\n\
        t = p.read_table('hall.parquet')\n\
        assert str(t.schema.field('time').type) == 'timestamp[us, tz=UTC]', t.schema\n\
        for r in t.to_pylist():\n\
        \x20   print(r['time'].strftime('%Y-%m-%dT%H:%M:%S.%f'), r['record'], r['signal'], r['value'], r['whole'], sep='|')\n";
    let told =
        Command::new(python).args(["-c", script]).current_dir(folder.root()).output().expect("it runs");
    assert!(told.status.success(), "{}", String::from_utf8_lossy(&told.stderr));
    let told = String::from_utf8_lossy(&told.stdout).into_owned();
    let csv = rows(&folder, &[]);
    assert_eq!(told.lines().count(), csv.len());
    assert!(csv.len() > 10);
    for (line, (time, record, signal, value)) in told.lines().zip(&csv) {
        let cells: Vec<&str> = line.split('|').collect();
        let plain =
            |time: &str| time.trim_end_matches('Z').trim_end_matches('0').trim_end_matches('.').to_owned();
        assert_eq!(plain(cells[0]), plain(time), "{line}");
        assert_eq!(cells[1], format!("{:.0}", record * 1e6));
        assert_eq!(cells[2].replace("a, b", "ab"), *signal);
        assert_eq!(cells[3].parse::<f64>().ok(), value.parse::<f64>().ok(), "{line}");
        let whole = if signal == "ab" { None } else { value.parse::<i64>().ok() };
        assert_eq!(cells[4].parse::<i64>().ok(), whole, "{line}");
    }
}

/// The clock of the wall goes forward by ten years, back by twenty, and by an hour: no step lasts shorter or
/// longer for it, and the record keeps its order.
#[test]
fn a_clock_of_the_wall_that_jumps_moves_neither_timers_nor_the_record() {
    let Some(library) = g7_peers::faketime() else { return };
    let folder = folder();
    let shift = |by: &str| folder.write("shift", by);
    shift("+0");
    let mut child = Command::new(env!("CARGO_BIN_EXE_g7"))
        .args(["run", "chart.g7", "--online", "--simulate"])
        .current_dir(folder.root())
        .env("LD_PRELOAD", library)
        .env("FAKETIME_TIMESTAMP_FILE", folder.path("shift"))
        .env("FAKETIME_NO_CACHE", "1")
        .env("FAKETIME_DONT_FAKE_MONOTONIC", "1")
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("g7 run");
    for by in ["+0", "+3650d", "-3650d", "+1h", "-1h"] {
        shift(by);
        std::thread::sleep(Duration::from_millis(1_400));
    }
    child.stdin.take().expect("piped").write_all(b"quit\n").expect("it listens");
    wait(&mut child);
    let rows = rows(&folder, &["--signal", "X2"]);
    assert!(rows.len() > 10, "{rows:?}");
    assert!(rows.windows(2).all(|two| two[0].1 <= two[1].1), "in the order of time: {rows:?}");
    assert!(rows.windows(2).all(|two| two[0].3 != two[1].3), "no edge is lost: {rows:?}");
    // Behind the first edge each lasts 100 ms; a machine that is busy may take longer, but not an hour.
    for two in rows[1..rows.len() - 1].windows(2) {
        let lasted = two[1].1 - two[0].1;
        assert!((0.08..600.0).contains(&lasted), "{two:?}");
    }
    let mut years: Vec<&str> = rows.iter().map(|row| &row.0[..4]).collect();
    years.dedup();
    assert!(years.len() >= 4, "the time of day is that of the wall: {years:?}");
}

fn wait(child: &mut Child) {
    let until = Instant::now() + PATIENCE;
    while child.try_wait().expect("it is ours").is_none() {
        assert!(Instant::now() < until, "it does not end");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// `g7 serve --online` at work.
struct Station {
    child: Child,
    host: String,
    token: String,
}

impl Drop for Station {
    fn drop(&mut self) {
        self.child.kill().ok();
        self.child.wait().ok();
    }
}

impl Station {
    fn new(folder: &Folder) -> Station {
        let mut command = Command::new(env!("CARGO_BIN_EXE_g7"));
        command.args(["serve", "chart.g7", "--online", "--simulate", "--no-open", "--port", "0"]);
        command.current_dir(folder.root()).env("XDG_STATE_HOME", folder.path(".state"));
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut child = command.spawn().expect("g7 serve");
        let mut line = String::new();
        BufReader::new(child.stdout.take().expect("piped")).read_line(&mut line).expect("an address");
        let address = line.trim().strip_prefix("http://").unwrap_or_else(|| panic!("an address: {line}"));
        let (host, token) = address.split_once("/operator?token=").expect("the page of the operator");
        Station { child, host: host.to_owned(), token: token.to_owned() }
    }

    /// Status and body.
    fn get(&self, path: &str, token: &str) -> (u16, String) {
        let mut stream = TcpStream::connect(&self.host).expect("a connection");
        stream.set_read_timeout(Some(PATIENCE)).expect("a limit");
        let host = &self.host;
        let head = format!(
            "GET {path} HTTP/1.1\r\nHost: {host}\r\nAuthorization: Bearer {token}\r\nConnection: close\r\n\r\n"
        );
        stream.write_all(head.as_bytes()).expect("sent");
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).expect("an answer");
        let answer = String::from_utf8_lossy(&answer).into_owned();
        let status = answer.split(' ').nth(1).and_then(|s| s.parse().ok()).expect("a status");
        let (_, body) = answer.split_once("\r\n\r\n").expect("a body");
        (status, body.to_owned())
    }

    fn json(&self, path: &str) -> Value {
        let (status, body) = self.get(path, &self.token);
        assert_eq!(status, 200, "{path}: {body}");
        serde_json::from_str(&body).unwrap_or_else(|e| panic!("{e}: {body}"))
    }
}

#[test]
fn two_controllers_do_not_write_the_same_files() {
    for (io, file) in [(IO, "hall.history"), ("[controller]\nretain = 'hall.values'\n", "hall.values")] {
        let folder = folder();
        folder.write("chart.io.toml", io);
        let station = Station::new(&folder);
        let again = ["run", "chart.g7", "--online", "--simulate", "--for", "1s"];
        let refused = folder.g7(&again);
        assert_eq!(refused.code, 2, "{}", refused.err);
        let says = format!("{file}: another controller uses it");
        assert!(refused.err.contains(&says), "{}", refused.err);
        assert_eq!(station.get("/operator", &station.token).0, 200, "the first goes on");
        // A controller that was killed leaves the files free.
        drop(station);
        let ran = folder.g7(&again);
        assert_eq!(ran.code, 0, "{}", ran.err);
    }
}

#[test]
fn the_page_gets_lanes_and_files_of_the_record_that_is_being_written() {
    let folder = folder();
    let station = Station::new(&folder);
    assert_eq!(station.get("/api/history", "guess").0, 401);
    let until = Instant::now() + PATIENCE;
    let told = loop {
        let (status, body) = station.get("/api/history", &station.token);
        let told: Value = serde_json::from_str(&body).unwrap_or_default();
        if status == 200 && told["until"].as_f64() > Some(1500.0) {
            break told;
        }
        assert!(Instant::now() < until, "{status} {body}");
        std::thread::sleep(Duration::from_millis(50));
    };
    let signals = told["signals"].as_array().expect("signals");
    let id = |name: &str| {
        let found = signals.iter().find(|s| s["name"] == name).unwrap_or_else(|| panic!("{name}: {told}"));
        found["id"].to_string()
    };
    let (lamp, real) = (id("lamp"), id("a, b"));
    let lanes =
        station.json(&format!("/api/history/lanes?signals={real},{lamp}&from=0&to=1500&columns=1500"));
    let edges = lanes["lanes"][1]["pieces"].as_array().expect("pieces");
    assert!(edges.len() >= 3, "{lanes}");
    for (k, edge) in edges.iter().enumerate() {
        assert_eq!(edge[1].as_f64(), Some((k % 2) as f64), "{lanes}");
    }
    assert_eq!(lanes["lanes"][0]["pieces"][1][1].as_f64(), Some(0.25), "{lanes}");
    assert_eq!(lanes["spans"].as_array().map(Vec::len), Some(1));
    // In one column there is a summary.
    let one = station.json(&format!("/api/history/lanes?signals={lamp}&from=0&to=1500&columns=1"));
    let piece = &one["lanes"][0]["pieces"][0];
    assert_eq!((piece[3].as_f64(), piece[4].as_f64()), (Some(0.0), Some(1.0)), "{one}");
    let (status, csv) =
        station.get(&format!("/api/history/export?as=csv&signals={lamp}&from=0&to=1500"), &station.token);
    assert!(status == 200 && csv.contains("time,record,signal,value\n"), "{csv}");
    let (status, file) =
        station.get(&format!("/api/history/export?as=parquet&signals={lamp}&from=0&to=1500"), &station.token);
    assert!(status == 400 || status == 200 && file.starts_with("PAR1"), "{status}");
    for wrong in [
        "lanes?signals=99&from=0&to=1",
        "lanes?signals=x&from=0&to=1",
        "export?as=doc&signals=&from=0&to=1",
        "lanes?signals=1&from=a&to=1",
    ] {
        let (status, body) = station.get(&format!("/api/history/{wrong}"), &station.token);
        assert_eq!(status, 400, "{wrong}: {body}");
    }
}
