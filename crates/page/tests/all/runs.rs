//! Runs in the page: frames, forcing, going back in time, breakpoints, on-line changes.
#![allow(clippy::disallowed_methods, reason = "the tests read the examples")]

use crate::common;

use std::collections::BTreeMap;

use common::{Asked, Chance, example, examples};
use serde_json::{Value, json};

const CHART: &str = "input a : BOOL\ninput b : BOOL\noutput q : BOOL\nvar n : INT\nchart G {\n  initial step 1\n  step 2 { N q }\n  step 3\n  1 -> 2 when a\n  2 -> 3 when b\n  3 -> 1 when not a on clearing { n := n + 1 }\n}\n";
const A: usize = 0;
const B: usize = 1;
const Q: usize = 2;
const N: usize = 3;

fn started(text: &str) -> (Asked, Value) {
    let mut page = Asked::default();
    page.open(text);
    let start = page.ok(json!({ "do": "run_start", "file": "a.g7", "run": "r" }));
    (page, start)
}

fn advance(page: &mut Asked, ms: u64) -> Value {
    page.ok(json!({ "do": "run_advance", "run": "r", "ms": ms }))
}

fn full(page: &mut Asked) -> Value {
    page.ok(json!({ "do": "run_frame", "run": "r", "full": true, "times": true }))
}

fn value(frame: &Value, signal: usize) -> Option<&str> {
    frame["values"].as_array()?.iter().find(|v| v[0] == signal)?[1].as_str()
}

#[test]
fn a_run_begins_with_its_initial_situation() {
    let (_, start) = started(CHART);
    let frame = &start["frame"];
    assert_eq!((&frame["on"], &frame["scans"], &frame["now_ms"]), (&json!([0]), &json!(1), &json!(0.0)));
    assert_eq!(start["steps"][0]["id"], "G/s/1");
    assert_eq!(start["transitions"][2]["id"], "G/t/2");
    let roles: Vec<&str> =
        start["signals"].as_array().expect("signals").iter().filter_map(|s| s["role"].as_str()).collect();
    assert_eq!(roles, ["input", "input", "output", "variable"]);
    assert_eq!(frame["enabled"], json!([[0, 1]]), "enabled, and a is not true");
}

#[test]
fn the_page_sets_the_system_bits_of_pl7() {
    let (mut page, start) = started(&format!("profile pl7\n{CHART}"));
    let names: Vec<&str> =
        start["signals"].as_array().expect("signals").iter().filter_map(|s| s["name"].as_str()).collect();
    assert_eq!(names, ["a", "b", "q", "n", "%S0", "%S21", "%S22", "%S23"]);
    assert_eq!(start["signals"][5]["role"], "variable");
    page.ok(json!({ "do": "run_toggle", "run": "r", "signal": A }));
    assert_eq!(advance(&mut page, 10)["on"], json!([1]));
    page.ok(json!({ "do": "run_toggle", "run": "r", "signal": A }));
    let asked = page.ok(json!({ "do": "run_toggle", "run": "r", "signal": 5 }));
    assert_eq!(value(&asked, 5), Some("TRUE"));
    let done = advance(&mut page, 10);
    assert_eq!((&done["on"], &done["off"], value(&done, 5)), (&json!([0]), &json!([1]), Some("FALSE")));
    page.ok(json!({ "do": "run_set", "run": "r", "signal": 6, "value": "TRUE" }));
    assert_eq!(advance(&mut page, 10)["off"], json!([0]));
}

#[test]
fn a_frame_says_only_what_changed() {
    let (mut page, _) = started(CHART);
    let still = advance(&mut page, 100);
    assert_eq!((&still["on"], &still["values"], &still["enabled"]), (&json!([]), &json!([]), &json!([])));
    let toggled = page.ok(json!({ "do": "run_toggle", "run": "r", "signal": A }));
    assert_eq!(toggled["values"], json!([[A, "TRUE", 1.0]]));
    assert_eq!(toggled["on"], json!([]), "the chart has not read it yet");
    let moved = advance(&mut page, 10);
    assert_eq!((&moved["on"], &moved["off"], &moved["cleared"]), (&json!([1]), &json!([0]), &json!([0])));
    assert_eq!(moved["values"], json!([[Q, "TRUE", 1.0]]));
    assert_eq!(moved["enabled"], json!([[1, 1], [0, 0]]));
}

