//! `g7 run` without the terminal view: traces, scripts, records, faults.
#![allow(missing_docs, reason = "a test")]

use crate::common;

use std::collections::BTreeMap;

use common::{Folder, PINGPONG};
use g7_model::Nanos;

/// `a` is true from 20 ms to 30 ms.
const SCRIPT: [&str; 8] = ["run", "--headless", "--for", "40ms", "--set", "a=1@20ms", "--set", "a=0@30ms"];

fn run(folder: &Folder, more: &[&str]) -> common::Ran {
    folder.g7(&[&SCRIPT[..], more].concat())
}

#[test]
fn a_csv_trace_has_a_row_for_each_change_and_the_end() {
    let folder = Folder::with(PINGPONG);
    run(&folder, &["--trace", "out.csv"]).is(0);
    let expected = "time,a,m,n,X1,X2\n\
                    0,0,0,0,1,0\n\
                    0.02,1,1,1,0,1\n\
                    0.03,0,0,1,1,0\n\
                    0.04,0,0,1,1,0\n";
    assert_eq!(folder.read("out.csv"), expected);
}

#[test]
fn a_vcd_trace_reads_back_as_the_same_run() {
    let folder = Folder::with(PINGPONG);
    run(&folder, &["--trace", "out.vcd"]).is(0);
    let text = folder.read("out.vcd");
    assert!(text.contains("$timescale 1 us $end"), "{text}");
    let (mut names, mut changes, mut now) = (BTreeMap::new(), BTreeMap::new(), 0);
    let mut scope = Vec::new();
    for line in text.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        match words[0] {
            "$scope" => scope.push(words[2]),
            "$upscope" => drop(scope.pop()),
            "$var" => drop(names.insert(words[3], format!("{}.{}", scope.join("."), words[4]))),
            w if w.starts_with('#') => now = w[1..].parse::<i64>().expect("a time"),
            w if w.starts_with('$') => {}
            w => {
                let (value, id) = if words.len() == 2 { (w, words[1]) } else { w.split_at(1) };
                changes.entry(names[id].clone()).or_insert_with(Vec::new).push((now, value.to_owned()));
            }
        }
    }
    let of = |name: &str| {
        let list: &Vec<(i64, String)> = &changes[name];
        list.iter().map(|(t, v)| (*t, v.as_str())).collect::<Vec<_>>()
    };
    assert_eq!(of("inputs.a"), [(0, "0"), (20_000, "1"), (30_000, "0")]);
    assert_eq!(of("outputs.m"), [(0, "0"), (20_000, "1"), (30_000, "0")]);
    assert_eq!(of("variables.n"), [(0, "b0"), (20_000, "b1")]);
    assert_eq!(of("steps.X1"), [(0, "1"), (20_000, "0"), (30_000, "1")]);
}

#[test]
fn the_chronogram_shows_what_moved_and_where_it_ended() {
    let folder = Folder::with(PINGPONG);
    let ran = run(&folder, &["--show", "m,n"]);
    let out = &ran.is(0).out;
    assert!(out.starts_with("./chart.g7: 40ms in 5 scans of 10ms, now in {1}\n"), "{out}");
    let lane = |name: &str| {
        let line = out.lines().find(|l| l.trim_start().starts_with(&format!("{name} "))).expect("a lane");
        line.trim_start().trim_start_matches(name).trim_start().to_owned()
    };
    let m = lane("m");
    assert!(m.starts_with('▁') && m.contains("╱▔") && m.contains("╲▁"), "{m}");
    assert!(lane("n").starts_with("0·") && lane("n").contains("│1·"), "{}", lane("n"));
    assert!(!out.contains("X1"), "only what was asked for");
}

#[test]
fn without_a_terminal_it_runs_headless() {
    let ran = Folder::with(PINGPONG).g7(&["run", "--for", "10ms"]);
    assert!(ran.is(0).err.contains("no terminal"), "{}", ran.err);
    assert!(ran.out.contains("now in {1}\n\nnothing moved"), "{}", ran.out);
}

