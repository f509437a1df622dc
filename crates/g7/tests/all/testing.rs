//! `g7 test`: each statement, failures, reports, coverage.
#![allow(missing_docs, reason = "a test")]

use crate::common;

use common::{Folder, PINGPONG};

/// Runs tests that are appended to the ping-pong chart.
fn with(tests: &str) -> (Folder, common::Ran) {
    let folder = Folder::with(&format!("{PINGPONG}\n{tests}"));
    let ran = folder.g7(&["test"]);
    (folder, ran)
}

#[track_caller]
fn passes(tests: &str) {
    let (_folder, ran) = with(tests);
    assert!(ran.is(0).out.ends_with(", 0 failed\n"), "{}", ran.out);
}

#[track_caller]
fn fails(tests: &str, parts: &[&str]) {
    let (_folder, ran) = with(tests);
    ran.is(1);
    for part in parts {
        assert!(ran.out.contains(part), "`{part}` in: {}", ran.out);
    }
}

#[test]
fn the_first_scan_comes_before_the_first_statement() {
    passes("test \"t\" { expect X1, not X2, n = 0 }");
}

#[test]
fn set_makes_one_scan_with_all_its_values() {
    passes("test \"t\" { set a := TRUE  expect X2, m, n = 1  set a := FALSE, n := 7  expect X1, n = 7 }");
}

#[test]
fn pulse_is_true_for_a_scan_or_a_time_then_false_for_a_scan() {
    passes("test \"t\" { pulse a  expect X1, n = 1  pulse a for 1s  expect X1, n = 2 }");
    // `a` is true for 100 scans and false in the next: step 2 was active for 1 s and is left at
    // once.
    passes("test \"t\" { pulse a for 1s  expect X2.t = 1s, not X2 }");
}

#[test]
fn wait_rounds_up_to_scans() {
    passes("test \"t\" { set a := TRUE  wait 1s  expect X2.t = 1s  wait 5ms  expect X2.t = 1010ms }");
}

#[test]
fn scan_counts_scans() {
    passes("test \"t\" { set a := TRUE  scan  expect X2.t = 10ms  scan 3  expect X2.t = 40ms }");
}

#[test]
fn wait_until_returns_at_once_or_fails_in_the_end() {
    passes("test \"t\" { wait until X1  set a := TRUE  expect X2.t = 0s }");
    passes("test \"t\" { set a := TRUE  wait until X2.t >= 500ms within 500ms }");
    fails(
        "test \"t\" { set a := TRUE  wait until X1 within 500ms }",
        &["not true within 500ms: X1", "510ms after the start", "got X1 = FALSE", "situation {2}"],
    );
    fails("test \"t\" { wait until X2 }", &["not true within 10s"]);
}

#[test]
fn a_failed_expectation_shows_place_values_situation_and_signals() {
    fails(
        "test \"counts\" {\n  set a := TRUE\n  expect m, n = 2 or not m\n}",
        &[
            "FAILED ./chart.g7: counts",
            "counts: expected: n = 2 or not m\n",
            "at ./chart.g7:17:13, 10ms after the start\n",
            "got n = 1, m = TRUE\n",
            "situation {2}\n",
            "╱",
            "0 passed, 1 failed\n",
        ],
    );
}

#[test]
fn always_looks_at_every_scan_of_its_block_and_no_other() {
    passes("test \"t\" { always not m { wait 100ms }  set a := TRUE  expect m }");
    fails(
        "test \"t\" { always n < 2 { pulse a  pulse a  pulse a } }",
        &["this did not hold throughout: n < 2", "30ms after", "got n = 2"],
    );
    fails("test \"t\" { always n < 9 { repeat 2 { always not m { pulse a } } } }", &["not m"]);
}

#[test]
fn force_holds_until_release() {
    passes(
        "test \"t\" {\n  force a := TRUE\n  expect X2\n  set a := FALSE\n  expect X2\n  release a\n  expect X1\n  \
         set a := TRUE\n  force m := FALSE\n  expect not m, X2\n  release m\n  expect m\n}",
    );
    passes("test \"t\" { force n := 5  pulse a  expect n = 5  release n  pulse a  expect n = 6 }");
}

