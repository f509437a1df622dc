//! `g7 why`: runs that are made, traces and records, and what is refused; what a failed test tells.
#![allow(missing_docs, reason = "a test")]

use crate::common;

use common::{Folder, PINGPONG};

/// `a` is true from 20 ms to 30 ms.
const SET: [&str; 4] = ["--set", "a=1@20ms", "--set", "a=0@30ms"];

/// Why `m` is TRUE at 20 ms.
const ANSWER: &str = "\
`m` became TRUE at 20ms
  ← the action N of step `2` acts on it
    ← step `2` became active at 20ms
      ← the transition `1 -> 2` cleared at 20ms
        ← the input `a` became TRUE at 20ms
        · step `1` became active at 0s
";

fn traced() -> Folder {
    let folder = Folder::with(PINGPONG);
    folder.g7(&[&["run", "--headless", "--for", "40ms", "--trace", "out.csv"][..], &SET].concat()).is(0);
    folder
}

#[test]
fn a_run_that_is_made_is_asked() {
    let folder = Folder::with(PINGPONG);
    let ran = folder.g7(&[&["why", ".", "m", "25ms"][..], &SET].concat());
    assert!(ran.is(0).out.starts_with(ANSWER), "{}", ran.out);
    // The places of its sentences are marked in the text.
    assert!(ran.out.contains("chart.g7:2:8"), "{}", ran.out);
    assert!(ran.out.contains("1 -> 2 when a"), "{}", ran.out);
    let waits = folder.g7(&[&["why", ".", "1 -> 2", "10ms"][..], &SET].concat());
    let expected =
        "the transition `1 -> 2` does not clear at 10ms\n  ← the input `a` is FALSE since the start\n";
    assert!(waits.is(0).out.starts_with(expected), "{}", waits.out);
    let scan = folder.g7(&[&["why", ".", "20ms"][..], &SET].concat());
    assert!(scan.is(0).out.starts_with("scan 3 at 20ms\n"), "{}", scan.out);
}

#[test]
fn a_trace_and_a_record_are_asked_like_the_run_itself() {
    let folder = traced();
    let trace = folder.g7(&["why", "out.csv", "m", "25ms"]);
    assert!(trace.is(0).out.starts_with(ANSWER), "{}", trace.out);
    folder.g7(&[&["run", "--headless", "--for", "40ms", "--record", "out.tape"][..], &SET].concat()).is(0);
    let record = folder.g7(&["why", "out.tape", "m", "25ms"]);
    assert!(record.is(0).out.starts_with(ANSWER), "{}", record.out);
}

#[test]
fn programs_get_the_same_tree() {
    let folder = traced();
    let ran = folder.g7(&["why", "out.csv", "m", "25ms", "--format", "json"]);
    let value: serde_json::Value = serde_json::from_str(&ran.is(0).out).expect("JSON");
    assert_eq!(value["what"], "`m` became TRUE at 20ms");
    assert_eq!((&value["kind"], &value["time_seconds"]), (&"variable".into(), &0.02.into()));
    assert_eq!(value["places"][0]["start"]["line"], 2);
    let end = &value["causes"][0]["causes"][0]["causes"][0]["causes"][0];
    assert_eq!((&end["kind"], &end["causes"]), (&"input".into(), &serde_json::json!([])));
}

#[test]
fn an_answer_is_told_in_french_and_portuguese() {
    let folder = traced();
    let french = folder.g7(&["why", "out.csv", "m", "25ms", "--lang", "fr"]);
    assert!(french.is(0).out.contains("l’entrée `a` a pris la valeur TRUE à 20ms"), "{}", french.out);
    let portuguese = folder.g7(&["why", "out.csv", "m", "25ms", "--lang", "pt"]);
    assert!(portuguese.is(0).out.contains("a entrada `a` tomou o valor TRUE em 20ms"), "{}", portuguese.out);
}

#[test]
fn names_and_times_that_are_not_there_are_refused() {
    let folder = traced();
    folder.g7(&["why", "out.csv", "mm", "25ms"]).is_refused(&["there is no `mm`", "is it `m`"]);
    folder.g7(&["why", "out.csv", "X3", "25ms"]).is_refused(&["there is no `X3`", "`X1`"]);
    folder.g7(&["why", "out.csv", "m", "50ms"]).is_refused(&["the run ends at 40ms, before 50ms"]);
    folder.g7(&["why", "out.csv", "m", "soon"]).is_refused(&["`soon`", "duration"]);
    folder.g7(&["why", "out.vcd", "m", "25ms"]).is_refused(&["out.vcd", ".csv"]);
    folder.g7(&["why", "out.csv", "m", "--for", "1s"]).is_refused(&["recorded"]);
}