/// The knowledge of a page that has received all frames so far.
#[derive(Default, PartialEq, Debug)]
struct Known {
    on: Vec<u64>,
    enabled: BTreeMap<u64, u64>,
    values: BTreeMap<u64, String>,
    forced: BTreeMap<u64, bool>,
    view: BTreeMap<u64, String>,
}

impl Known {
    fn take(&mut self, frame: &Value) {
        if frame["full"] == true {
            *self = Known::default();
        }
        let list = |key: &str| frame[key].as_array().cloned().unwrap_or_default();
        let number = |v: &Value| v.as_u64().expect("a number");
        self.on.retain(|s| !list("off").iter().any(|o| number(o) == *s));
        self.on.extend(list("on").iter().map(number));
        self.on.sort_unstable();
        for e in list("enabled") {
            self.enabled.insert(number(&e[0]), number(&e[1]));
        }
        self.enabled.retain(|_, v| *v > 0);
        for v in list("values") {
            self.values.insert(number(&v[0]), v[1].to_string());
        }
        for f in list("forced") {
            self.forced.insert(number(&f[0]), f[1] == true);
        }
        self.forced.retain(|_, v| *v);
        for v in list("view") {
            self.view.insert(number(&v[0]), v[1].to_string());
        }
    }
}

#[test]
fn differences_add_up_to_the_whole() {
    let mut chance = Chance(3);
    for (path, text) in examples() {
        let mut page = Asked::default();
        page.open(&text);
        let Ok(start) = page.ask(json!({ "do": "run_start", "file": "a.g7", "run": "r" })) else { continue };
        let signals = start["signals"].as_array().map_or(0, Vec::len);
        let mut known = Known::default();
        known.take(&start["frame"]);
        for _ in 0..60 {
            let signal = chance.below(signals);
            let message = match chance.below(9) {
                0 | 1 => json!({ "do": "run_toggle", "run": "r", "signal": signal }),
                2 => json!({ "do": "run_force", "run": "r", "signal": signal, "value": "1" }),
                3 => json!({ "do": "run_release", "run": "r", "signal": signal }),
                4 => json!({ "do": "run_seek", "run": "r", "ms": chance.below(2_000) }),
                5 => json!({ "do": "run_live", "run": "r", "here": chance.below(3) == 0 }),
                6 => json!({ "do": "run_pass", "run": "r" }),
                _ => json!({ "do": "run_advance", "run": "r", "ms": chance.below(400) }),
            };
            if let Ok(frame) = page.ask(message) {
                known.take(&frame);
            }
        }
        let mut whole = Known::default();
        whole.take(&full(&mut page));
        assert_eq!(known, whole, "{path}");
    }
}

#[test]
fn a_scan_of_the_past_is_shown_as_it_was() {
    for file in
        ["bead-sorter/chart.g7", "bottle-conveyor/chart.g7", "two-tanks/chart.g7", "structure/gemma.g7"]
    {
        let (mut page, start) = started(&example(file));
        let inputs: Vec<usize> = start["signals"]
            .as_array()
            .expect("signals")
            .iter()
            .enumerate()
            .filter(|(_, s)| s["role"] == "input" && s["type"] == "bool")
            .map(|(i, _)| i)
            .collect();
        let mut chance = Chance(11);
        let mut seen = Vec::new();
        for _ in 0..120 {
            let signal = *chance.one(&inputs);
            page.ask(json!({ "do": "run_toggle", "run": "r", "signal": signal })).ok();
            if chance.below(10) == 0 {
                page.ok(json!({ "do": "run_restart", "run": "r", "warm": true }));
            }
            if chance.below(4) == 0 {
                page.ok(json!({ "do": "run_pass", "run": "r" }));
            }
            advance(&mut page, 10 * chance.below(30) as u64);
            // The past consists of whole scans only.
            let frame = page.ok(json!({ "do": "run_scan", "run": "r" }));
            let mut whole = full(&mut page);
            whole["cleared"] = frame["cleared"].clone();
            seen.push(whole);
        }
        for then in seen.iter().rev().step_by(7) {
            page.ok(json!({ "do": "run_seek", "run": "r", "ms": then["now_ms"] }));
            let now = full(&mut page);
            for key in ["now_ms", "scans", "on", "enabled", "values", "view", "times"] {
                assert_eq!(now[key], then[key], "{key} at {} in {file}", then["now_ms"]);
            }
        }
        assert_eq!(
            page.no(json!({ "do": "run_scan", "run": "r" })),
            "this is the past: come back to now, or go on from here"
        );
        page.ok(json!({ "do": "run_live", "run": "r" }));
        assert_eq!(full(&mut page)["now_ms"], seen.last().expect("a frame")["now_ms"]);
    }
}

