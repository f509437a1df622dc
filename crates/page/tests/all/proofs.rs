//! The panel *Prove*: answers as data, their runs repeated on the bench, and the changes of the text
//! that a refuted claim offers.
#![allow(clippy::disallowed_methods, reason = "the common part reads the examples")]

use crate::common;

use common::Asked;
use serde_json::{Value, json};

/// Step 1 has two ways on, which `a` and `b` can open together; nothing leads to step 4.
const FORK: &str = "input a, b, back : BOOL\noutput M : BOOL\nchart G {\n  initial step 1\n  step 2 { N M }\n  step 3\n  step 4\n  1 -> 2 when a\n  1 -> 3 when b\n  2 -> 1 when ↑back\n  3 -> 1 when ↑back\n  4 -> 1 when a\n}\n\nprove never X2 and X3\nprove reachable M\n\nlayout G {\n  comment \"why\" at (10, 2)\n}\n";

fn prove(page: &mut Asked, states: usize) -> Vec<Value> {
    let report = page.ok(json!({ "do": "prove", "file": "a.g7", "states": states, "mib": 64 }));
    report["rows"].as_array().expect("rows").clone()
}

fn row(rows: &[Value], claim: &str) -> Value {
    let found = rows.iter().find(|r| r["claim"][0].as_str().is_some_and(|c| c.starts_with(claim)));
    found.unwrap_or_else(|| panic!("{claim}: {rows:#?}")).clone()
}

fn ways(page: &mut Asked, row: &Value) -> Value {
    let hash = page.ok(json!({ "do": "look", "file": "a.g7" }))["hash"].clone();
    let run = row["run"].clone();
    page.ok(
        json!({ "do": "prove_ways", "file": "a.g7", "hash": hash, "question": row["number"], "run": run }),
    )
}

fn take(page: &mut Asked, splices: &Value) -> String {
    page.ok(json!({ "do": "splice", "file": "a.g7", "splices": splices, "unit": true }));
    page.text()
}

#[test]
fn every_question_has_an_answer_in_three_languages() {
    let mut page = Asked::default();
    page.open(FORK);
    let rows = prove(&mut page, 1000);
    let own = row(&rows, "prove never X2 and X3");
    assert_eq!((&own["own"], &own["verdict"], &own["line"]), (&json!(true), &json!("refuted"), &json!(15)));
    let dead = row(&rows, "step 4 can be active");
    assert_eq!((&dead["verdict"], &dead["id"]), (&json!("refuted"), &json!("G/s/4")));
    assert_eq!(dead["claim"][1], "l’étape 4 peut être active");
    assert_eq!(dead["claim"][2], "a etapa 4 pode estar ativa");
    assert_eq!(row(&rows, "transition 4 -> 1")["id"], "G/t/4");
    assert_eq!(row(&rows, "no deadlock")["verdict"], "proved");
    let conflict = row(&rows, "no conflict");
    assert_eq!(conflict["blame"], json!(["G/s/1", "G/t/0", "G/t/1"]));
    assert!(rows.iter().all(|r| r["verdict"] != "open"), "{rows:#?}");
}

#[test]
fn a_file_with_errors_is_not_asked() {
    let mut page = Asked::default();
    page.open(&FORK.replace("when ↑back", "when nothing"));
    let report = page.ok(json!({ "do": "prove", "file": "a.g7", "states": 9, "mib": 1 }));
    assert_eq!((&report["refused"], &report["rows"]), (&json!(true), &json!([])));
}

#[test]
fn a_search_that_is_cut_goes_on_with_what_is_open() {
    let mut page = Asked::default();
    page.open(FORK);
    let open = |rows: &[Value]| rows.iter().filter(|r| r["verdict"] == "open").count();
    let first = prove(&mut page, 1);
    assert!(open(&first) > 0, "one state is not all");
    let kept = row(&first, "step 1 can be active");
    let second = prove(&mut page, 1000);
    assert_eq!(open(&second), 0);
    assert_eq!(row(&second, "step 1 can be active"), kept);
    page.ok(
        json!({ "do": "splice", "file": "a.g7", "splices": [{ "from": 0, "to": 0, "insert": "// x\n" }] }),
    );
    assert_eq!(row(&prove(&mut page, 1000), "prove never")["line"], 16, "another text is asked anew");
}

