//! `g7 check --fix`, `--watch`, its formats for code review; `g7 fmt --diff`; files of no form.
#![allow(missing_docs, reason = "a test")]

use crate::common;

use common::talk::Running;
use common::{Folder, PINGPONG};
use serde_json::Value;

/// `inital` is misspelt, which is sure; `b` may stand for the input, which is likely.
const MISSPELT: &str = "\
input button : BOOL
chart G {
  inital step 1
  step 2
  1 -> 2 when buton
  2 -> 1 when not button
}
";

#[test]
fn fix_applies_what_is_sure_and_on_request_what_is_likely() {
    let folder = Folder::with(MISSPELT);
    let ran = folder.g7(&["check"]);
    assert!(ran.is(1).err.ends_with("; `g7 check --fix` solves 1\n"), "{}", ran.err);
    let ran = folder.g7(&["check", "--fix"]);
    assert!(ran.is(1).err.contains("solved 1 problem of ./chart.g7"), "{}", ran.err);
    let sure = MISSPELT.replace("inital", "initial");
    assert_eq!(folder.read("chart.g7"), sure, "the likely one waits");
    assert!(ran.out.contains("did you mean `button`?"), "{}", ran.out);
    let ran = folder.g7(&["check", "--fix=likely"]);
    assert_eq!(ran.is(0).err, "solved 1 problem of ./chart.g7\n1 file: no problems\n");
    assert_eq!(folder.read("chart.g7"), sure.replace("buton", "button"));
    let again = folder.g7(&["check", "--fix=likely"]);
    assert_eq!(again.is(0).err, "1 file: no problems\n", "nothing is left to do");
}

#[test]
fn fix_leaves_files_of_other_tools_and_the_standard_input_alone() {
    let folder = Folder::with(MISSPELT);
    folder.g7(&["check", "--fix", "-"]).is_refused(&["--fix", "standard input"]);
    let bytes = [MISSPELT.as_bytes(), b"// \xff\n"].concat();
    folder.write("chart.g7", &bytes);
    folder.g7(&["check", "--fix"]).is(1);
    assert_eq!(std::fs::read(folder.path("chart.g7")).expect("bytes"), bytes, "no UTF-8: as it was");
}

#[test]
fn the_fixes_of_a_problem_are_in_json() {
    let folder = Folder::with(MISSPELT);
    let all: Value =
        serde_json::from_str(&folder.g7(&["check", "--format", "json"]).is(1).out).expect("JSON");
    let fix = &all["problems"][0]["fixes"][0];
    assert_eq!((&fix["label"], &fix["sure"]), (&"write `initial`".into(), &true.into()));
    let edit = &fix["edits"][0];
    assert_eq!(
        (&edit["text"], &edit["start"]["line"], &edit["start"]["column"]),
        (&"initial".into(), &3.into(), &3.into())
    );
    assert_eq!(edit["end"]["column"], 9);
}

#[test]
fn sarif_has_each_problem_with_its_rule_place_and_fix() {
    let folder = Folder::with(MISSPELT);
    folder.write("b c.g7", PINGPONG);
    let text = folder.g7(&["check", "--format", "sarif"]).is(1).out.clone();
    let log: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(log["version"], "2.1.0");
    let run = &log["runs"][0];
    let result = &run["results"][0];
    assert_eq!((&result["ruleId"], &result["level"]), (&"G0009".into(), &"error".into()));
    let rule = &run["tool"]["driver"]["rules"][result["ruleIndex"].as_u64().expect("a number") as usize];
    assert_eq!((&rule["id"], &rule["defaultConfiguration"]["level"]), (&"G0009".into(), &"error".into()));
    assert!(rule["help"]["markdown"].as_str().is_some_and(|page| page.contains("G0009")), "{rule}");
    let place = &result["locations"][0]["physicalLocation"];
    assert_eq!(place["artifactLocation"]["uri"], "chart.g7");
    let region = serde_json::json!({ "startLine": 3, "startColumn": 3, "endLine": 3, "endColumn": 9 });
    assert_eq!(place["region"], region);
    let change = &result["fixes"][0]["artifactChanges"][0];
    assert_eq!(change["artifactLocation"]["uri"], "chart.g7");
    assert_eq!(change["replacements"][0]["deletedRegion"], region);
    assert_eq!(change["replacements"][0]["insertedContent"]["text"], "initial");
    assert_eq!(run["artifacts"][0]["location"]["uri"], "b%20c.g7");
    valid(&folder, &text);
}

/// Holds a log against the schema of OASIS, where the machine has it.
fn valid(folder: &Folder, log: &str) {
    let Some(schema) = g7_peers::sarif_schema() else { return };
    let Some(python) = g7_peers::python("jsonschema") else { return };
    folder.write("log.sarif", log);
    let script = "import json, sys, jsonschema\n\
                  jsonschema.validate(json.load(open(sys.argv[1])), json.load(open(sys.argv[2])))";
    let ran = std::process::Command::new(python)
        .args(["-c", script])
        .args([folder.path("log.sarif"), schema])
        .output()
        .expect("it runs");
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
}

