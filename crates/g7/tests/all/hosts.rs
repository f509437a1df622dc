//! `g7 prove` shared among processes: the answers of one, whatever is killed meanwhile; parts that together
//! are the whole; and what is said to options that cannot be honoured.
#![allow(missing_docs, reason = "a test")]
#![cfg(unix)]

use crate::common;

use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use common::Folder;
use serde_json::Value;

/// An even number of cells that run side by side; those of a pair exclude each other.
fn cells(count: usize) -> String {
    let names = |c| format!("a{c}, b{c}, c{c}");
    let all: Vec<String> = (0..count).map(names).collect();
    let mut text = format!("profile iec61131\nscan 10ms\ninput {} : BOOL\n", all.join(", "));
    for c in 0..count {
        let other = c ^ 1;
        text.push_str(&format!(
            "chart C{c} {{\n  initial step 1\n  step 2\n  step 3\n  1 -> 2 when a{c}\n  \
             2 -> 3 when b{c} and not C{other}.X3\n  3 -> 1 when c{c}\n}}\n"
        ));
    }
    let last = count - 1;
    text + &format!(
        "prove never C0.X3 and C1.X3\nprove reachable C0.X3 and C{last}.X2\nprove C0.X2 leads to C0.X3\n"
    )
}

/// The answers of a report, each with the number of scans of its run. The reason names how much was searched,
/// and the runs are the shortest ones of another order where one process divides a chart into parts.
fn answers(json: &str) -> Vec<(String, String, String, Option<usize>)> {
    let all: Value = serde_json::from_str(json).unwrap_or_else(|e| panic!("{e}: {json}"));
    let text = |v: &Value, key: &str| v[key].as_str().unwrap_or_default().to_owned();
    let one = |v: &Value| {
        (text(v, "place"), text(v, "claim"), text(v, "verdict"), v["run"].as_array().map(Vec::len))
    };
    all["answers"].as_array().expect("answers").iter().map(one).collect()
}

/// So many free addresses as a file of hosts.
fn hosts(folder: &Folder, count: usize) {
    let all: Vec<_> = (0..count).map(|_| TcpListener::bind("127.0.0.1:0").expect("a port")).collect();
    let lines: Vec<String> =
        all.iter().map(|l| format!("{}\n", l.local_addr().expect("an address"))).collect();
    folder.write("hosts", format!("# processes of a test\n\n{}", lines.concat()));
}

/// A process of the file of hosts.
fn start(folder: &Folder, number: usize, keep: &str) -> Child {
    let number = number.to_string();
    let args =
        ["prove", "chart.g7", "--format", "json", "--hosts", "hosts", "--keep", keep, "--process", &number];
    Command::new(snapbox::cmd::cargo_bin!("g7"))
        .args(args)
        .current_dir(folder.root())
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("g7 starts")
}

/// Waits for something that a process does, a minute at most.
fn until(what: &str, mut is_there: impl FnMut() -> bool) {
    let came = (0..60_000).any(|_| {
        let came = is_there();
        if !came {
            std::thread::sleep(Duration::from_millis(1));
        }
        came
    });
    assert!(came, "{what} did not come");
}

/// Levels of a search that a process has on disk.
fn levels(folder: &Path) -> usize {
    let list = std::fs::read_dir(folder).into_iter().flatten().flatten();
    list.filter(|e| e.file_name().to_string_lossy().contains("level")).count()
}

#[test]
fn workers_give_the_answers_of_one_process() {
    let folder = Folder::with(&cells(4));
    let alone = folder.g7(&["prove", "chart.g7", "--format", "json"]);
    alone.is(1);
    for count in ["1", "3"] {
        let shared = folder.g7(&["prove", "chart.g7", "--format", "json", "--workers", count]);
        assert!(shared.code == 1, "{}", shared.err);
        assert_eq!(answers(&shared.out), answers(&alone.out), "{count} workers");
    }
    assert_eq!(folder.names(), ["chart.g7"], "the levels are gone");
}

#[test]
fn a_process_that_is_killed_and_started_again_changes_no_answer() {
    let folder = Folder::with(&cells(6));
    let alone = folder.g7(&["prove", "chart.g7", "--format", "json"]);
    alone.is(1);
    hosts(&folder, 2);
    let mut killed = 0;
    for victim in [0, 1] {
        let keep = format!("kept-{victim}");
        let mut all = [start(&folder, 0, &keep), start(&folder, 1, &keep)];
        let own = folder.path(&format!("{keep}/process-{victim}"));
        // With some levels on disk; a search that is over before is no matter.
        until("4 levels", || levels(&own) >= 4 || all[victim].try_wait().expect("its state").is_some());
        if all[victim].try_wait().expect("its state").is_none() {
            all[victim].kill().expect("it runs");
            killed += 1;
            all[victim].wait().expect("it has ended");
            assert!(levels(&own) >= 4, "the levels stay");
            all[victim] = start(&folder, victim, &keep);
        }
        let [first, second] = all.map(|c| c.wait_with_output().expect("it ends"));
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        assert_eq!(first.status.code(), Some(1), "{}", text(&first.stderr));
        assert_eq!(second.status.code(), Some(0), "{}", text(&second.stderr));
        assert_eq!(answers(&text(&first.stdout)), answers(&alone.out), "{victim} was killed");
        assert!(text(&second.stdout).is_empty(), "process 0 prints the answers");
    }
    assert!(killed > 0, "the search was too quick to kill anything");
}