#[test]
fn the_run_of_an_answer_is_repeated_on_the_bench() {
    let mut page = Asked::default();
    page.open(FORK);
    let rows = prove(&mut page, 1000);
    let run = row(&rows, "prove never X2 and X3")["run"].clone();
    let scans = run.as_array().expect("scans").len();
    let started =
        page.ok(json!({ "do": "run_start", "file": "a.g7", "run": "r", "plant": "none", "moves": run }));
    assert_eq!(started["frame"]["scans"], scans);
    let on: Vec<&str> = started["frame"]["on"]
        .as_array()
        .expect("steps")
        .iter()
        .map(|n| started["steps"][n.as_u64().expect("a number") as usize]["name"].as_str().expect("a name"))
        .collect();
    assert_eq!(on, ["2", "3"]);
    let first = page.ok(json!({ "do": "run_seek", "run": "r", "ms": 0 }));
    assert_eq!(first["live"], json!(scans == 1), "the run can be gone back in");
}

#[test]
fn a_refuted_claim_is_saved_as_a_test_that_fails() {
    let mut page = Asked::default();
    page.open(FORK);
    let rows = prove(&mut page, 1000);
    let own = row(&rows, "prove never X2 and X3");
    let test = ways(&mut page, &own)["test"].clone();
    let text = take(&mut page, &test["splices"]);
    let places = ["prove reachable M", "test \"", "layout G"].map(|t| text.find(t).expect(t));
    assert!(places.is_sorted(), "a test stands before the layout: {text}");
    let report = page.ok(json!({ "do": "test", "file": "a.g7" }));
    assert_eq!((&report["failed"], &report["passed"]), (&json!(1), &json!(0)), "{report:#}");
    let again = row(&prove(&mut page, 1000), "prove never X2 and X3");
    let second = ways(&mut page, &again)["test"].clone();
    assert_ne!(second["title"], test["title"], "the file has that title already");
    take(&mut page, &second["splices"]);
    assert_eq!(page.ok(json!({ "do": "test", "file": "a.g7" }))["failed"], 2);
}

#[test]
fn a_conflict_has_its_cures_and_each_of_them_cures() {
    for (sort, wanted) in [
        ("exclusive", "1 -> 3 when b and not a"),
        ("parallel", "1 -> (2, 3) when a and b"),
        ("assume", "prove reachable M\nassume not (a and b)"),
    ] {
        let mut page = Asked::default();
        page.open(FORK);
        let conflict = row(&prove(&mut page, 1000), "no conflict");
        let found = ways(&mut page, &conflict);
        let cures = found["cures"].as_array().expect("cures");
        assert!(cures.iter().all(|c| c["sort"] != "priority"), "iec60848 follows no priority");
        let cure = cures.iter().find(|c| c["sort"] == sort).unwrap_or_else(|| panic!("{sort}: {found:#}"));
        let with = if sort == "assume" { json!(["assume not (a and b)"]) } else { json!(["a", "b"]) };
        assert_eq!(cure["with"], with);
        let text = take(&mut page, &cure["splices"]);
        assert!(text.contains(wanted), "{text}");
        let after = prove(&mut page, 1000);
        assert_eq!(row(&after, "no conflict")["verdict"], "proved", "{sort}");
        let both = if sort == "parallel" { "refuted" } else { "proved" };
        assert_eq!(row(&after, "prove never X2 and X3")["verdict"], both, "{sort}");
        page.ok(json!({ "do": "undo", "file": "a.g7" }));
        assert_eq!(page.text(), FORK);
    }
}