#[test]
fn a_trace_that_is_damaged_or_another_one_is_refused_with_its_place() {
    let folder = traced();
    let whole = folder.read("out.csv");
    let refused = |text: &str, parts: &[&str]| {
        folder.write("out.csv", text);
        folder.g7(&["why", "out.csv", "m", "25ms"]).is_refused(parts);
    };
    // `m` is FALSE where the run that is made again has TRUE.
    refused(&whole.replace("0.02,1,1,1,0,1", "0.02,1,0,1,0,1"), &["line 3", "20ms", "`m` is `0`", "`1`"]);
    refused(whole.trim_end(), &["line 5", "cut off"]);
    refused(&whole.replace("0.03,0,0,1,1,0", "0.03,0,0,1"), &["line 4", "4 cells", "6"]);
    refused(&whole.replace("0.03,0", "0.01,0"), &["line 4", "does not grow"]);
    refused(&whole.replace("0.03,0", "0.025,0"), &["line 4", "--scan"]);
    refused(&whole.replace("0.02,1", "0.02,maybe"), &["line 3", "`a`", "BOOL"]);
    refused(&whole.replace("time,a", "time,b"), &["line 1", "`b`"]);
    refused(&whole.replace("time,", "t,"), &["line 1", "time"]);
    refused("", &["line 1"]);
}

#[test]
fn a_failed_test_says_why() {
    let folder = Folder::with(&format!("{PINGPONG}\ntest \"t\" {{ set a := TRUE  scan 2  expect not m }}"));
    let ran = folder.g7(&["test"]);
    let first = "  `m` became TRUE at 10ms\n    ← the action N of step `2` acts on it\n";
    assert!(ran.is(1).out.contains(first), "{}", ran.out);
    assert!(ran.out.contains("← the input `a` became TRUE at 10ms"), "{}", ran.out);
    let json = folder.g7(&["test", "--format", "json"]);
    let value: serde_json::Value = serde_json::from_str(&json.is(1).out).expect("JSON");
    assert_eq!(value["tests"][0]["failure"]["why"][0]["what"], "`m` became TRUE at 10ms");
}

#[test]
fn a_long_reason_of_a_failure_is_cut() {
    let chart = "\
input a : BOOL
output m : BOOL
chart G {
  initial step 1
  step 2
  step 3
  step 4 { N m }
  1 -> 2 when ↑a
  2 -> 3 when =1
  3 -> 4 when =1
  4 -> 1 when not a
}
";
    let folder = Folder::with(&format!("{chart}\ntest \"t\" {{ set a := TRUE  expect not m }}"));
    let ran = folder.g7(&["test"]);
    assert!(ran.is(1).out.contains("more causes"), "{}", ran.out);
    let lines = ran.out.lines().filter(|l| l.contains("became") || l.contains("← ")).count();
    assert_eq!(lines, 6, "{}", ran.out);
}

/// The claim of the author is asked by its names, one of every chart by the steps and transitions that break it.
#[test]
fn a_refuted_claim_tells_why() {
    let folder = Folder::with(&format!("{PINGPONG}prove never m\n"));
    let ran = folder.g7(&["prove", "chart.g7"]);
    let chain =
        ["`m` became TRUE at ", "← the action N of step `2` acts on it", "← step `2` became active at "];
    let chain =
        chain.into_iter().chain(["← the transition `1 -> 2` cleared at ", "← the input `a` became TRUE"]);
    let mut lines = ran.is(1).out.lines();
    for part in chain {
        assert!(lines.any(|line| line.contains(part)), "{part}:\n{}", ran.out);
    }
    let ran = folder.g7(&["prove", "chart.g7", "--format", "json"]);
    let all: serde_json::Value = serde_json::from_str(&ran.is(1).out).expect("JSON");
    let refuted = all["answers"].as_array().expect("a list").iter().find(|a| a["own"] == true);
    assert_eq!(refuted.expect("that of the author")["why"][0]["causes"][0]["kind"], "action");

    let both = PINGPONG.replace("2 -> 1", "step 3\n  1 -> 3 when a\n  3 -> 1 when not a\n  2 -> 1");
    let ran = Folder::with(&both).g7(&["prove", "chart.g7"]);
    let told = [
        "both are clearable at once: ",
        "  the transition `1 -> 2` cleared at ",
        "← the input `a` became TRUE at ",
    ];
    let mut lines = ran.is(1).out.lines();
    for part in told {
        assert!(lines.any(|line| line.contains(part)), "{part}:\n{}", ran.out);
    }
}