#[test]
fn where_nothing_moved_it_says_how_to_set_a_free_input() {
    let still = |chart: &str| {
        let out = Folder::with(chart).g7(&["run", "--headless", "--for", "2s"]).is(0).out.clone();
        out.lines().last().unwrap_or_default().to_owned()
    };
    let chart = "chart G { initial step 1  step 2  1 -> 2 when a -> 1 when not a }";
    // Inputs that the plant drives are not suggested; a BOOL is preferred.
    let plant = "plant P { state x : REAL := 0.0  drive d := x > 1.0 }";
    let first = still(&format!("input d, a : BOOL  {chart} {plant}"));
    assert_eq!(first, "nothing moved; `--set a=1@1s` sets an input after 1s");
    let only = still("input t : TIME  chart G { initial step 1 }");
    assert_eq!(only, "nothing moved; `--set t=1s@1s` sets an input after 1s");
    let odd = still("input `push it` : INT  chart G { initial step 1 }");
    assert_eq!(odd, "nothing moved; `--set 'push it=1@1s'` sets an input after 1s");
    assert_eq!(still("chart G { initial step 1 }"), "nothing moved");
    // The suggested command works.
    let folder = Folder::with(&format!("input a : BOOL  {chart}"));
    let ran = folder.g7(&["run", "--headless", "--for", "2s", "--set", "a=1@1s"]);
    assert!(ran.is(0).out.contains("now in {2}"), "{}", ran.out);
}

#[test]
fn profile_and_scan_take_the_place_of_the_files_own() {
    let chart = "scan 5ms\ninput a : BOOL\nchart G {\n  initial step 1\n  step 2\n  step 3\n  \
                 1 -> 2 when a\n  2 -> 3 when a\n  3 -> 1 when not a\n}\n";
    let folder = Folder::with(chart);
    let at = |more: &[&str]| {
        let args = [&["run", "--headless", "--for", "20ms", "--set", "a=1@20ms"][..], more].concat();
        folder.g7(&args).is(0).out.clone()
    };
    assert!(at(&[]).contains("5 scans of 5ms, now in {3}"), "search for stability goes through 2");
    assert!(at(&["--profile", "iec61131"]).contains("now in {2}"), "one evolution a scan");
    assert!(at(&["--scan", "20ms"]).contains("2 scans of 20ms"));
}

const TANK: &str = "\
output fill : BOOL
input full : BOOL
chart G {
  initial step 1 {
    N fill
  }
  step 2
  1 -> 2 when full
  2 -> 1 when not full
}
plant Slow {
  state level : REAL := 0.0 in 0.0 .. 10.0
  rate level := 1.0 when fill
  drive full := level > 5.0
}
plant Fast {
  state level : REAL := 0.0 in 0.0 .. 10.0
  rate level := 100.0 when fill
  drive full := level > 5.0
}
";

#[test]
fn of_several_plants_one_is_chosen() {
    let folder = Folder::with(TANK);
    folder.g7(&["run", "--headless"]).is_refused(&["Slow, Fast", "--plant"]);
    folder.g7(&["run", "--headless", "--plant", "Big"]).is_refused(&["`Big`", "Slow, Fast"]);
    let now =
        |plant: &str| folder.g7(&["run", "--headless", "--for", "1s", "--plant", plant]).is(0).out.clone();
    assert!(now("Slow").contains("plant Slow: 1s in 101 scans of 10ms, now in {1}"));
    assert!(now("Fast").contains("now in {2}"));
    assert!(now("none").contains("chart.g7: 1s"));
}

#[test]
fn a_driven_input_that_is_set_is_held_and_a_state_is_put() {
    let folder = Folder::with(TANK);
    let now = |set: &str| {
        let args = ["run", "--headless", "--for", "1s", "--plant", "Slow", "--set", set];
        folder.g7(&args).is(0).out.clone()
    };
    assert!(now("full=1@10ms").contains("now in {2}"));
    assert!(now("level=6.5@10ms").contains("now in {2}"));
}

#[test]
fn a_script_sets_the_system_bits_of_pl7() {
    let folder = Folder::with(PINGPONG);
    let args = ["run", "--headless", "--for", "40ms", "--trace", "out.csv", "--profile", "pl7"];
    let bits = ["--set", "a=1@10ms", "--set", "a=0@30ms", "--set", "%S23=1@30ms", "--set", "%s21=1@40ms"];
    folder.g7(&[&args[..], &bits].concat()).is(0);
    let trace = folder.read("out.csv");
    let lines: Vec<&str> = trace.lines().collect();
    assert_eq!(lines[0], "time,a,m,n,%S0,%S21,%S22,%S23,X1,X2");
    assert_eq!(lines[lines.len() - 2..], ["0.03,0,1,1,0,0,0,1,0,1", "0.04,0,0,1,0,0,0,1,1,0"]);
    let refused = |set: &str, parts: &[&str]| {
        folder.g7(&["run", "--headless", "--profile", "pl7", "--set", set]).is_refused(parts);
    };
    refused("%S24=1", &["nothing at `%S24` can be set", "`%S21`"]);
    refused("%X2=1", &["`%X2` is the state of a step", "PRE sets"]);
    folder.g7(&["run", "--headless", "--set", "%S21=1"]).is_refused(&["`%S21`", "`profile pl7`"]);
}

