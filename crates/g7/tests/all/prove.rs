//! `g7 prove`, `g7 graph` and `g7 compare`: what they write beside their answers, and what they
//! say to wrong input.
#![allow(missing_docs, reason = "a test")]

use crate::common;

use common::{Folder, Ran};

/// A door: `a` opens it, `b` or 50 ms close it.
const DOOR: &str = "\
profile iec61131
scan 10ms
input a, b : BOOL
output m : BOOL
chart G {
  initial step 1
  step 2 { N m }
  1 -> 2 when a
  2 -> 1 when b or 50ms/X2
}
";

/// Saves what is refuted in the chart's own file; the tests must be so many and all fail.
#[track_caller]
fn saved(chart: &str, count: usize) -> (Folder, Ran) {
    let folder = Folder::with(chart);
    let ran = folder.g7(&["prove", "chart.g7", "--save", "chart.g7"]);
    assert!(ran.code == 1 && ran.err.contains("wrote"), "{}\n{}", ran.out, ran.err);
    let test = folder.g7(&["test"]);
    let all = format!("0 passed, {count} failed");
    assert!(test.is(1).out.contains(&all), "{all}\n{}\n{}", folder.read("chart.g7"), test.out);
    assert!(folder.read("chart.g7").starts_with(chart.trim_end()), "the chart stays as it is");
    folder.g7(&["fmt", "--check", "chart.g7"]).err.lines().for_each(drop);
    (folder, test)
}

/// The statements of the only test.
fn body(folder: &Folder) -> Vec<String> {
    let text = folder.read("chart.g7");
    let test = text.split("\ntest ").nth(1).expect("a test");
    test.lines().skip(1).map(|l| l.trim().to_owned()).filter(|l| l != "}" && !l.is_empty()).collect()
}

/// Mends the chart, and asks that the saved tests pass.
#[track_caller]
fn mended(folder: &Folder, from: &str, to: &str) {
    let text = folder.read("chart.g7");
    assert!(text.contains(from), "{text}");
    folder.write("chart.g7", text.replacen(from, to, 1));
    let test = folder.g7(&["test"]);
    assert!(test.is(0).out.contains(", 0 failed"), "{}", test.out);
}

#[test]
fn a_refuted_claim_is_a_test_that_fails_at_the_scan_that_breaks_it() {
    // A test begins with the initial values: one scan more than the shortest run, in which `a` comes at once.
    let (folder, test) = saved(&format!("{DOOR}prove never m and not a\n"), 1);
    assert_eq!(body(&folder), ["set a := TRUE", "set a := FALSE", "expect not (m and not a)"]);
    assert!(test.out.contains("prove never m and not a: expected: not (m and not a)"), "{}", test.out);
    assert!(test.out.contains("20ms after the start"), "{}", test.out);
    mended(&folder, "2 -> 1 when b or", "2 -> 1 when b or not a or");
    // A claim that is refuted anew takes the place of the old test.
    folder.write("chart.g7", folder.read("chart.g7").replace("b or not a or", "b or"));
    folder.g7(&["prove", "chart.g7", "--save", "chart.g7"]).is(1);
    assert_eq!(folder.read("chart.g7").matches("test \"prove never m and not a\"").count(), 1);
}

