//! Tests of the names in a path: grammar.md, the end of "Expressions".

use super::{ask, outcome, read, resolved};

const DOCUMENT: &str = "
input go, stop : BOOL at %I0.1
var count, X9 : INT
var c : CTU
chart G {
  var count : BOOL
  var timer : TON
  initial step 1
  step 12
  step Fill
  step 9
  macro M3 = Dose
  macro 4 = Mix
  1 -> 12 when go -> Fill when go -> 9 when go -> M3 when go -> 4 when go -> 1 when go
}
macrochart Dose {
  var grams : INT
  entry step E
  step 12
  exit step S
  macro M5 = Inner
  E -> 12 when go -> M5 when go -> S when go
}
macrochart Inner { entry step E  exit step S  E -> S when go }
macrochart Mix { entry step A  step 2  exit step S  A -> 2 when go -> S when go }
chart H {
  var own : INT
  initial step 1
  step 20
  1 -> 20 when go -> 1 when stop
}
";

/// Seen from the file, from G, from the expansion of M3, from H.
const TABLE: &[(&str, [&str; 4])] = &[
    ("go", ["go : BOOL", "go : BOOL", "go : BOOL", "go : BOOL"]),
    ("count", ["count : INT", "G.count : BOOL", "count : INT", "count : INT"]),
    ("G.count", ["G.count : BOOL", "G.count : BOOL", "G.count : BOOL", "G.count : BOOL"]),
    ("own", ["G0202", "G0202", "G0202", "H.own : INT"]),
    ("H.own", ["H.own : INT", "H.own : INT", "H.own : INT", "H.own : INT"]),
    ("Dose.grams", ["Dose.grams : INT"; 4]),
    ("M3.grams", ["Dose.grams : INT"; 4]),
    ("c.Q", ["c#3 : BOOL"; 4]),
    ("c.CV", ["c#4 : INT"; 4]),
    ("c.RESET", ["c#1 : BOOL"; 4]),
    ("c.out", ["G0206"; 4]),
    ("go.Q", ["G0206"; 4]),
    ("G.timer.ET", ["G.timer#3 : TIME"; 4]),
    ("timer.Q", ["G0202", "G.timer#2 : BOOL", "G0202", "G0202"]),
    // Activity: of the chart itself, else the only one of the document, else
    // the only one of the charts, expansions apart.
    ("X20", ["active H.20 : BOOL"; 4]),
    ("X12", ["active G.12 : BOOL", "active G.12 : BOOL", "active G.M3.12 : BOOL", "active G.12 : BOOL"]),
    ("X1", ["G0203", "active G.1 : BOOL", "G0203", "active H.1 : BOOL"]),
    ("XE", ["G0203", "G0203", "active G.M3.E : BOOL", "G0203"]),
    ("XA", ["active G.4.A : BOOL"; 4]),
    ("G.X12", ["active G.12 : BOOL"; 4]),
    ("M3.X12", ["active G.M3.12 : BOOL"; 4]),
    ("G.M3.X12", ["active G.M3.12 : BOOL"; 4]),
    ("Dose.X12", ["active G.M3.12 : BOOL"; 4]),
    ("M3.M5.XE", ["active G.M3.M5.E : BOOL"; 4]),
    ("M3.M5.E.X", ["active G.M3.M5.E : BOOL"; 4]),
    ("Fill.X", ["active G.Fill : BOOL"; 4]),
    ("XFill", ["active G.Fill : BOOL"; 4]),
    ("G.Fill.X", ["active G.Fill : BOOL"; 4]),
    ("XM3", ["active G.M3 : BOOL"; 4]),
    ("M3.X", ["active G.M3 : BOOL"; 4]),
    ("G.XM3", ["active G.M3 : BOOL"; 4]),
    ("XM4", ["active G.4 : BOOL"; 4]),
    ("X4", ["active G.4 : BOOL"; 4]),
    // A variable of that spelling goes first.
    ("X9", ["X9 : INT"; 4]),
    ("G.X9", ["active G.9 : BOOL"; 4]),
    // Times.
    ("Fill.t", ["time G.Fill : TIME"; 4]),
    ("Fill.T", ["time G.Fill : TIME"; 4]),
    ("G.X12.t", ["time G.12 : TIME"; 4]),
    ("X20.T", ["time H.20 : TIME"; 4]),
    ("M3.t", ["time G.M3 : TIME"; 4]),
    ("M3.X12.t", ["time G.M3.12 : TIME"; 4]),
    ("Fill.s", ["G0206"; 4]),
    ("Fill.x", ["G0206"; 4]),
    ("X12.X", ["G0206"; 4]),
    // Direct names.
    ("%I0.1", ["go : BOOL"; 4]),
    ("%IX0.1", ["go : BOOL"; 4]),
    ("%X12", ["active G.12 : BOOL"; 4]),
    ("%X12.T", ["tenths G.12 : INT"; 4]),
    ("%XM3", ["active G.M3 : BOOL"; 4]),
    ("%XM4", ["active G.4 : BOOL"; 4]),
    ("%X3.12", ["active G.M3.12 : BOOL"; 4]),
    ("%X4.2.T", ["tenths G.4.2 : INT"; 4]),
    ("%X3.IN", ["active G.M3.E : BOOL"; 4]),
    ("%X3.OUT.T", ["tenths G.M3.S : INT"; 4]),
    ("%X5.IN", ["active G.M3.M5.E : BOOL"; 4]),
    ("%X20", ["G0204"; 4]),
    ("%S21", ["%S21 : BOOL"; 4]),
    ("%SW20", ["%SW20 : INT"; 4]),
    ("%S6", ["G0207"; 4]),
    ("%Q0.0", ["G0207"; 4]),
    // Nothing of the kind.
    ("X77", ["G0204"; 4]),
    ("G.X77", ["G0204"; 4]),
    ("M3.X1", ["G0204"; 4]),
    ("Fill", ["G0208"; 4]),
    ("G", ["G0208"; 4]),
    ("G.Fill", ["G0208"; 4]),
    ("Nothing.X", ["G0202"; 4]),
    ("c", ["c : CTU"; 4]),
];