#[test]
fn parts_together_are_the_whole() {
    const FILES: usize = 3;
    let folder = Folder::new();
    folder.write("a.g7", cells(2));
    folder.write("b/b.g7", "profile iec61131\ninput a : BOOL\nchart G {\n  initial step 1\n  step 2\n  1 -> 2 when a\n}\nprove never X2\n");
    folder.write("c.g7", cells(2));
    let whole = folder.g7(&["prove", ".", "--format", "json"]);
    whole.is(1);
    for parts in [1, 2, 5] {
        let mut lines = Vec::new();
        let mut sizes = Vec::new();
        for i in 1..=parts {
            let part = folder.g7(&["prove", ".", "--shard", &format!("{i}/{parts}")]);
            assert!([0, 1, 3].contains(&part.code), "{}", part.err);
            sizes.push(part.out.lines().count());
            lines.extend(part.out.lines().map(str::to_owned));
        }
        let all = format!("{{\"answers\":[{}]}}", lines.join(","));
        let (mut found, mut expected) = (answers(&all), answers(&whole.out));
        found.sort();
        expected.sort();
        assert_eq!(found, expected, "{parts} parts");
        let (least, most) = (sizes.iter().min(), sizes.iter().max());
        assert!(most.zip(least).is_some_and(|(m, l)| m - l <= FILES), "{sizes:?}");
    }
}

#[test]
fn what_cannot_be_honoured_is_refused() {
    let folder = Folder::with(&cells(2));
    folder.write("other.g7", cells(2));
    let told = |args: &[&str], word: &str| {
        let ran = folder.g7(&[&["prove"], args].concat());
        assert!(ran.code == 2 && ran.err.contains(word), "{args:?}: {} {}", ran.code, ran.err);
    };
    told(&["chart.g7", "--workers", "0"], "0 is not in 1..=256");
    told(&["chart.g7", "--workers", "2", "--plant", "P"], "cannot be used with");
    told(&["chart.g7", "--workers", "2", "--tests", "t.g7"], "cannot be used with");
    told(&["chart.g7", "--workers", "2", "--shard", "1/2"], "cannot be used with");
    told(&[".", "--workers", "2"], "one chart, and there are 2");
    told(&["-", "--workers", "2"], "standard input");
    told(&["chart.g7", "--keep", "k"], "--workers or --hosts");
    told(&["chart.g7", "--process", "0"], "--hosts");
    told(&["chart.g7", "--shard", "3/2"], "I from 1 to N");
    told(&["chart.g7", "--shard", "1/2", "--format", "sarif"], "lines of JSON");
    told(&["chart.g7", "--shard", "1/2", "--format", "text"], "lines of JSON");
    told(&["chart.g7", "--hosts", "none", "--process", "0"], "none");
    folder.write("hosts", "127.0.0.1:4700\n  10.0.0.5\n");
    told(&["chart.g7", "--hosts", "hosts", "--process", "0"], "hosts:2:3: `10.0.0.5` is no `host:port`");
    hosts(&folder, 2);
    told(&["chart.g7", "--hosts", "hosts", "--process", "2"], "has 2 hosts");
    told(&["chart.g7", "--hosts", "hosts", "--workers", "3"], "has 2 hosts");
    told(&["chart.g7", "--hosts", "hosts"], "--process");
    let taken = TcpListener::bind("127.0.0.1:0").expect("a port");
    folder.write("hosts", format!("{}\n127.0.0.1:1\n", taken.local_addr().expect("an address")));
    told(&["chart.g7", "--hosts", "hosts", "--process", "0"], "another program has this port");
    hosts(&folder, 2);
    told(&["chart.g7", "--hosts", "hosts", "--process", "0", "--time", "1s"], "did not come");
}

#[test]
fn processes_with_other_charts_do_not_work_together() {
    let folder = Folder::with(&cells(2));
    hosts(&folder, 2);
    let mut first = start(&folder, 0, "kept");
    // It has read its chart by the time it keeps a folder.
    until("its folder", || {
        assert_eq!(first.try_wait().expect("it can be asked"), None, "it waits for the other");
        folder.path("kept/process-0/search").exists()
    });
    folder.write("chart.g7", cells(2).replacen("prove never", "prove always", 1));
    let second = start(&folder, 1, "kept");
    for ran in [first, second].map(|c| c.wait_with_output().expect("it ends")) {
        let text = String::from_utf8_lossy(&ran.stderr).into_owned();
        assert!(ran.status.code() == Some(2) && text.contains("another chart, or other options"), "{text}");
    }
}