#[test]
fn priority_is_offered_where_the_profile_follows_it() {
    let mut page = Asked::default();
    page.open(&format!("profile iec60848 {{ single-token }}\n{FORK}"));
    let conflict = row(&prove(&mut page, 1000), "no conflict");
    let found = ways(&mut page, &conflict);
    let cure = found["cures"].as_array().expect("cures").iter().find(|c| c["sort"] == "priority");
    let text = take(&mut page, &cure.expect("priority")["splices"]);
    assert!(text.contains("1 -> 2 when a priority 1\n  1 -> 3 when b priority 2\n"), "{text}");
    assert_eq!(row(&prove(&mut page, 1000), "no conflict")["verdict"], "proved");
}

#[test]
fn what_the_chart_decides_itself_is_not_assumed_away() {
    let mut page = Asked::default();
    page.open(&FORK.replace("1 -> 3 when b", "1 -> 3 when ↑b").replace("1 -> 2 when a", "1 -> 2 when ↑a"));
    let conflict = row(&prove(&mut page, 1000), "no conflict");
    let found = ways(&mut page, &conflict);
    let sorts: Vec<&Value> = found["cures"].as_array().expect("cures").iter().map(|c| &c["sort"]).collect();
    assert!(!sorts.contains(&&json!("assume")), "{sorts:?}");
    let no = page.no(json!({ "do": "prove_ways", "file": "a.g7", "hash": "", "question": 0, "run": [] }));
    assert!(no.contains("changed"), "{no}");
}

/// The assumption that is offered with an answer.
fn assumption(found: &Value) -> Option<Value> {
    found["cures"].as_array().expect("cures").iter().find(|c| c["sort"] == "assume").cloned()
}

#[test]
fn what_the_inputs_of_a_scan_decide_can_be_assumed_away() {
    let line = "input go, stop : BOOL\noutput M : BOOL\nchart G {\n  initial step 1\n  step 2\n  step 3 { N M }\n  1 -> 2 when ↑go\n  2 -> 3 when ↑go and not stop\n}\n\nprove never M\n";
    let alone = line.replace(" and not stop", "");
    for (chart, claim, wanted) in [
        (FORK, "prove never X2 and X3", "assume not (a and b)"),
        (line, "prove never M", "assume not (go and not stop)"),
        // An input that never came would be no input: it does not come in this situation.
        (&*alone, "prove never M", "assume not (X2 and go)"),
    ] {
        let mut page = Asked::default();
        page.open(chart);
        let own = row(&prove(&mut page, 1000), claim);
        let found = ways(&mut page, &own);
        let cure = assumption(&found).unwrap_or_else(|| panic!("{found:#}"));
        assert_eq!(cure["with"], json!([wanted]));
        let text = take(&mut page, &cure["splices"]);
        assert!(text.contains(&format!("\n{wanted}\n")), "{text}");
        assert_eq!(row(&prove(&mut page, 1000), claim)["verdict"], "proved", "{wanted}");
    }
}

/// 2 are added in each tick but the first; the plant drives both inputs.
const TANK: &str = include_str!("../tank.g7");

#[test]
fn a_claim_about_chart_and_plant_is_saved_as_a_test_with_the_plant() {
    let mut page = Asked::default();
    page.open(TANK);
    let own = row(&prove(&mut page, 1000), "prove always level");
    assert_eq!(own["verdict"], "refuted");
    let found = ways(&mut page, &own);
    assert_eq!(assumption(&found), None, "the plant gives the inputs");
    let text = take(&mut page, &found["test"]["splices"]);
    assert!(text.contains(" with Tank {\n  wait 10.25s\n  expect level <= 80.0\n}"), "{text}");
    let report = page.ok(json!({ "do": "test", "file": "a.g7" }));
    assert_eq!((&report["failed"], &report["passed"]), (&json!(1), &json!(0)), "{report:#}");
}

#[test]
fn what_no_test_shows_is_said_in_three_languages() {
    let mut page = Asked::default();
    page.open("input a, b : BOOL\nchart G {\n  initial step 1\n  initial step 2\n  step 3\n  1 -> 3 when a\n  2 -> 3 when b\n}\n");
    let twice = row(&prove(&mut page, 1000), "no step is activated");
    let why = ways(&mut page, &twice)["untested"].clone();
    let said: Vec<&str> = why.as_array().expect("three").iter().filter_map(Value::as_str).collect();
    assert_eq!(said.len(), 3);
    assert!(said[0] != said[1] && said[1] != said[2], "{said:?}");
}