#[test]
fn paths_name_what_the_grammar_says() {
    let text =
        DOCUMENT.replace("input go, stop : BOOL at %I0.1", "input go : BOOL at %I0.1 input stop : BOOL");
    let doc = read(&text);
    let (mut unit, mut scopes) = resolved(&doc);
    let charts = [None, scopes.chart("G"), scopes.chart("Dose"), scopes.chart("H")];
    assert!(charts.iter().skip(1).all(Option::is_some));
    for (path, want) in TABLE {
        for (chart, want) in charts.iter().zip(want) {
            let got = ask(&mut unit, &mut scopes, path, *chart);
            let from = chart.map_or("the file", |c| &*unit.charts[c.index()].name).to_owned();
            assert_eq!(outcome(&unit, got), *want, "{path} from {from}");
        }
    }
}

#[test]
fn a_system_bit_is_one_variable_however_often_it_is_named() {
    let doc = read("chart G { initial step 1  step 2  1 -> 2 when %S22 or %S22 -> 1 when not %S22 }");
    let (mut unit, mut scopes) = resolved(&doc);
    let before = unit.vars.len();
    assert_eq!(unit.vars.iter().filter(|v| &*v.name == "%S22").count(), 1);
    assert!(ask(&mut unit, &mut scopes, "%S22", None).is_ok());
    assert_eq!(unit.vars.len(), before);
}

#[test]
fn jgrafchart_counts_scans() {
    let doc = read(
        "profile jgrafchart
         chart G { initial step 1  step Fill  1 -> Fill when =1 -> 1 when Fill.t > 3 }",
    );
    let (mut unit, mut scopes) = resolved(&doc);
    for (path, want) in [
        ("Fill.t", "scans G.Fill : INT"),
        ("Fill.T", "scans G.Fill : INT"),
        ("X1.t", "scans G.1 : INT"),
        ("Fill.s", "seconds G.Fill : REAL"),
        ("Fill.x", "active G.Fill : BOOL"),
        ("Fill.X", "active G.Fill : BOOL"),
    ] {
        let got = ask(&mut unit, &mut scopes, path, None);
        assert_eq!(outcome(&unit, got), want, "{path}");
    }
}

/// The meaning of a step name without its chart does not depend on the order of the charts.
#[test]
fn steps_of_charts_come_before_those_of_expansions_and_tasks() {
    const CHART: &str = "chart G { initial step 1  step 2  macro M = D  step 5 { call T }
        1 -> 2 when =1 -> M when =1 -> 5 when =1 -> 1 when =1 }";
    const EXPANSION: &str = "macrochart D { entry step 1  step 7  exit step 3  1 -> 7 when =1 -> 3 when =1 }";
    const TASK: &str =
        "task T { entry step 1  step 2  step 7  exit step 3  1 -> 2 when =1 -> 7 when =1 -> 3 when =1 }";
    const OTHER: &str = "chart H { initial step 11  step 2  11 -> 2 when =1 -> 11 when =1 }";
    for order in
        [[CHART, EXPANSION, TASK, OTHER], [TASK, OTHER, EXPANSION, CHART], [EXPANSION, TASK, CHART, OTHER]]
    {
        let doc = read(&order.join("\n"));
        let (mut unit, mut scopes) = resolved(&doc);
        for (path, from, want) in [
            ("X1", None, "active G.1 : BOOL"),
            ("X1", Some("H"), "active G.1 : BOOL"),
            ("X1", Some("T"), "active T.1 : BOOL"),
            ("X1.t", None, "time G.1 : TIME"),
            ("X2", None, "G0203"),
            ("X2", Some("D"), "G0203"),
            ("X3", None, "G0203"),
            ("X7", Some("G"), "G0203"),
            ("X7", Some("D"), "active G.M.7 : BOOL"),
            ("X11", Some("T"), "active H.11 : BOOL"),
        ] {
            let chart = from.and_then(|c| scopes.chart(c));
            let got = ask(&mut unit, &mut scopes, path, chart);
            assert_eq!(outcome(&unit, got), want, "{path} from {from:?} in\n{}", order.join("\n"));
        }
    }
}

/// `ā` is one letter to Unicode, so it is no `a̅`.
#[test]
fn a_letter_with_a_macron_is_told_from_an_overline() {
    let doc = read("input a, b : BOOL  var n : INT  chart G { var o : BOOL  initial step 1  1 -> 1 when a }");
    let (mut unit, mut scopes) = resolved(&doc);
    for (path, from, want) in [
        ("ā", None, Some("write `not a`, `a'` or `/a`")),
        ("b · ā", Some("G"), Some("write `not a`, `a'` or `/a`")),
        ("ō", Some("G"), Some("write `not o`, `o'` or `/o`")),
        ("G.ō", None, Some("write `not o`, `o'` or `/o`")),
        // Not seen from here; nothing of that name.
        ("ō", None, None),
        ("ē", None, None),
    ] {
        let chart = from.and_then(|c| scopes.chart(c));
        let problems = ask(&mut unit, &mut scopes, path, chart).expect_err(path);
        assert_eq!(problems.iter().map(|p| p.code.id).collect::<Vec<_>>(), ["G0202"], "{path}");
        assert_eq!(problems[0].help.as_deref(), want, "{path} from {from:?}");
    }
}
