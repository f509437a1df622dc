//! `g7 check`: results, messages, formats.
#![allow(missing_docs, reason = "a test")]

use crate::common;

use common::{Folder, PINGPONG};
use snapbox::{assert_data_eq, str};

#[test]
fn a_chart_without_problems_is_fine_and_says_so_aside() {
    let ran = Folder::with(PINGPONG).g7(&["check"]);
    ran.is(0);
    assert_eq!((ran.out.as_str(), ran.err.as_str()), ("", "1 file: no problems\n"));
}

#[test]
fn a_problem_shows_its_place_and_gives_exit_code_1() {
    let folder =
        Folder::with("chart G {\n  initial step 1\n  step 2\n  1 -> 2 when a\n  2 -> 1 when TRUE\n}\n");
    let ran = folder.g7(&["check", "chart.g7"]);
    ran.is(1);
    assert_data_eq!(
        ran.out.as_str(),
        str![[r#"
error[G0202]: nothing is called `a`
 --> chart.g7:4:15
  |
4 |   1 -> 2 when a
  |               ^


"#]]
    );
    assert_eq!(ran.err, "1 file: 1 error; `g7 explain CODE` says more\n");
}

#[test]
fn several_problems_are_reported_at_once_in_the_order_of_the_text() {
    let folder = Folder::with("chart G {\n  initial step 1\n  step 2\n  1 -> 2 when a\n  2 -> 1 when b\n}\n");
    let ran = folder.g7(&["check"]);
    let first = ran.is(1).out.find("called `a`").expect("the first");
    assert!(first < ran.out.find("called `b`").expect("the second"));
}

#[test]
fn problems_of_tests_and_plants_are_found_as_well() {
    let chart = format!(
        "{PINGPONG}\nplant P {{\n  drive nothing := TRUE\n}}\ntest \"t\" {{ set x := 1 }}\n\
         test \"u\" with Q {{ scan }}\n"
    );
    let ran = Folder::with(&chart).g7(&["check"]);
    ran.is(1);
    for code in ["G0501", "G0550", "G0551"] {
        assert!(ran.out.contains(code), "{code}: {}", ran.out);
    }
}

#[test]
fn a_condition_that_is_no_bool_and_a_value_that_does_not_fit_are_found() {
    let chart = format!("{PINGPONG}\ntest \"t\" {{\n  expect n\n  set n := 1.5, a := 1\n}}\n");
    let ran = Folder::with(&chart).g7(&["check"]);
    ran.is(1);
    assert!(ran.out.contains("this is INT, a condition is BOOL"), "{}", ran.out);
    assert!(ran.out.contains("`n` is INT"), "{}", ran.out);
    assert_eq!(ran.out.matches("error[").count(), 2, "1 does for a BOOL: {}", ran.out);
}

#[test]
fn json_has_places_in_lines_and_characters() {
    let folder =
        Folder::with("chart G {\n  initial step 1 step 2\n  1 -> 2 when å and b\n  2 -> 1 when X2\n}\n");
    let ran = folder.g7(&["check", "--format", "json"]);
    let all: serde_json::Value = serde_json::from_str(&ran.is(1).out).expect("JSON");
    assert_eq!((&all["files"], &all["errors"]), (&1.into(), &2.into()));
    let second = &all["problems"][1];
    assert_eq!(second["code"], "G0202");
    assert_eq!(second["severity"], "error");
    assert_eq!(second["start"]["line"], 3);
    assert_eq!(second["start"]["column"], 21, "å is one character");
    assert_eq!(ran.err, "");
}

#[test]
fn a_folder_means_all_charts_in_it_and_below() {
    let folder = Folder::with(PINGPONG);
    folder.write("b/two.g7", PINGPONG);
    folder.write(".hidden/three.g7", "not a chart");
    folder.write("notes.txt", "not a chart");
    assert_eq!(folder.g7(&["check"]).is(0).err, "2 files: no problems\n");
}

#[test]
fn the_standard_input_is_a_dash() {
    let folder = Folder::new();
    let ran: common::Ran = folder.command(&["check", "-"]).stdin("chart {").assert().into();
    assert!(ran.is(1).out.contains("<stdin>:1:"), "{}", ran.out);
}

#[test]
fn any_bytes_give_problems_and_nothing_worse() {
    let folder = Folder::new();
    let nested = "(".repeat(300_000);
    let files: [(&str, Vec<u8>); 6] = [
        ("empty", Vec::new()),
        ("nul", vec![0; 1000]),
        ("broken", b"input \xff\xfe a : BOOL\nchart \xc3( { }".to_vec()),
        ("deep", format!("chart G {{ initial step 1 1 -> 1 when {nested} }}").into_bytes()),
        ("long", format!("var {} : INT := foo", "x".repeat(100_000)).into_bytes()),
        ("range", b"chart G { initial step 1 1 -> (1..1000000000) when 1 }".to_vec()),
    ];
    for (name, bytes) in files {
        folder.write("x.g7", bytes);
        let ran = folder.g7(&["check", "x.g7"]);
        assert!(ran.code == 1 || name == "empty" && ran.code == 0, "{name}: {} {}", ran.code, ran.err);
        assert!(!ran.err.contains("panicked"), "{name}: {}", ran.err);
    }
}

#[test]
fn what_is_not_there_or_no_file_is_one_line_and_code_2() {
    let folder = Folder::new();
    folder.g7(&["check", "missing.g7"]).is_refused(&["missing.g7", "no such file"]);
    folder.g7(&["check"]).is_refused(&["no .g7 file"]);
    folder.g7(&["run"]).is_refused(&["no .g7 file", "g7 new"]);
    folder.write("a.g7", PINGPONG);
    folder.write("b.g7", PINGPONG);
    folder.g7(&["run"]).is_refused(&["2 .g7 files"]);
    folder.g7(&["import", "."]).is_refused(&["directory"]);
    let ran = folder.g7(&["check", "--target", "s7"]);
    assert!(ran.is(2).err.contains("tsx3710"), "{}", ran.err);
    folder.g7(&["nonsense"]).is(2);
}

#[test]
fn a_target_and_strict_make_a_difference() {
    let steps: String =
        (0..200).map(|i| format!("  step {i}\n  {i} -> {} when a\n", (i + 1) % 200)).collect();
    let chart = format!("input a : BOOL\nchart G {{\n  initial step start\n  start -> 0 when a\n{steps}}}\n");
    let folder = Folder::with(&chart);
    folder.g7(&["check"]).is(0);
    let ran = folder.g7(&["check", "--target", "tsx3710"]);
    assert!(ran.is(1).out.contains("[G04"), "a TSX 37-10 has 96 steps: {}", ran.out);
}

#[test]
fn colours_only_where_wanted() {
    let folder = Folder::with("chart G {");
    assert!(!folder.g7(&["check"]).out.contains('\u{1b}'));
    assert!(folder.g7(&["check", "--color", "always"]).out.contains('\u{1b}'));
    let never: common::Ran = folder.command(&["check"]).env("NO_COLOR", "1").assert().into();
    assert!(!never.out.contains('\u{1b}'));
}

#[test]
fn a_file_with_nothing_in_it_is_told() {
    let folder = Folder::with("// the pump, some day\n");
    let ran = folder.g7(&["check", "chart.g7"]);
    assert!(ran.out.contains("G0235"), "{}", ran.out);
}

#[test]
fn problems_are_told_in_the_language_of_the_reader() {
    let folder = Folder::with("chart G {\n  initial step 1 step 2\n  1 -> 2 when foo\n  2 -> 1 when X2\n}\n");
    let told = |args: &[&str], lang: &str| folder.command(args).env("LC_ALL", lang).assert().into();
    let french: common::Ran = told(&["check"], "fr_FR.UTF-8");
    assert!(french.is(1).out.contains("rien ne s’appelle `foo`"), "{}", french.out);
    let portuguese: common::Ran = told(&["check", "--lang", "pt"], "fr_FR.UTF-8");
    assert!(portuguese.is(1).out.contains("nada se chama `foo`"), "{}", portuguese.out);
    let english: common::Ran = told(&["check"], "de_DE.UTF-8");
    assert!(english.is(1).out.contains("nothing is called `foo`"), "{}", english.out);
    for format in ["json", "sarif", "github"] {
        let ran: common::Ran = told(&["check", "--lang", "fr", "--format", format], "C");
        assert!(ran.is(1).out.contains("rien ne s’appelle `foo`"), "{format}: {}", ran.out);
        assert!(ran.out.contains("G0202"), "{format}: {}", ran.out);
    }
}