#[test]
fn restart_keeps_what_is_retained_and_cold_nothing() {
    let chart = PINGPONG.replace("var n : INT", "var n : INT retain");
    let folder = Folder::with(&format!(
        "{chart}\ntest \"t\" {{ pulse a  expect n = 1  restart  expect n = 1, X1  restart cold  expect n = 0 }}"
    ));
    folder.g7(&["test"]).is(0);
    passes("test \"t\" { pulse a  restart  expect n = 0 }");
    passes("test \"t\" { set a := TRUE  restart  expect X2, n = 1 }");
}

#[test]
fn repeat_repeats() {
    passes(
        "test \"t\" { repeat 3 { pulse a repeat 2 { pulse a } }  expect n = 9  repeat 0 { expect FALSE } }",
    );
}

const OVERFLOW: &str = "set n := 32767  ";

#[test]
fn a_fault_is_expected_by_the_next_statement_or_fails_the_test() {
    passes(&format!("test \"t\" {{ {OVERFLOW} set a := TRUE  expect fault }}"));
    passes(&format!("test \"t\" {{ {OVERFLOW} wait 1s  pulse a  expect fault overflow  expect not m }}"));
    passes(&format!("test \"t\" {{ {OVERFLOW} set a := TRUE  expect fault  restart  expect n = 1 }}"));
    fails(
        &format!("test \"t\" {{ {OVERFLOW} set a := TRUE  expect m }}"),
        &["fault: overflow", "it came up at ./chart.g7:9:"],
    );
    fails(
        &format!("test \"t\" {{ {OVERFLOW} pulse a  expect fault division }}"),
        &["expected fault division, got overflow"],
    );
    fails("test \"t\" { pulse a  expect fault }", &["expected a fault, there is none"]);
    fails(&format!("test \"t\" {{ {OVERFLOW} pulse a  expect fault  scan }}"), &["fault: overflow"]);
    fails(&format!("test \"t\" {{ {OVERFLOW} repeat 2 {{ pulse a }}  wait 1s }}"), &["fault: overflow"]);
}

#[test]
fn a_value_that_does_not_fit_fails_the_test() {
    fails("test \"t\" { set n := 40000 }", &["`n` (INT) cannot hold this value"]);
}

const PLANT: &str = "\
plant P {
  state level : REAL := 0.0 in 0.0 .. 10.0
  rate level := 1.0 when m
  drive a := level < 3.0
}
";

#[test]
fn a_plant_drives_is_set_and_is_asked() {
    passes(&format!(
        "{PLANT}\ntest \"t\" with P {{\n  expect X2, m\n  wait 1s\n  expect level > 0.9, level < 1.1\n  \
         set level := 2.9\n  wait until X1 within 200ms\n  expect level >= 3.0\n}}"
    ));
    fails(
        &format!("{PLANT}\ntest \"t\" with P {{ expect level > 5.0 }}"),
        &["expected: level > 5.0", "got level = 0.0"],
    );
    // Without `with` there is no plant, so `a` never changes.
    passes(&format!("{PLANT}\ntest \"t\" {{ wait 1s  expect X1 }}"));
}

#[test]
fn the_terminal_sets_system_bits_that_no_code_names() {
    let chart = "profile pl7\ninput a : BOOL at %I0.1\nvar n : INT\nchart G {\n  initial step 1\n  step 2 { P1 n := n + 1 }\n  \
                 step 3\n  1 -> 2 when a\n  2 -> 3 when a\n}\n";
    let tests = [
        "set a := TRUE  expect X2  set %S21 := TRUE  expect X2, n = 2, not %S21  set %I0.1 := FALSE, %S21 := TRUE  expect X1",
        "set %S22 := TRUE  expect not X1, not %S22  set a := TRUE  expect not X2  pulse %S21  expect X2 or X3",
        "force %S23 := TRUE  set %I0.1 := TRUE  expect X1, %S23  release %S23  expect X1  set %S23 := FALSE  expect X2",
        "set a := TRUE  set a := FALSE, %S0 := TRUE  expect X1, not %S0",
    ];
    for test in tests {
        let folder = Folder::with(&format!("{chart}test \"t\" {{ {test} }}"));
        let ran = folder.g7(&["test"]);
        assert!(ran.is(0).out.ends_with(", 0 failed\n"), "{test}: {}", ran.out);
    }
    for (set, parts) in [
        ("%X2 := TRUE", ["`%X2` is the state of a step", "PRE sets and resets steps"]),
        ("%S24 := TRUE", ["nothing at `%S24` can be set", "`%S0`, `%S21`, `%S22`, `%S23`"]),
        ("%S1 := TRUE", ["`%S1` is kept by the system", "it can be read, not set"]),
    ] {
        let folder = Folder::with(&format!("{chart}test \"t\" {{ set {set} }}"));
        let ran = folder.g7(&["test"]);
        ran.is(1);
        assert!(parts.iter().all(|p| ran.err.contains(p)), "{set}: {}", ran.err);
    }
}