#[test]
fn bad_scripts_are_refused_with_the_way_out() {
    let folder = Folder::with(PINGPONG);
    folder.g7(&["run", "--headless", "--set", "b=1"]).is_refused(&["no `b`"]);
    folder.g7(&["run", "--headless", "--set", "n=70000"]).is_refused(&["n:", "-32768 .. 32767"]);
    folder.g7(&["run", "--headless", "--set", "a=maybe"]).is_refused(&["TRUE or FALSE"]);
    folder.g7(&["run", "--headless", "--show", "zz"]).is_refused(&["no `zz`"]);
    folder.g7(&["run", "--headless", "--trace", "out.txt"]).is_refused(&[".csv or .vcd"]);
    folder
        .g7(&["run", "--headless", "--trace", "no/such/out.csv"])
        .is_refused(&["cannot write no/such/out.csv"]);
    assert!(folder.g7(&["run", "--headless", "--set", "a"]).is(2).err.contains("start=1@2s"));
    assert!(folder.g7(&["run", "--headless", "--for", "5"]).is(2).err.contains("2.5s"));
    assert_eq!(folder.names(), ["chart.g7"]);
}

#[test]
fn a_fault_ends_the_run_with_its_place_and_code_1() {
    let folder = Folder::with(
        "input a : BOOL\nvar n : INT := 32767\nchart G {\n  initial step 1\n  step 2 {\n    \
         P1 n := n + 1\n  }\n  1 -> 2 when a\n  2 -> 1 when not a\n}\n",
    );
    let ran = folder.g7(&["run", "--headless", "--set", "a=1@30ms", "--trace", "out.csv"]);
    assert!(ran.is(1).err.contains("chart.g7:6:"), "{}", ran.err);
    assert!(ran.err.contains("fault at 30ms: overflow"), "{}", ran.err);
    assert!(folder.read("out.csv").lines().last().is_some_and(|l| l.starts_with("0.03,")));
}

/// Two actions of one pass assign different values to `k`, each time `a` becomes true.
const CONFLICT: &str = "\
input a : BOOL
var k, i, j : INT
chart G {
  initial step 1
  step 2 {
    P1 k := i
  }
  step 3 {
    P1 k := j + 1
  }
  1 -> (2, 3) when a
  (2, 3) -> 1 when not a
}
";

#[test]
fn a_conflicting_assignment_is_told_once_a_run() {
    let folder = Folder::with(CONFLICT);
    let sets = ["--set", "a=1@10ms", "--set", "a=0@20ms", "--set", "a=1@30ms"];
    let ran = folder.g7(&[&["run", "--headless", "--for", "50ms"][..], &sets].concat());
    assert_eq!(ran.is(0).err.matches("conflicting assignment").count(), 1, "{}", ran.err);
    assert!(ran.err.contains("`k` different values at 10ms"), "{}", ran.err);
    folder.write("chart.g7", format!("{CONFLICT}\ntest \"t\" {{ pulse a pulse a }}"));
    let ran = folder.g7(&["test"]);
    assert_eq!(ran.is(0).out.matches("`k` different values").count(), 1, "{}", ran.out);
    let other = CONFLICT.replace("j + 1", "j");
    folder.write("chart.g7", format!("{other}\ntest \"t\" {{ pulse a }}"));
    assert!(!folder.g7(&["test"]).is(0).out.contains("note"), "the same value is no conflict");
}

#[test]
fn an_unstable_chart_names_its_cycle() {
    let folder = Folder::with(
        "input a : BOOL\nchart G {\n  initial step 1\n  step 2\n  1 -> 2 when a\n  2 -> 1 when a\n}\n",
    );
    let ran = folder.g7(&["run", "--headless", "--set", "a=1@10ms"]);
    let err = &ran.is(1).err;
    assert!(err.contains("unstable"), "{err}");
    assert!(err.contains("{1} -> {2}") || err.contains("{2} -> {1}"), "{err}");
}