#[test]
fn each_form_of_claim_is_stated() {
    let one = |property: &str, statements: &[&str]| {
        let (folder, _) = saved(&format!("{DOOR}{property}\n"), 1);
        assert_eq!(body(&folder), statements, "{property}");
        folder
    };
    let open = ["set a := TRUE"];
    let with = |rest: &[&'static str]| [&open[..], rest].concat();
    let folder = one("prove always X1", &with(&["expect X1"]));
    mended(&folder, "1 -> 2 when a", "1 -> 2 when a and X2");
    let count = "expect BOOL_TO_INT(m) + BOOL_TO_INT(b) + BOOL_TO_INT(X2) <= 1";
    let folder = one("prove at most 1 of (m, b, X2)", &with(&[count]));
    mended(&folder, "step 2 { N m }", "step 2");
    // X2 lasts 50 ms and the scan of its transition: 35 ms are over in the fourth scan behind it.
    let folder = one("prove after X2 within 35ms expect X1", &with(&["wait until X1 within 30ms"]));
    mended(&folder, "50ms/X2", "20ms/X2");
    let folder = one("prove after X2 until X1 expect a", &with(&["set a := FALSE", "expect a or X1"]));
    mended(&folder, "2 -> 1 when b or", "2 -> 1 when b or not a or");
    // The claim is about the whole time between; what must not come comes in the second scan.
    let folder = one("prove between X2 and X1 never not a", &with(&["set a := FALSE", "expect a or X1"]));
    mended(&folder, "2 -> 1 when b or", "2 -> 1 when b or not a or");
    // Broken by the scan that begins it: the chart may also not come there.
    let folder = one("prove between X2 and X1 never m", &with(&["expect not m or X1 or not X2"]));
    mended(&folder, "step 2 { N m }", "step 2");
    // Where the assumptions forbid the initial values, the charts are started anew with others.
    let chart = format!("{DOOR}assume a or b\nprove never X2\n");
    let (folder, _) = saved(&chart, 1);
    assert_eq!(body(&folder), ["set a := TRUE", "restart cold", "expect not X2"]);
}

#[test]
fn a_cause_whose_effect_needs_other_inputs_meanwhile_is_stated_too() {
    // The lamp goes on again whenever `a` is as it was: only a change keeps it off.
    let chart = "\
profile iec61131
scan 10ms
input a : BOOL
chart G {
  initial step 1
  step 2
  step 3
  1 -> 2 when a
  2 -> 3 when not a
  3 -> 2 when a
}
prove after X2 within 20ms expect X2 and X2.t > 0s
";
    let (folder, _) = saved(chart, 1);
    let body = body(&folder);
    assert!(body.last().is_some_and(|l| l == "expect X2 and X2.t > 0s"), "{body:?}");
    assert!(body.iter().any(|l| l.contains("may have come before")), "{body:?}");
}

#[test]
fn what_leads_nowhere_waits_at_its_end() {
    let trap = "\
profile iec61131
input a, b : BOOL
chart G {
  initial step 1
  step 2
  step 3
  1 -> 2 when a
  2 -> 1 when a
  2 -> 3 when b and not a
  (1, 3) -> 1 when a
}
prove X2 leads to X1
";
    let (folder, test) = saved(trap, 2);
    let text = folder.read("chart.g7");
    for part in ["wait until not X3", "wait until X1", "test \"prove no deadlock\"", "write here what must"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert!(test.out.contains("not true within 10s"), "{}", test.out);
    mended(&folder, "(1, 3) -> 1 when a", "3 -> 1 when =1");
}

#[test]
fn faults_and_conflicts_are_tests_too() {
    let divides = "\
profile iec61131
input a : BOOL
var n : INT := 1
var m : INT
chart G {
  initial step 1
  step 2 { P1 { n := n - 1; m := 10 / n } }
  1 -> 2 when a
  2 -> 1 when not a
}
";
    let (folder, test) = saved(divides, 1);
    assert!(test.out.contains("prove no fault: fault: division"), "{}", test.out);
    mended(&folder, "m := 10 / n", "if n <> 0 then m := 10 / n; end_if");
    let both = "\
profile iec60848
input a, b : BOOL
chart G {
  initial step 1
  step 2
  step 3
  1 -> 2 when a
  1 -> 3 when b
  2 -> 1 when not a
  3 -> 1 when not b
}
";
    let (folder, _) = saved(both, 1);
    let body = body(&folder);
    assert_eq!(body.last().map(String::as_str), Some("expect not (X2 and X3)"), "{body:?}");
    mended(&folder, "1 -> 3 when b", "1 -> 3 when b and not a");
}

#[test]
fn what_no_test_can_state_is_said() {
    let folder = Folder::with(&format!("{DOOR}prove reachable X1 and m\n"));
    let ran = folder.g7(&["prove", "chart.g7", "--save", "new.g7"]);
    assert!(ran.is(1).err.contains("nothing to save"), "{}", ran.err);
    assert!(ran.err.contains("not saved: prove reachable X1 and m: it says that some run"), "{}", ran.err);
    assert_eq!(folder.names(), ["chart.g7"]);
}

#[test]
fn a_file_that_is_there_is_not_lost() {
    let folder = Folder::with(&format!("{DOOR}prove never X2\n"));
    folder.write("other.g7", "kept");
    let save = ["prove", "chart.g7", "--save", "other.g7"];
    folder.g7(&save).is_refused(&["other.g7 already exists", "--force"]);
    assert_eq!(folder.read("other.g7"), "kept");
    folder.g7(&[&save[..], &["--force"]].concat()).is(1);
    assert!(folder.read("other.g7").contains("test \"prove never X2\""));
    folder.g7(&["test", "other.g7"]).is(1);
    // Two charts have two files.
    folder.g7(&["prove", ".", "--save", "third.g7"]).is_refused(&["--save takes one chart", "2"]);
    folder.g7(&["prove", "chart.g7", "--save", "x.g7", "--tests", "x.g7"]).is_refused(&["one file"]);
    let nowhere = folder.g7(&["prove", "chart.g7", "--save", "no/such/folder.g7"]);
    assert!(nowhere.code == 2 && nowhere.err.contains("nothing was changed"), "{}", nowhere.err);
}

/// The scenarios reach all that can be reached, and each passes.
#[test]
fn scenarios_reach_everything() {
    let chart = "\
profile iec61131
scan 10ms
input a, b : BOOL
input n : INT
output m, l : BOOL
output k : INT
var count : INT
chart G {
  initial step 1
  step 2 {
    N m
    N l if b
    P1 count := 1
  }
  step 3 { P1 k := 7 }
  step 4
  1 -> 2 when a
  1 -> 3 when b and n > 100
  2 -> 1 when 100ms/X2
  3 -> 1 when not b
  3 -> 4 when a and not a
}
";
    let folder = Folder::with(chart);
    let ran = folder.g7(&["prove", "chart.g7", "--tests", "all.g7"]);
    for row in ["3 of 4 steps", "4 of 5 transitions", "4 of 4 actions", "3 of 4 branches"] {
        assert!(ran.err.contains(&format!("{row} reached")), "{row}: {}", ran.err);
    }
    let test = folder.g7(&["test", "--coverage", "all.g7"]);
    assert!(test.is(0).out.contains("1 passed, 0 failed"), "{}\n{}", folder.read("all.g7"), test.out);
    let missing: Vec<&str> = test.out.lines().filter(|l| l.contains("not reached")).collect();
    assert_eq!(missing.len(), 3, "{missing:?}");
    assert!(missing.iter().all(|l| l.contains("step 4") || l.contains("3 -> 4")), "{missing:?}");
    let text = folder.read("all.g7");
    // All that changes is expected, and nothing else.
    for part in ["expect X2, not X1, m", "  scan 9\n", "k = 7", "set b := TRUE", "n := 101", "reaches "] {
        assert!(text.contains(part), "{part}: {text}");
    }
    // A second time the same tests stand there, not twice as many.
    folder.g7(&["prove", "all.g7", "--tests", "all.g7"]);
    assert_eq!(folder.read("all.g7"), text);
}

#[test]
fn scenarios_keep_the_assumptions() {
    let chart = format!("{DOOR}assume not (a and b)\nassume a or X1 or b\n");
    let folder = Folder::with(&chart);
    let ran = folder.g7(&["prove", "chart.g7", "--tests", "chart.g7"]);
    assert!(ran.err.contains("2 of 2 transitions reached"), "{}", ran.err);
    let text = folder.read("chart.g7");
    assert!(folder.g7(&["test"]).is(0).out.contains(", 0 failed"), "{text}");
    assert!(!text.contains("a := TRUE, b := TRUE"), "{text}");
}

#[test]
fn the_log_for_code_review_has_the_runs() {
    let folder = Folder::with(&format!("{DOOR}prove never m and not a\nprove always X1 or X2\n"));
    let log: serde_json::Value =
        serde_json::from_str(&folder.g7(&["prove", "chart.g7", "--format", "sarif"]).is(1).out)
            .expect("JSON");
    assert_eq!(log["version"], "2.1.0");
    let run = &log["runs"][0];
    let results = run["results"].as_array().expect("results");
    assert_eq!(results.len(), 1, "what is proved is no finding: {results:?}");
    let r = &results[0];
    assert_eq!(
        (&r["ruleId"], &r["level"], &r["kind"]),
        (&"property".into(), &"error".into(), &"fail".into())
    );
    let rules = run["tool"]["driver"]["rules"].as_array().expect("rules");
    assert_eq!(rules[r["ruleIndex"].as_u64().expect("an index") as usize]["id"], "property");
    let at = &r["locations"][0]["physicalLocation"];
    assert_eq!(
        (&at["artifactLocation"]["uri"], &at["region"]["startLine"]),
        (&"chart.g7".into(), &11.into())
    );
    let flow = r["codeFlows"][0]["threadFlows"][0]["locations"].as_array().expect("the run");
    assert_eq!(flow.len(), 2, "a scan each");
    assert_eq!(flow[1]["location"]["message"]["text"], "at 10ms: a = FALSE; then {2}");
    let all: serde_json::Value =
        serde_json::from_str(&folder.g7(&["prove", "chart.g7", "--format", "sarif", "--all"]).out)
            .expect("JSON");
    let kinds = |k: &str| {
        all["runs"][0]["results"].as_array().map_or(0, |l| l.iter().filter(|r| r["kind"] == k).count())
    };
    assert!(kinds("pass") > 5 && kinds("fail") == 1);
}

#[test]
fn the_report_for_build_servers_counts() {
    let chart = format!("{DOOR}prove never X2 \"<&>\"\n")
        .replace("input a, b : BOOL", "input a, b : BOOL\ninput x : REAL\noutput y : REAL");
    let chart = chart.replace("2 -> 1", "1 -> 2 when x / 2.0 > 1.0 and b\n  2 -> 1");
    let folder = Folder::with(&chart);
    folder.g7(&["prove", "chart.g7", "--junit", "out.xml"]).is(1);
    let text = folder.read("out.xml");
    let count = |what: &str| text.matches(what).count();
    let head = text.lines().nth(2).expect("the suite");
    for (attribute, what) in [("tests", "<testcase"), ("failures", "<failure"), ("skipped", "<skipped")] {
        assert!(head.contains(&format!("{attribute}=\"{}\"", count(what))), "{head}\n{text}");
    }
    assert!(count("<failure") > 0 && count("<skipped") > 0 && text.contains("&lt;&amp;&gt;"), "{text}");
}

#[test]
fn a_graph_has_the_situations_and_their_conditions() {
    let chart = "\
profile iec60848
input a, b, c : BOOL
chart G {
  initial step 1
  step 2
  step 3
  1 -> 2 when a and not b or c
  2 -> 1 when not a and not c and b
  2 -> 3 when 100ms/X2 and b and c
}
";
    let folder = Folder::with(chart);
    let ran = folder.g7(&["graph", "chart.g7", "--as", "json"]);
    let graph: serde_json::Value = serde_json::from_str(&ran.is(0).out).expect("JSON");
    assert_eq!(graph["complete"], true);
    let nodes = graph["nodes"].as_array().expect("nodes");
    let steps: Vec<String> = nodes.iter().map(|n| n["steps"].to_string()).collect();
    assert_eq!(steps, ["[]", "[\"1\"]", "[\"2\"]", "[\"3\"]"]);
    let edge = |from: u64, to: u64| {
        let edges = graph["edges"].as_array().expect("edges");
        let found = edges.iter().find(|e| e["from"] == from && e["to"] == to);
        found.map(|e| (e["inputs"].as_str().unwrap_or("-").to_owned(), e["transitions"][0].to_string()))
    };
    assert_eq!(edge(1, 2), Some(("a · not b + c".into(), "\"1 -> 2\"".into())));
    assert_eq!(edge(2, 1), Some(("not a · b · not c".into(), "\"2 -> 1\"".into())));
    assert_eq!(edge(2, 3), Some(("b · c".into(), "\"2 -> 3\"".into())));
    // In the first scan an evolution may go on at once.
    assert_eq!(edge(0, 2).map(|e| e.0), Some("a · not b + c".into()));
    assert_eq!(edge(1, 3), None);
    let dot = folder.g7(&["graph", "chart.g7"]);
    assert!(dot.is(0).out.contains("n1 -> n2 [label=\"a · not b + c\""), "{}", dot.out);
    assert!(dot.err.contains("3 situations and"), "{}", dot.err);
    folder.g7(&["graph", "chart.g7", "-o", "g.svg"]).is(0);
    let svg = folder.read("g.svg");
    assert!(svg.contains("a · not b + c") && svg.contains(">{3}<"), "{svg}");
    folder.g7(&["graph", "chart.g7", "-o", "g.png"]).is_refused(&[".dot, .json, .svg"]);
    folder.g7(&["graph", "chart.g7", "--most", "2"]).is_refused(&["3 situations are too many", "--as json"]);
    // Data are not bounded; what is cut short is said.
    folder.g7(&["graph", "chart.g7", "--most", "2", "--as", "json"]).is(0);
    let cut = folder.g7(&["graph", "chart.g7", "--as", "json", "--states", "2"]);
    assert!(cut.is(3).out.contains("\"complete\": false") && cut.err.contains("not complete"), "{}", cut.err);
}

#[test]
fn a_comparison_shows_both_at_the_first_difference() {
    let folder = Folder::new();
    folder.write("a.g7", DOOR);
    folder.write("b.g7", DOOR.replace("50ms/X2", "40ms/X2"));
    let ran = folder.g7(&["compare", "a.g7", "b.g7"]);
    let out = &ran.is(1).out;
    assert!(out.starts_with("different: after 5 scans output `m` has two values"), "{out}");
    let lanes: Vec<&str> = out.lines().filter_map(|l| l.split_whitespace().next()).collect();
    let place = |lane: &str| lanes.iter().filter(|l| **l == lane).count();
    // Once what is common, twice what is told apart.
    assert_eq!((place("a"), place("m")), (1, 0), "{out}");
    assert!(
        out.contains("1: m") && out.contains("2: m") && out.contains("1: X1") && out.contains("2: X1"),
        "{out}"
    );
    folder.g7(&["compare", "a.g7", "a.g7"]).is(0);
}

#[test]
fn assumptions_that_contradict_each_other_are_an_error() {
    let wrong = |assume: &str, parts: &[&str]| {
        let folder = Folder::with(&format!("{DOOR}prove never X1 and X2\n{assume}\n"));
        let ran = folder.g7(&["prove", "chart.g7"]);
        ran.is(1);
        for part in parts {
            assert!(ran.err.contains(part), "{assume}: {part}: {}", ran.err);
        }
        assert!(!ran.out.contains("proved: prove never X1 and X2"), "{assume}: {}", ran.out);
    };
    wrong("assume a and not a", &["chart.g7:12:1: error: no input satisfies this assumption"]);
    wrong(
        "assume a\nassume not a",
        &["chart.g7:12:1: error: no input satisfies the assumptions of this file"],
    );
    // It says nothing against X1, and contradicts itself when step 2 was reached.
    wrong("assume X1 or a and not a", &["behind a run of 1 scan no input satisfies", "X2 ▔"]);
    // Late, by time alone: the fourth scan would be 30 ms behind the first one.
    wrong("assume a and (not X2 or X2.t < 30ms)", &["behind a run of 3 scans no input satisfies"]);
}

#[test]
fn unknown_names_are_problems() {
    for property in ["prove never X7", "prove reachable nothing > 3", "assume not (a and c)"] {
        let folder = Folder::with(&format!("{DOOR}{property}\n"));
        let ran = folder.g7(&["prove", "chart.g7"]);
        assert!(ran.is(1).err.contains("error[G02"), "{property}: {}", ran.err);
        folder.g7(&["graph", "chart.g7"]).is(1);
    }
}

#[test]
fn what_is_decided_stays_when_the_time_is_over() {
    // A counter with far too many states; the first scans decide most questions.
    let chart = "\
profile iec61131
input a, b, c, d : BOOL
output m : BOOL
var n, k : DINT
chart G {
  initial step 1
  step 2 { P1 { n := n + 1 } }
  1 -> 2 when a
  2 -> 1 when b
}
chart H {
  initial step 11
  step 12 { P1 { k := k + 3 } N m }
  11 -> 12 when c
  12 -> 11 when d
}
prove never X12
prove never n = 2000000
";
    let folder = Folder::with(chart);
    let ran = folder.g7(&["prove", "chart.g7", "--time", "1s", "--all"]);
    ran.is(1);
    for part in
        ["proved: step 12 can be active", "refuted: prove never X12", "not decided: prove never n = 2000000"]
    {
        assert!(ran.out.contains(part), "{part}: {}", ran.out);
    }
    assert!(ran.out.contains("--time"), "{}", ran.out);
}

#[test]
fn a_claim_about_chart_and_plant_is_a_test_with_the_plant() {
    // 2 are added in each tick but the first: 82 comes with tick 42, which is 41 scans after the first.
    let chart = concat!(include_str!("../../../page/tests/tank.g7"), "prove X1 leads to X0 with Tank\n");
    let (folder, test) = saved(chart, 1);
    assert_eq!(body(&folder), ["wait 10.25s", "expect level <= 80.0"]);
    assert!(folder.read("chart.g7").contains("with Tank\" with Tank {"), "{}", folder.read("chart.g7"));
    assert!(test.out.contains("got level = 82.0"), "{}", test.out);
    mended(&folder, "level >= 90.0", "level >= 80.0");
    // All that is asked of every chart is asked in the loop too.
    let ran = folder.g7(&["prove", "chart.g7", "--plant", "Tank"]);
    assert!(ran.is(0).out.contains(", 0 refuted, 0 not decided"), "{}", ran.out);
    let ran = folder.g7(&["prove", "chart.g7", "--plant", "Tonk"]);
    assert!(ran.code == 2 && ran.err.contains("no plant `Tonk`; it has Tank"), "{}", ran.err);
}