#[test]
fn instruction_list_sets_and_resets_steps_in_pre() {
    let folder = Folder::with(
        "profile pl7\ninput s, r : BOOL\npre il {\n  LD s\n  S %X2\n  LD r\n  R %X1\n}\n\
         chart G {\n  initial step 1\n  step 2\n}\n\
         test \"t\" { expect X1, not X2  set s := TRUE  expect X1, X2  set s := FALSE, r := TRUE  expect not X1, X2 }",
    );
    let ran = folder.g7(&["test"]);
    assert!(ran.is(0).out.ends_with(", 0 failed\n"), "{}", ran.out);
}

#[test]
fn a_condition_may_join_charts_and_plant_by_and_alone() {
    passes(&format!(
        "{PLANT}\ntest \"t\" with P {{\n  expect m and level < 1.0\n  wait until ((level > 0.5) · X2) and n = 1\n  \
         expect X2 and level > 0.4 and X2.t > 100ms, not (m and X1)\n  always m and level < 3.0 {{ wait 1s }}\n  \
         set level := 2.999\n  wait until X1 and level >= 3.0\n  expect not m and level >= 3.0\n}}"
    ));
    // The report shows the operand that is false, on either side.
    for (e, got) in [("level < 1.0 and X1", "X1 = FALSE"), ("m and level > 5.0", "level = 0.0")] {
        fails(
            &format!("{PLANT}\ntest \"t\" with P {{ expect {e} }}"),
            &[&format!("expected: {e}"), got, "situation {2}"],
        );
    }
    let refused = |stmt: &str, parts: &[&str]| {
        let (_folder, ran) = with(&format!("{PLANT}\ntest \"t\" with P {{ {stmt} }}"));
        ran.is(1);
        for part in parts {
            assert!(ran.err.contains(part), "{stmt}: `{part}` in {}", ran.err);
        }
    };
    let both = "one expression cannot ask both";
    refused("expect X2 or level > 5.0", &["G0551", "`level` is the plant's and `X2` the charts'", both]);
    refused("expect m and (n = 1 or level > 5.0)", &["`n` the charts'", both, "by `and`"]);
    refused("expect level > INT_TO_REAL(n)", &[both]);
    refused("set level := INT_TO_REAL(n) + level", &[both]);
    refused("expect m and level", &["G0552", "this is REAL"]);
    // A name that neither side knows is not a mixture; the plant knows the charts' outputs.
    refused("expect level > limit", &["`limit`"]);
    passes(&format!("{PLANT}\ntest \"t\" with P {{ scan  expect level > 5.0 or m }}"));
}

#[test]
fn what_the_plant_drives_can_be_held_but_not_set() {
    passes(&format!("{PLANT}\ntest \"t\" with P {{ expect X2  force a := FALSE  expect X1 }}"));
    let folder = Folder::with(&format!("{PINGPONG}\n{PLANT}\ntest \"t\" with P {{ set a := TRUE }}"));
    let ran = folder.g7(&["test"]);
    assert!(ran.is(1).err.contains("`a` is driven by the plant"), "{}", ran.err);
    assert!(ran.err.contains("force a"), "{}", ran.err);
}

#[test]
fn a_filter_chooses_by_title() {
    let folder = Folder::with(&format!("{PINGPONG}\ntest \"one\" {{ scan }}\ntest \"two\" {{ expect X2 }}"));
    assert!(folder.g7(&["test", "--filter", "one"]).is(0).out.contains("1 passed, 0 failed"));
    assert!(folder.g7(&["test", "--filter", "two"]).is(1).out.contains("0 passed, 1 failed"));
    assert!(folder.g7(&["test", "--filter", "three"]).is(1).err.contains("no test"));
}