fn compare(page: &mut Asked, files: [&str; 2], states: usize) -> Value {
    page.ok(json!({ "do": "compare", "files": files, "profiles": [null, null], "states": states, "mib": 64 }))
}

#[test]
fn two_files_are_equal_or_told_apart_by_a_run_for_each() {
    let mut page = Asked::default();
    page.open(FORK);
    let other = |page: &mut Asked, text: &str| {
        page.ok(json!({ "do": "open", "file": "b.g7", "text": text }));
    };
    other(&mut page, &FORK.replace("step 4\n", "step 5\n").replace("4 -> 1", "5 -> 1"));
    let equal = compare(&mut page, ["a.g7", "b.g7"], 1000);
    assert_eq!(equal["is"], "equal", "outputs alone are compared");
    assert_eq!(equal["assumed"], json!(false));
    // The output comes with `a` in the first scan, unless `b` comes too.
    other(&mut page, &FORK.replace("when a\n  1", "when a and not b\n  1"));
    let found = compare(&mut page, ["a.g7", "b.g7"], 1000);
    assert_eq!((&found["is"], &found["scans"]), (&json!("apart"), &json!(1)), "{found:#}");
    assert!(found["reason"][1].as_str().is_some_and(|r| r.contains("la sortie `M`")), "{found:#}");
    let shown = [0, 1].map(|n| {
        let file = ["a.g7", "b.g7"][n];
        let start = json!({ "do": "run_start", "file": file, "run": file, "plant": "none", "moves": found["runs"][n] });
        page.ok(start)["frame"]["on"].as_array().map(Vec::len)
    });
    assert_eq!(shown, [Some(2), Some(1)]);
    // Without `b` no input tells them apart.
    let without = FORK.replace("when a\n  1", "when a and not b\n  1");
    other(&mut page, &without.replace("prove reachable M\n", "prove reachable M\nassume not b\n"));
    let assumed = compare(&mut page, ["a.g7", "b.g7"], 1000);
    assert_eq!((&assumed["is"], &assumed["assumed"]), (&json!("equal"), &json!(true)), "{assumed:#}");
    other(&mut page, &FORK.replace("output M", "output N, M"));
    assert_eq!(compare(&mut page, ["a.g7", "b.g7"], 1000)["is"], "unlike");
    other(&mut page, &FORK.replace("when ↑back", "when nothing"));
    let wrong = compare(&mut page, ["a.g7", "b.g7"], 1000);
    assert_eq!((&wrong["is"], &wrong["side"]), (&json!("errors"), &json!(1)));
}

#[test]
fn a_comparison_with_too_few_states_asks_for_more() {
    let text = "\
profile iec60848
input go : BOOL
output M : BOOL
var x : LREAL
chart Main {
  initial step 1
  step 2 { P1 x := x * 0.5 + 1.0  N M if x > 2.5 }
  1 -> 2 when go
  2 -> 1 when not go
}
";
    let mut page = Asked::default();
    page.open(text);
    page.ok(json!({ "do": "open", "file": "b.g7", "text": text.replace("x > 2.5", "x > 2.6") }));
    // The number stays below 2, which no solver for bits can tell.
    let open = compare(&mut page, ["a.g7", "b.g7"], 5);
    assert_eq!((&open["is"], &open["more"]), (&json!("open"), &json!(true)), "{open:#}");
    assert_eq!(compare(&mut page, ["a.g7", "b.g7"], 10_000)["is"], "equal");
}

#[test]
fn the_text_before_the_last_change_can_be_had() {
    let mut page = Asked::default();
    page.open(FORK);
    let before = |page: &mut Asked| page.ok(json!({ "do": "before", "file": "a.g7" }))["text"].clone();
    assert_eq!(before(&mut page), Value::Null);
    let splice = json!([{ "from": 0, "to": 0, "insert": "// x\n" }]);
    take(&mut page, &splice);
    assert_eq!(before(&mut page), FORK);
    assert_eq!(page.text(), format!("// x\n{FORK}"), "asking changes nothing");
}