#[test]
fn github_gets_a_command_for_each_problem() {
    let folder =
        Folder::with("chart G {\n  initial step 1\n  step 2\n  1 -> 2 when a%\n  2 -> 1 when TRUE\n}\n");
    folder.write("b,c.g7", "chart G {\n  initial step 1\n  step 2\n  1 -> 2 when a\n  2 -> 1 when TRUE\n}\n");
    let out = folder.g7(&["check", "--format", "github"]).is(1).out.clone();
    let lines: Vec<&str> = out.lines().collect();
    assert_eq!(
        lines[0],
        "::error file=b%2Cc.g7,line=4,endLine=4,col=15,endColumn=16,title=G0202%3A a name that nothing has\
         ::nothing is called `a`"
    );
    assert!(lines.len() > 1 && lines.iter().all(|l| l.starts_with("::error file=")), "{out}");
    assert!(lines[1].contains("%25") || lines[1].contains("chart.g7,line=4"), "{out}");
}

#[test]
fn watch_checks_again_when_a_file_changes_or_comes() {
    let folder = Folder::with(PINGPONG);
    let mut running = Running::g7(&folder, &["check", "--watch"]);
    running.until("1 file: no problems");
    running.until("waiting for a change");
    folder.write("chart.g7", PINGPONG.replace("step 2 {", "step 3 {"));
    running.until("error");
    running.until("waiting for a change");
    folder.write("chart.g7", PINGPONG);
    running.until("1 file: no problems");
    running.until("waiting for a change");
    folder.write("more.g7", PINGPONG);
    running.until("2 files: no problems");
    folder.g7(&["check", "--watch", "-"]).is_refused(&["--watch"]);
    folder.g7(&["check", "--watch", "missing.g7"]).is_refused(&["no such file"]);
}

#[test]
fn watch_looks_at_the_files_that_a_chart_uses() {
    let folder = Folder::with(&format!("use 'lib/modes.g7'\n{PINGPONG}"));
    folder.write("lib/modes.g7", "type Mode : (Off, On)\n");
    let mut running = Running::g7(&folder, &["check", "--watch", "chart.g7"]);
    running.until("1 file: no problems");
    running.until("waiting for a change");
    folder.write("lib/modes.g7", "type Mode : (Off, Off)\n");
    running.until("1 file: 1 error");
}

#[test]
fn fmt_shows_what_would_change_and_writes_nothing() {
    let untidy = "input a:BOOL\nchart G {\n  initial step 1\n  1 -> 1 when a\n}\n";
    let folder = Folder::with(untidy);
    let ran = folder.g7(&["fmt", "--check", "--diff"]);
    let head = "--- a/chart.g7\n+++ b/chart.g7\n@@ -1,";
    assert!(ran.is(1).out.starts_with(head), "{}", ran.out);
    assert!(ran.out.contains("\n-input a:BOOL\n") && ran.out.contains("\n+input a : BOOL\n"), "{}", ran.out);
    assert!(!ran.out.contains("./chart.g7\n"), "the diff names the file: {}", ran.out);
    assert_eq!(folder.g7(&["fmt", "--diff"]).is(0).out, ran.out);
    assert_eq!(folder.read("chart.g7"), untidy);
    // The output is a patch.
    if g7_peers::tool("patch") {
        folder.write("change.diff", &ran.out);
        let status = std::process::Command::new("patch")
            .args(["-p1", "-s", "-i", "change.diff"])
            .current_dir(folder.root())
            .status();
        assert!(status.expect("patch runs").success());
        folder.g7(&["fmt", "--check", "--diff"]).is(0);
    }
}

#[test]
fn a_file_of_no_form_is_one_line() {
    let folder = Folder::with(PINGPONG);
    let notes = "# Notes\n\n".to_owned() + &"a line (of text, 'with signs; and \"more\n".repeat(300);
    folder.write("notes.txt", &notes);
    folder.write("picture.png", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".repeat(50));
    for name in ["notes.txt", "picture.png"] {
        let ran = folder.g7(&["check", name, "chart.g7"]);
        assert_eq!(ran.is(1).out.lines().count(), 1, "{}", ran.out);
        assert!(ran.out.starts_with(&format!("error[G0004]: {name}: this is no .g7 file")), "{}", ran.out);
        assert!(
            ran.out.contains("JGrafchart") && ran.err.starts_with("2 files: 1 error"),
            "{} {}",
            ran.out,
            ran.err
        );
        for command in ["run", "draw", "test"] {
            folder.g7(&[command, name]).is_refused(&[name, "no .g7 file"]);
        }
        let all: Value =
            serde_json::from_str(&folder.g7(&["check", "--format", "json", name]).is(1).out).expect("JSON");
        assert_eq!(all["problems"].as_array().map(Vec::len), Some(1));
    }
    // A file that begins as a chart is read as one, whatever its name.
    folder.write("chart.txt", PINGPONG);
    folder.g7(&["check", "chart.txt"]).is(0);
}

#[test]
fn a_path_given_twice_is_read_once() {
    let folder = Folder::with(PINGPONG);
    let ran = folder.g7(&["check", "chart.g7", ".", "./chart.g7"]);
    assert_eq!(ran.is(0).err, "1 file: no problems\n");
}