#[test]
fn going_on_from_the_past_forgets_what_came_behind() {
    let (mut page, _) = started(CHART);
    advance(&mut page, 100);
    page.ok(json!({ "do": "run_toggle", "run": "r", "signal": A }));
    advance(&mut page, 100);
    page.ok(json!({ "do": "run_seek", "run": "r", "ms": 50 }));
    let here = page.ok(json!({ "do": "run_live", "run": "r", "here": true }));
    assert_eq!((&here["now_ms"], &here["live"]), (&json!(50.0), &json!(true)));
    let later = advance(&mut page, 200);
    assert_eq!((&later["now_ms"], &later["on"]), (&json!(250.0), &json!([])), "nobody toggles a here");
    let lanes = page.ok(json!({ "do": "run_lanes", "run": "r", "signals": [A], "from_ms": 0, "to_ms": 300 }));
    assert_eq!(lanes["lanes"][0], json!([[0.0, 0.0, "FALSE"]]));
}

#[test]
fn breakpoints_stop_at_activation_and_at_clearing() {
    let (mut page, _) = started(CHART);
    let ids = page.ok(json!({ "do": "run_breaks", "run": "r", "ids": ["G/s/2", "G/t/2", "G/s/nowhere"] }));
    assert_eq!(ids["ids"], json!(["G/s/2", "G/t/2"]));
    page.ok(json!({ "do": "run_toggle", "run": "r", "signal": A }));
    page.ok(json!({ "do": "run_toggle", "run": "r", "signal": B }));
    // Step 2 is active only within the scan: 1 -> 2 -> 3 clear in one search for stability.
    let stopped = advance(&mut page, 1_000);
    assert_eq!(
        (&stopped["stopped"]["id"], &stopped["now_ms"], &stopped["on"]),
        (&json!("G/s/2"), &json!(10.0), &json!([2]))
    );
    page.ok(json!({ "do": "run_toggle", "run": "r", "signal": A }));
    let again = advance(&mut page, 1_000);
    assert_eq!((&again["stopped"]["id"], &again["now_ms"]), (&json!("G/t/2"), &json!(20.0)));
    let on = advance(&mut page, 500);
    assert_eq!((&on["stopped"], &on["now_ms"]), (&Value::Null, &json!(520.0)));
}

#[test]
fn the_instances_of_a_chart_have_one_symbol_and_a_breakpoint_holds_for_all() {
    let text = "input a : ARRAY[1..2] OF BOOL\nchart Axis(i : INT) {\n initial step 1\n step 2\n 1 -> 2 when a[i]\n 2 -> 1 when not a[i]\n}\ninstance Axis[1..2]\n";
    let (mut page, run) = started(text);
    let steps = run["steps"].as_array().expect("steps").iter();
    let told: Vec<_> = steps.map(|s| (s["id"].as_str().unwrap(), s["instance"].as_str().unwrap())).collect();
    let (one, two) = ("Axis/s/1", "Axis/s/2");
    assert_eq!(told, [(one, "Axis[1]"), (two, "Axis[1]"), (one, "Axis[2]"), (two, "Axis[2]")]);
    let ids = page.ok(json!({ "do": "run_breaks", "run": "r", "ids": [two, "Axis/t/1"] }));
    assert_eq!(ids["ids"], json!([two, "Axis/t/1"]));
    let second = run["signals"].as_array().expect("signals").iter().position(|s| s["name"] == "a[2]");
    page.ok(json!({ "do": "run_toggle", "run": "r", "signal": second }));
    let stopped = advance(&mut page, 1_000);
    assert_eq!((&stopped["stopped"]["id"], &stopped["on"]), (&json!(two), &json!([3])));
}

