//! `g7 prove` as its pages in the book tell it, with what nobody would ask of it, and its reports for programs;
//! what `--compare` says behind an export and an import.
#![allow(missing_docs, reason = "a test")]
#![allow(clippy::disallowed_methods, reason = "the tests read the pages")]

use crate::common;

use std::path::{Path, PathBuf};

use common::{Folder, Ran};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The fenced blocks of a page, each with the words behind its fence.
fn blocks(page: &str) -> Vec<(String, String)> {
    let mut parts = page.split("```");
    parts.next();
    let mut found = Vec::new();
    while let (Some(block), Some(_)) = (parts.next(), parts.next()) {
        let (kind, text) = block.split_once('\n').expect("a line behind the fence");
        found.push((kind.trim().to_owned(), text.to_owned()));
    }
    found
}

/// Every line but `…` stands in the output, in this order.
#[track_caller]
fn shows(place: &str, wanted: &str, ran: &Ran) {
    let out = format!("{}{}", ran.out, ran.err);
    let mut lines = out.lines();
    for line in wanted.lines().filter(|l| *l != "…") {
        assert!(lines.any(|l| l.trim_end() == line.trim_end()), "{place}: `{line}` is not in:\n{out}");
    }
}

/// The claims of the author of a chart are proved, unless a note behind the claim says `refuted`.
#[track_caller]
fn claims(place: &str, chart: &str, ran: &Ran) {
    for (number, line) in (1..).zip(chart.lines()).filter(|(_, l)| l.starts_with("prove ")) {
        let verdict = if line.contains("// refuted") { "refuted" } else { "proved" };
        let answer = format!("chart.g7:{number}:1: {verdict}: ");
        assert!(ran.out.contains(&answer), "{place}: `{line}` is not {verdict}:\n{}{}", ran.out, ran.err);
    }
}

#[test]
fn the_pages_about_proofs_say_what_the_program_says() {
    let (mut asked, mut shown) = (0, 0);
    for page in ["index.md", "questions.md", "counterexample.md", "worked.md"] {
        let text = std::fs::read_to_string(root().join("docs/book/src/prove").join(page)).expect(page);
        let all = blocks(&text);
        for (k, (kind, chart)) in all.iter().enumerate() {
            let answer = all.get(k + 1).and_then(|(_, text)| text.strip_prefix("$ g7 prove chart.g7\n"));
            if kind != "g7" || answer.is_none() && !chart.contains("\nprove ") {
                continue;
            }
            let place = format!("{page}, block {}", k + 1);
            let folder = Folder::with(chart);
            let ran = folder.g7(&["prove", "chart.g7"]);
            claims(&place, chart, &ran);
            asked += 1;
            if let Some(answer) = answer {
                shows(&place, answer, &ran);
                shown += 1;
            }
        }
    }
    assert!(asked >= 18 && shown >= 15, "{asked} charts asked, {shown} answers shown");
}

#[test]
fn the_claims_of_the_examples_are_proved_with_their_plants() {
    let own = |args: &[&str], file: &str| {
        let path = root().join("examples").join(file);
        let folder = Folder::new();
        let ran = folder.g7(&[&["prove", path.to_str().expect("a name")], args].concat());
        let text = std::fs::read_to_string(&path).expect(file);
        let claims =
            text.lines().filter(|l| l.starts_with("prove ") && (args.is_empty() || l.contains(" with ")));
        let proved = ran.out.lines().filter(|l| l.contains(": proved: prove ")).count();
        assert_eq!(proved, claims.count(), "{file}: {}{}", ran.out, ran.err);
        ran
    };
    // With their assumptions and plants nothing of these is refuted or left open.
    for file in [
        "two-tanks/chart.g7",
        "modelling/machine.g7",
        "transport-workcell/basic.g7",
        "bottle-conveyor/chart.g7",
    ] {
        own(&[], file).is(0);
    }
    // In the loop some steps cannot be active, since nobody turns the unit over.
    own(&["--plant", "Unit"], "bead-sorter/exercise-1.g7").is(1);
}

/// A chart whose steps are behind arithmetic that neither search nor solver can follow.
fn floating(steps: usize) -> String {
    let mut chart =
        String::from("profile iec61131\ninput t : REAL\nvar x : REAL\nchart G {\n  initial step 0\n");
    for i in 1..=steps {
        chart.push_str(&format!("  step {i}\n  {} -> {i} when x > 100.0\n", i - 1));
    }
    format!("{chart}  {steps} -> 0 when x < 0.0\n}}\npost {{ x := x * 0.9 + t }}\nprove never x > 1000.0\n")
}