#[test]
fn coverage_names_what_no_test_reached() {
    let chart = "\
input a, b : BOOL
var n : INT
chart G {
  initial step 1
  step 2
  step 3 {
    P1 n := 1
  }
  1 -> 2 when a
  1 -> 3 when b and not a
  2 -> 1 when not a
  3 -> 1 when not b
}
test \"left\" { pulse a }
";
    let folder = Folder::with(chart);
    let out = folder.g7(&["test", "--coverage"]).is(0).out.clone();
    let lines: Vec<Vec<&str>> = out.lines().map(|l| l.split_whitespace().collect()).collect();
    for row in ["2 of 3 steps", "2 of 4 transitions", "0 of 1 actions", "1 of 2 branches"] {
        assert!(lines.iter().any(|l| l.join(" ") == row), "{row}: {out}");
    }
    for row in ["step 3 (./chart.g7:6:8)", "transition 1 -> 3 (", "transition 3 -> 1 (", "branch 1 -> 3 ("] {
        assert!(out.contains(&format!("not reached: {row}")), "{row}: {out}");
    }
    let transient = chart.replace("2 -> 1 when not a", "2 -> 3 when TRUE");
    folder.write("chart.g7", transient.replace("3 -> 1 when not b", "3 -> 1 when not a"));
    let out = folder.g7(&["test", "--coverage"]).is(0).out.clone();
    assert!(!out.contains("step 2 "), "active within a scan only: {out}");
}

#[test]
fn a_file_that_several_use_is_covered_by_the_tests_of_all() {
    let folder = Folder::new();
    folder.write("g7.toml", "");
    folder.write(
        "axis.g7",
        "input a : BOOL\nchart Axis {\n  initial step 0\n  step 1\n  step 2\n  0 -> 1 when a\n  1 -> 2 when not a\n}\n",
    );
    folder.write("tests/one.g7", "use '../axis.g7'\ntest \"on\" { set a := TRUE  scan 2 }\n");
    folder.write("tests/two.g7", "use '../axis.g7'\ntest \"on and off\" {\n  pulse a\n  scan 2\n}\n");
    let report = |paths: &[&str]| {
        let given: Vec<&str> = ["test", "--coverage"].into_iter().chain(paths.iter().copied()).collect();
        let out = folder.g7(&given).is(0).out.clone();
        assert_eq!(out.lines().filter(|l| l.trim_end().ends_with("axis.g7")).count(), 1, "{out}");
        let lines = out.lines().map(|l| l.split_whitespace().collect::<Vec<_>>().join(" "));
        lines.filter(|l| l.ends_with("steps") || l.contains("not reached")).collect::<Vec<String>>()
    };
    let one = report(&["tests/one.g7"]);
    assert!(one.iter().any(|l| l == "2 of 3 steps"), "{one:?}");
    assert!(one.iter().any(|l| l == "not reached: step 2 (axis.g7:5:8)"), "{one:?}");
    let both = report(&["."]);
    assert!(both.iter().any(|l| l == "3 of 3 steps"), "{both:?}");
    assert!(both.iter().all(|l| !l.contains("not reached")), "{both:?}");
}

#[test]
fn every_action_of_a_step_counts_for_itself() {
    let chart = "\
input a, c : BOOL
output m, k, l : BOOL
action Add { n := n + 1 }
var n : INT
chart G {
  initial step 1 { N m }
  step 2 {
    N m
    N k if c
    N k if not c
    D 1s l
    N Add
    P1 n := 0
  }
  step 3 {
    N m
    N Add
    force H := INIT
  }
  1 -> 2 when a -> 3 when c -> 1 when TRUE
}
chart H { initial step 10  step 11  10 -> 11 when X3 }
test \"t\" { set a := TRUE  wait TIME  expect k = not c }
";
    let folder = Folder::new();
    let missing = |profile: &str, time: &str| {
        folder.write("chart.g7", format!("profile {profile}\n{}", chart.replace("TIME", time)));
        let out = folder.g7(&["test", "--coverage"]).is(0).out.clone();
        let rows = out.lines().filter_map(|l| l.trim().strip_prefix("not reached: action "));
        rows.map(|r| r.split(" (./chart.g7:").map(str::to_owned).collect::<Vec<_>>().join(" "))
            .collect::<Vec<_>>()
    };
    let of_3 = ["N m 17:5)", "N Add 18:5)", "force H := INIT 19:5)"];
    let never = ["N k if c 10:5)"];
    for (profile, time, late) in [
        ("iec60848", "500ms", &["D 1s l 12:5)"][..]),
        ("iec60848", "2s", &[]),
        // In this profile the delay is part of the block.
        ("iec61131", "500ms", &[]),
    ] {
        let want = [&never[..], late, &of_3].concat();
        assert_eq!(missing(profile, time), want, "{profile} {time}");
    }
}