#[test]
fn a_record_plays_back_and_another_chart_is_noticed() {
    let folder = Folder::with(PINGPONG);
    run(&folder, &["--record", "tape"]).is(0);
    let ran = folder.g7(&["run", "--replay", "tape", "--trace", "again.csv"]);
    assert_eq!(ran.is(0).out, "{1}\n");
    run(&folder, &["--trace", "first.csv"]).is(0);
    assert_eq!(folder.read("again.csv"), folder.read("first.csv"));
    folder.write("chart.g7", PINGPONG.replace("1 -> 2 when a", "1 -> 2 when not a"));
    assert!(folder.g7(&["run", "--replay", "tape"]).is(1).err.contains("scan 0"));
    folder.write("tape", "no tape");
    folder.g7(&["run", "--replay", "tape"]).is_refused(&["tape", "not a record"]);
}

#[test]
fn retained_variables_go_from_run_to_run_and_others_do_not() {
    let chart = PINGPONG
        .replace("var n : INT", "var n : INT retain\nvar k : INT")
        .replace("P1 n := n + 1", "P1 {\n      n := n + 1\n      k := k + 1\n    }");
    let folder = Folder::with(&chart);
    let last = || folder.read("out.csv").lines().last().expect("a row").to_owned();
    let more = ["--retain", "kept", "--trace", "out.csv"];
    run(&folder, &more).is(0);
    assert_eq!(last(), "0.04,0,0,1,1,1,0");
    run(&folder, &more).is(0);
    assert_eq!(last(), "0.04,0,0,2,1,1,0", "n goes on, k starts anew");
    folder.write("chart.g7", chart.replace("n : INT", "n : DINT"));
    run(&folder, &more).is_refused(&["kept", "other retained variables"]);
    folder.write("kept", "rubbish");
    run(&folder, &more).is_refused(&["kept", "damaged"]);
}

#[test]
fn the_same_seed_gives_the_same_run_and_another_another() {
    let folder = Folder::with(
        "input part : BOOL\nvar n : INT\nchart G {\n  initial step 1 {\n    on ↑part: n := n + 1\n  }\n}\n\
         plant P {\n  state near : BOOL\n  state left : TIME\n  \
         arrivals Parts every 100ms .. 900ms {\n    near := not near\n  }\n  drive part := near\n}\n",
    );
    let trace = |seed: &str, name: &str| {
        let args = ["run", "--headless", "--for", "20s", "--seed", seed, "--trace", name];
        folder.g7(&args).is(0);
        folder.read(name)
    };
    let (one, again, two) = (trace("1", "a.csv"), trace("1", "b.csv"), trace("2", "c.csv"));
    assert!(one == again, "the same seed");
    assert!(one != two, "another seed");
    assert!(one.lines().count() > 20, "parts arrive: {one}");
}

#[test]
fn a_run_that_is_cut_short_has_kept_what_it_had() {
    let chart =
        "var n : INT retain\nchart G {\n  initial step 1 {\n    each scan: n := (n + 1) mod 1000\n  }\n}\n";
    let folder = Folder::with(chart);
    let mut child = std::process::Command::new(snapbox::cmd::cargo_bin!("g7"))
        .args(["run", "--real-time", "--for", "1h", "--retain", "kept"])
        .current_dir(folder.root())
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::null())
        .spawn()
        .expect("it starts");
    let there = || folder.names().contains(&"kept".to_owned());
    for _ in 0..500 {
        if there() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    child.kill().expect("it is ended");
    child.wait().expect("it has ended");
    folder.g7(&["run", "--headless", "--for", "0s", "--retain", "kept", "--trace", "out.csv"]).is(0);
    let row = folder.read("out.csv");
    let n: i32 =
        row.lines().last().and_then(|l| l.split(',').nth(1)).and_then(|n| n.parse().ok()).expect("n");
    assert!(n > 50, "a second of scans were counted: {row}");
}

#[test]
fn real_time_takes_its_time() {
    let folder = Folder::with(PINGPONG);
    let start = g7_host::WallClock::default();
    folder.g7(&["run", "--for", "300ms", "--real-time"]).is(0);
    let mut clock = start;
    assert!(g7_host::Clock::now(&mut clock) >= Nanos::from_millis(300));
}