#[test]
fn what_is_not_decided_for_one_reason_stands_together() {
    let folder = Folder::with(&floating(20));
    let ran = folder.g7(&["prove", "chart.g7"]);
    let out = &ran.is(3).out;
    for part in
        ["chart.g7: not decided: ", "  of each: ", "step 1 can be active", "(--all lists them)", "  help: "]
    {
        assert!(out.contains(part), "{part}: {out}");
    }
    assert!(!out.contains("step 20 can"), "{out}");
    // A claim of the author stands alone.
    assert!(out.contains("not decided: prove never x > 1000.0"), "{out}");
    let all = folder.g7(&["prove", "chart.g7", "--all"]);
    assert!(all.is(3).out.contains("not decided: step 20 can be active"), "{}", all.out);
    let last = |out: &str| out.lines().last().expect("the counts").to_owned();
    assert_eq!(last(&all.out), last(out), "the counts are the same");
}

#[test]
fn a_chart_that_is_too_large_for_the_time_is_said_in_a_line() {
    let folder = Folder::new();
    let steps: String = (1..20_000).map(|i| format!("  step {i}\n  {} -> {i} when a\n", i - 1)).collect();
    folder.write("a.g7", format!("input a : BOOL\nchart G {{\n  initial step 0\n{steps}}}\n"));
    folder.write("b.g7", "input a : BOOL\nchart G {\n  initial step 0\n  step 1\n  0 -> 1 when a\n}\n");
    let call = ["prove", "a.g7", "b.g7", "--time", "1ms", "--junit", "out.xml"];
    let ran = folder.g7(&call);
    assert!(ran.is(3).out.contains("a.g7: not decided: the time of 1ms is over"), "{}", ran.out);
    assert!(ran.out.len() < 2_000, "{}", ran.out);
    let junit = folder.read("out.xml");
    assert!(junit.contains("<testsuite name=\"a.g7\" tests=\"1\" failures=\"0\" errors=\"0\""), "{junit}");
    assert!(junit.contains("<skipped message="), "{junit}");
    let json = folder.g7(&[&call[..5], &["--format", "json"]].concat());
    let json: serde_json::Value = serde_json::from_str(&json.is(3).out).expect("JSON");
    assert_eq!(json["not_asked"][0]["file"], "a.g7");
    let sarif = folder.g7(&[&call[..5], &["--format", "sarif"]].concat());
    let sarif: serde_json::Value = serde_json::from_str(&sarif.is(3).out).expect("JSON");
    assert_eq!(sarif["runs"][0]["invocations"][0]["executionSuccessful"], false);
}

/// A plant whose states have no end, and a claim that no run breaks.
const ENDLESS: &str = "\
profile iec61131
scan 100ms
input high : BOOL
output V : BOOL
chart Fill {
  initial step 0 { N V }
  step 1
  0 -> 1 when high
  1 -> 0 when not high
}
plant Sink {
  state level : REAL := 0.0
  rate level := 1.0
  drive high := level > 3.0
}
prove never X0 and X1 with Sink
prove never X1 with Sink
";

#[test]
fn a_plant_without_an_end_is_not_decided_and_what_is_known_stays() {
    let folder = Folder::with(ENDLESS);
    let ran = folder.g7(&["prove", "chart.g7", "--states", "1000"]);
    // The second claim is broken long before the bound.
    assert!(ran.is(1).out.contains("chart.g7:17:1: refuted: prove never X1 with Sink"), "{}", ran.out);
    assert!(ran.out.contains("there are more than 1000 states"), "{}", ran.out);
    folder.write("chart.g7", ENDLESS.replace("prove never X1 with Sink\n", ""));
    folder.g7(&["prove", "chart.g7", "--states", "1000"]).is(3);
    folder.write("chart.g7", ENDLESS.replace("with Sink", "with Zink"));
    let ran = folder.g7(&["prove", "chart.g7"]);
    assert!(ran.code != 0 && ran.err.contains("Zink") && ran.err.contains("Sink"), "{}", ran.err);
}

