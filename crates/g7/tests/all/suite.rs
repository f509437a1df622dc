//! `g7 test` with many files: lists, limits, what is counted, reports.
#![allow(missing_docs, reason = "a test")]
#![allow(clippy::disallowed_methods, reason = "a test that measures")]

use crate::common;

use common::{Folder, PINGPONG};

fn with(tests: &str) -> String {
    format!("{PINGPONG}\n{tests}")
}

#[test]
fn list_has_each_test_and_runs_none() {
    let folder = Folder::with(&with("test \"one\" { expect X2 }\ntest \"two\" { scan }"));
    let ran = folder.g7(&["test", "--list"]);
    assert_eq!((ran.is(0).out.as_str(), ran.err.as_str()), ("./chart.g7: one\n./chart.g7: two\n", ""));
    assert_eq!(folder.g7(&["test", "--list", "-f", "tw"]).is(0).out, "./chart.g7: two\n");
    let json = folder.g7(&["test", "--list", "--format", "json"]).is(0).out.clone();
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json["tests"][1]["place"], "./chart.g7:16:1");
}

#[test]
fn no_test_is_a_finding() {
    let folder = Folder::with(&with("test \"one\" { scan }"));
    let ran = folder.g7(&["test", "--filter", "three"]);
    assert_eq!(ran.is(1).err, "no test has that in its title\n");
    assert!(folder.g7(&["test", "--list", "--filter", "three"]).is(1).err.contains("no test"));
    folder.write("chart.g7", PINGPONG);
    assert_eq!(folder.g7(&["test"]).is(1).err, "there are no tests\n");
}

#[test]
fn files_with_errors_are_counted_and_reported() {
    let folder = Folder::with(&with("test \"t\" { scan }"));
    folder.write("broken.g7", "chart {");
    let ran = folder.g7(&["test", "--junit", "out.xml"]);
    assert!(ran.is(1).out.ends_with("\n1 passed, 0 failed, 1 file with errors\n"), "{}", ran.out);
    let xml = folder.read("out.xml");
    assert!(xml.contains("<testsuites name=\"g7\" tests=\"2\" failures=\"0\" errors=\"1\""), "{xml}");
    assert!(xml.contains("<error message=\"errors\">") && xml.contains("broken.g7:1:"), "{xml}");
    let json = folder.g7(&["test", "--format", "json"]).is(1).out.clone();
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json["files_with_errors"], serde_json::json!(["./broken.g7"]));
}

#[test]
fn junit_has_file_and_line_of_each_test() {
    let folder = Folder::with(&with("test \"one\" { scan }\n\ntest \"two\" { expect X2 }"));
    folder.g7(&["test", "--junit", "out.xml"]).is(1);
    let xml = folder.read("out.xml");
    for part in
        ["name=\"one\" file=\"./chart.g7\" line=\"15\"", "name=\"two\" file=\"./chart.g7\" line=\"17\""]
    {
        assert!(xml.contains(part), "{part} in {xml}");
    }
}

#[test]
fn fail_fast_runs_nothing_behind_a_failure() {
    let folder = Folder::new();
    folder.write("a.g7", with("test \"a1\" { scan }\ntest \"a2\" { expect X2 }\ntest \"a3\" { scan }"));
    folder.write("b.g7", with("test \"b1\" { scan }\ntest \"b2\" { scan }"));
    let ran = folder.g7(&["test", "--fail-fast", "--jobs", "1"]);
    assert!(ran.is(1).out.ends_with("\n1 passed, 1 failed, 3 not run\n"), "{}", ran.out);
    assert!(!ran.out.contains("a3") && !ran.out.contains("b1"), "{}", ran.out);
    assert!(folder.g7(&["test"]).is(1).out.ends_with("\n4 passed, 1 failed\n"));
}

#[test]
fn jobs_change_nothing_in_what_is_printed() {
    let folder = Folder::new();
    for i in 0..12 {
        let length = if i % 3 == 0 { "1000s" } else { "1s" };
        folder.write(
            &format!("{i:02}.g7"),
            with(&format!("test \"t{i}\" {{ wait {length} }}\ntest \"u\" {{ expect X2 }}")),
        );
    }
    let one = folder.g7(&["test", "--jobs", "1", "--coverage"]).is(1).out.clone();
    assert_eq!(folder.g7(&["test", "--jobs", "8", "--coverage"]).is(1).out, one);
    assert!(one.ends_with("\n12 passed, 12 failed\n"), "{one}");
    folder.g7(&["test", "--jobs", "0"]).is(2);
}

#[test]
fn a_test_that_takes_too_long_has_failed() {
    let begin = std::time::Instant::now();
    let endless = "test \"for ever\" { repeat 1000000000 { repeat 1000000000 { } } }\n";
    let folder = Folder::with(&with(&format!(
        "{endless}test \"long\" {{ set a := TRUE wait 10000000s }}\ntest \"short\" {{ scan }}"
    )));
    let ran = folder.g7(&["test", "--timeout", "300ms"]);
    assert!(ran.is(1).out.ends_with("\n1 passed, 2 failed\n"), "{}", ran.out);
    assert_eq!(
        ran.out.matches("ended after 300ms of real time, the limit of a test").count(),
        2,
        "{}",
        ran.out
    );
    assert!(begin.elapsed() < std::time::Duration::from_secs(30));
}

#[test]
fn folders_are_searched_below_where_there_is_no_chart_at_the_top() {
    let folder = Folder::new();
    folder.write("plants/tank/chart.g7", PINGPONG);
    folder.write("plants/tank/other.g7", PINGPONG);
    assert!(folder.g7(&["run", "--headless"]).is(0).out.starts_with("./plants/tank/chart.g7"));
    folder.g7(&["draw", "-o", "a.svg", "plants"]).is(0);
    folder.write("plants/belt/chart.g7", PINGPONG);
    folder.g7(&["run", "--headless"]).is_refused(&["3 .g7 files", "plants/belt/chart.g7"]);
    folder.write("chart.g7", PINGPONG);
    assert!(folder.g7(&["run", "--headless"]).is(0).out.starts_with("./chart.g7"));
}