#[test]
fn json_and_junit_have_every_test() {
    let title = "<&\\\"'>";
    let folder =
        Folder::with(&format!("{PINGPONG}\ntest \"{title}\" {{ expect X2 }}\ntest \"good\" {{ scan 2 }}"));
    let ran = folder.g7(&["test", "--format", "json", "--junit", "out.xml", "--coverage"]);
    let all: serde_json::Value = serde_json::from_str(&ran.is(1).out).expect("JSON");
    assert_eq!((&all["passed"], &all["failed"]), (&1.into(), &1.into()));
    assert_eq!(all["tests"][0]["title"], "<&\"'>");
    assert_eq!(all["tests"][0]["failure"]["got"]["X2"], "FALSE");
    assert_eq!(all["tests"][1]["scans"], 3, "the first scan and two more");
    assert_eq!(all["coverage"][0]["steps"]["reached"], 1);
    let xml = folder.read("out.xml");
    assert!(xml.contains("<testsuites name=\"g7\" tests=\"2\" failures=\"1\""), "{xml}");
    assert!(xml.contains("name=\"&lt;&amp;&quot;'&gt;\""), "{xml}");
    assert!(xml.contains("<failure message=\"expected: X2\">"), "{xml}");
    assert_eq!(xml.matches("<testcase ").count(), 2);
}

#[test]
fn a_file_with_errors_fails_and_the_others_still_run() {
    let folder = Folder::with("chart {");
    folder.write("good.g7", format!("{PINGPONG}\ntest \"t\" {{ scan }}"));
    let ran = folder.g7(&["test"]);
    assert!(ran.is(1).out.contains("1 passed, 0 failed"), "{}", ran.out);
    assert!(ran.err.contains("chart.g7:1:"), "{}", ran.err);
}

#[test]
fn tests_run_under_another_profile_and_period() {
    let folder =
        Folder::with(&format!("{PINGPONG}\ntest \"t\" {{ set a := TRUE  scan  expect X2.t = 20ms }}"));
    folder.g7(&["test", "--scan", "20ms"]).is(0);
    folder.g7(&["test", "--scan", "20ms", "--profile", "pl7"]).is(0);
    folder.g7(&["test"]).is(1);
}

#[test]
fn each_property_is_left_to_the_prover() {
    let folder = Folder::with(&format!(
        "{PINGPONG}\nprove always X1\n  or X2\ntest \"t\" {{ scan }}\nprove reachable X2 \"once\"\nassume a or X1"
    ));
    let test = folder.g7(&["test"]);
    for text in ["left to g7 prove: prove always X1 or X2", "left to g7 prove: prove reachable X2 \"once\""] {
        assert!(test.is(0).out.contains(text), "{}", test.out);
        assert!(folder.g7(&["check"]).is(0).out.contains(text));
    }
    assert!(!test.out.contains("assume"), "an assumption claims nothing");
    assert!(test.out.ends_with("1 passed, 0 failed, 2 left to g7 prove\n"), "{}", test.out);
    let all: serde_json::Value =
        serde_json::from_str(&folder.g7(&["check", "--format", "json"]).is(0).out).expect("JSON");
    assert_eq!(all["not_proved"][1]["property"], "prove reachable X2 \"once\"");
    assert!(all["not_proved"][0]["place"].as_str().is_some_and(|p| p.ends_with("chart.g7:15:1")), "{all}");
    let wrong = Folder::with(&format!("{PINGPONG}\nprove always 1.5 * 2.0"));
    assert!(wrong.g7(&["check"]).is(1).out.contains("G02"), "types are checked");
}