#[cfg(unix)]
#[test]
fn what_is_known_is_printed_when_someone_presses_ctrl_c() {
    // The counter has far too many states; what the first scans decide is known at once.
    let chart = "\
profile iec61131
input a, b : BOOL
var n : DINT
chart G {
  initial step 1
  step 2 { P1 { n := n + 1 } }
  1 -> 2 when a
  2 -> 1 when b
}
prove never X2
prove never n = 2000000
";
    let folder = Folder::with(chart);
    let child = std::process::Command::new(snapbox::cmd::cargo_bin!("g7"))
        .args(["prove", "chart.g7", "--time", "10m"])
        .current_dir(folder.root())
        .stdout(std::process::Stdio::piped())
        .spawn()
        .expect("it starts");
    std::thread::sleep(std::time::Duration::from_secs(1));
    let kill = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(kill.is_ok_and(|s| s.success()), "the signal is sent");
    let ran = child.wait_with_output().expect("it ends");
    let out = String::from_utf8_lossy(&ran.stdout);
    assert_eq!(ran.status.code(), Some(1), "{out}");
    for part in ["refuted: prove never X2", "not decided: prove never n = 2000000", "; stopped by Ctrl-C\n"] {
        assert!(out.contains(part), "{part}: {out}");
    }
}

#[test]
fn each_code_of_the_exit_has_its_reason() {
    let door = "profile iec61131\ninput a : BOOL\nchart G {\n  initial step 1\n  step 2\n  1 -> 2 when a\n  2 -> 1 when not a\n}\n";
    let code = |claim: &str| {
        let folder = Folder::with(&format!("{door}{claim}\n"));
        folder.g7(&["prove", "chart.g7"]).code
    };
    assert_eq!(code("prove always X1 or X2"), 0);
    assert_eq!(code("prove never X2"), 1);
    assert_eq!(code("prove never X7"), 1, "an error of the chart");
    assert_eq!(code("assume a and not a"), 1, "assumptions that contradict each other");
    assert_eq!(Folder::with(&floating(1)).g7(&["prove", "chart.g7"]).code, 3);
    assert_eq!(Folder::new().g7(&["prove", "nowhere.g7"]).code, 2);
}

#[test]
fn a_file_with_errors_is_an_error_of_each_report() {
    let folder = Folder::new();
    folder.write("good.g7", "input a : BOOL\nchart G {\n  initial step 1\n  step 2\n  1 -> 2 when a\n}\n");
    folder
        .write("bad.g7", "input a : BOOL\nchart G {\n  initial step 1\n  step 2\n  1 -> 2 when a and c\n}\n");
    let ran = folder.g7(&["prove", ".", "--junit", "out.xml", "--format", "json"]);
    let json: serde_json::Value = serde_json::from_str(&ran.is(1).out).expect("JSON");
    let reason = json["not_asked"][0]["reason"].as_str().expect("a reason");
    assert!(reason.contains("nothing is called `c`"), "{reason}");
    let junit = folder.read("out.xml");
    assert!(junit.contains("errors=\"1\"") && junit.contains("<error message="), "{junit}");
    assert_eq!(junit.matches("<testsuite name=").count(), 2, "{junit}");
    // No colours in a report.
    assert!(!junit.contains('\u{1b}') && !junit.contains('\u{fffd}'), "{junit}");
    let sarif = folder.g7(&["prove", ".", "--format", "sarif"]);
    let sarif: serde_json::Value = serde_json::from_str(&sarif.is(1).out).expect("JSON");
    assert_eq!(sarif["runs"][0]["invocations"][0]["toolExecutionNotifications"][0]["level"], "error");
}

#[test]
fn what_an_export_writes_is_compared_on_request() {
    let chart = "\
profile iec60848
input a, b : BOOL
output m : BOOL
chart G {
  initial step 1
  step 2 { N m }
  1 -> 2 when a
  2 -> 1 when b and not a
}
";
    let folder = Folder::with(chart);
    let same = folder.g7(&["export", "chart.g7", "--to", "xmi", "-o", "same.xmi", "--compare"]);
    assert!(same.is(0).out.starts_with("equal: the same outputs"), "{}", same.out);
    let back = folder.g7(&["import", "same.xmi", "-o", "back.g7", "--compare"]);
    assert!(back.is(0).out.starts_with("equal: the same outputs"), "{}", back.out);
    // Where one scan takes one transition only, two that follow each other take a scan more.
    folder.write("far.g7", chart.replace("1 -> 2 when a", "step 3\n  1 -> 3 when a\n  3 -> 2 when TRUE"));
    let other = folder.g7(&["export", "far.g7", "--to", "plcopen", "-o", "far.xml", "--compare"]);
    assert!(other.is(1).out.starts_with("different: after 1 scan output `m`"), "{}", other.out);
    assert!(folder.names().contains(&"far.xml".to_owned()), "the file stays");
    folder
        .g7(&["export", "chart.g7", "--to", "mermaid", "-o", "m.mmd", "--compare"])
        .is_refused(&["not read back"]);
    assert!(!folder.names().contains(&"m.mmd".to_owned()));
}