#[test]
fn passes_show_the_transient_situations() {
    let (mut page, _) = started(CHART);
    page.ok(json!({ "do": "run_toggle", "run": "r", "signal": A }));
    page.ok(json!({ "do": "run_toggle", "run": "r", "signal": B }));
    let first = page.ok(json!({ "do": "run_pass", "run": "r" }));
    assert_eq!((&first["on"], &first["within"]), (&json!([1]), &json!(true)));
    assert_eq!(first["enabled"], json!([[1, 2], [0, 0]]), "enabled and true: it clears in the next pass");
    let second = page.ok(json!({ "do": "run_pass", "run": "r" }));
    assert_eq!((&second["on"], &second["off"]), (&json!([2]), &json!([1])));
    let last = page.ok(json!({ "do": "run_pass", "run": "r" }));
    assert_eq!((&last["within"], &last["now_ms"]), (&Value::Null, &json!(10.0)));
}

#[test]
fn true_receptivities_of_one_pass_profiles_clear_next() {
    let (mut page, _) = started(&format!("profile iec61131\n{CHART}"));
    page.ok(json!({ "do": "run_toggle", "run": "r", "signal": A }));
    page.ok(json!({ "do": "run_toggle", "run": "r", "signal": B }));
    let frame = page.ok(json!({ "do": "run_scan", "run": "r" }));
    assert_eq!((&frame["cleared"], &frame["enabled"]), (&json!([0]), &json!([[1, 2], [0, 0]])));
    assert_eq!(page.ok(json!({ "do": "run_scan", "run": "r" }))["cleared"], json!([1]));
}

#[test]
fn forced_values_are_marked_and_hold() {
    let (mut page, _) = started(CHART);
    let forced = page.ok(json!({ "do": "run_force", "run": "r", "signal": Q, "value": "TRUE" }));
    assert_eq!((&forced["forced"], value(&forced, Q)), (&json!([[Q, true]]), Some("TRUE")));
    advance(&mut page, 100);
    assert_eq!(value(&full(&mut page), Q), Some("TRUE"));
    let released = page.ok(json!({ "do": "run_release", "run": "r" }));
    assert_eq!((&released["forced"], value(&released, Q)), (&json!([[Q, false]]), Some("FALSE")));
    assert!(
        page.no(json!({ "do": "run_set", "run": "r", "signal": Q, "value": "1" })).contains("can be forced")
    );
    assert!(page.no(json!({ "do": "run_toggle", "run": "r", "signal": N })).contains("not a BOOL"));
    assert!(
        page.no(json!({ "do": "run_set", "run": "r", "signal": N, "value": "40000" })).contains("outside")
    );
    page.ok(json!({ "do": "run_set", "run": "r", "signal": N, "value": "-3" }));
    assert_eq!(value(&full(&mut page), N), Some("-3"));
}

#[test]
fn a_changed_text_is_taken_over_or_says_what_it_costs() {
    let (mut page, _) = started(CHART);
    page.ok(json!({ "do": "run_toggle", "run": "r", "signal": A }));
    advance(&mut page, 100);
    let swap = |force: bool| json!({ "do": "run_swap", "run": "r", "file": "a.g7", "force": force });
    page.ok(json!({ "do": "close", "file": "a.g7" }));
    page.open(&CHART.replace("2 -> 3 when b", "2 -> 3 when b and n = 0"));
    let taken = page.ok(swap(false));
    assert_eq!((&taken["frame"]["on"], &taken["frame"]["now_ms"]), (&json!([1]), &json!(100.0)));
    let lanes = page.ok(json!({ "do": "run_lanes", "run": "r", "signals": [A], "from_ms": 0, "to_ms": 300 }));
    assert_eq!(lanes["lanes"][0].as_array().map(Vec::len), Some(2), "what was recorded stays: {lanes}");
    page.open(&CHART.replace("step 2 ", "step 20 ").replace("2 ->", "20 ->").replace("-> 2 ", "-> 20 "));
    assert_eq!(page.ok(swap(false))["lost"], json!(["step `2` is active and no longer exists"]));
    assert_eq!(full(&mut page)["on"], json!([1]), "nothing was done");
    assert_eq!(page.ok(swap(true))["frame"]["on"], json!([]));
    page.open("chart G {");
    assert!(page.no(swap(true)).contains("cannot be run yet"));
}

#[test]
fn signals_go_out_as_files() {
    let (mut page, _) = started(CHART);
    page.ok(json!({ "do": "run_toggle", "run": "r", "signal": A }));
    advance(&mut page, 50);
    let file = |page: &mut Asked, form: &str| {
        let made = page.ok(json!({ "do": "run_export", "run": "r", "signals": [A, 5], "as": form }));
        made["text"].as_str().expect("a text").to_owned()
    };
    assert_eq!(file(&mut page, "csv"), "time,a,X2\n0,0,0\n0.01,1,1\n0.05,1,1\n");
    assert!(file(&mut page, "vcd").contains("$var wire 1 ! a $end"));
    assert!(file(&mut page, "svg").starts_with("<svg"));
    let lanes =
        page.ok(json!({ "do": "run_lanes", "run": "r", "signals": [99, A], "from_ms": 20, "to_ms": 40 }));
    assert_eq!(lanes["lanes"], json!([[], [[20.0, 1.0, "TRUE"]]]));
}

#[test]
fn two_profiles_run_side_by_side_on_the_same_inputs() {
    let mut page = Asked::default();
    page.open(CHART);
    page.ok(json!({ "do": "run_start", "file": "a.g7", "run": "a" }));
    page.ok(json!({ "do": "run_start", "file": "a.g7", "run": "b", "profile": "iec61131" }));
    let on: Vec<Value> = ["a", "b"]
        .iter()
        .map(|run| {
            page.ok(json!({ "do": "run_toggle", "run": run, "signal": A }));
            page.ok(json!({ "do": "run_toggle", "run": run, "signal": B }));
            page.ok(json!({ "do": "run_scan", "run": run }))["on"].clone()
        })
        .collect();
    assert_eq!(on, [json!([2]), json!([1])], "through to stability, and one pass");
}

#[test]
fn a_fault_is_told_with_its_place() {
    let text = "input n : INT\nvar m : INT\nchart G {\n initial step 1\n step 2 { P1 m := 10 / n }\n 1 -> 2 when n = 0\n}\n";
    let (_, start) = started(text);
    let halt = &start["frame"]["halt"];
    assert_eq!(halt["what"], "division by zero");
    assert_eq!(halt["ids"], json!(["G/a/2/0"]));
}

#[test]
fn scans_end_early_for_a_caller_who_cannot_wait() {
    let (mut page, started) = started(CHART);
    let mut scans = started["frame"]["scans"].as_u64().expect("a number");
    let message = json!({ "do": "run_advance", "run": "r", "ms": 1e9 });
    for (more, made) in [(3, 4), (0, 1)] {
        let mut left = more;
        let goes_on = move || {
            left -= 1;
            left >= 0
        };
        let frame = page.while_(&message, goes_on);
        scans += made;
        assert_eq!((&frame["late"], &frame["scans"]), (&json!(true), &json!(scans)), "{more}");
    }
    // The time that was due then is given up, and nobody is asked any more.
    let next = page.ok(json!({ "do": "run_advance", "run": "r", "ms": 0.0 }));
    assert_ne!(next["late"], true);
}

#[test]
fn long_runs_stay_within_bounds() {
    let (mut page, _) = started(CHART);
    for k in 0..200 {
        page.ok(json!({ "do": "run_toggle", "run": "r", "signal": k % 2 }));
        advance(&mut page, 10_000);
    }
    let late = page.ok(json!({ "do": "run_advance", "run": "r", "ms": 1e9, "most_scans": 50 }));
    assert_eq!(late["late"], true);
    let back = page.ok(json!({ "do": "run_seek", "run": "r", "ms": 999_990 }));
    assert_eq!((&back["now_ms"], &back["live"]), (&json!(999_990.0), &json!(false)));
}
