//! Files that use others in the page: what it asks for, and what follows when one of them changes.

#![allow(clippy::disallowed_methods, reason = "the common part reads the examples")]

use crate::common;

use common::Asked;
use serde_json::json;

const AXIS: &str = "input go : BOOL\noutput q : BOOL\nchart Axis(i : INT) {\n  initial step 0\n  step 1 { N q }\n  0 -> 1 when go\n  1 -> 0 when not go\n}\n";
const MAIN: &str = "use 'lib/axis.g7'\ninstance Axis[1..2]\n";

#[test]
fn the_page_asks_for_the_files_that_are_used() {
    let mut page = Asked::default();
    let look = page.ok(json!({ "do": "open", "file": "cell/a.g7", "text": MAIN }));
    assert_eq!(look["wants"], json!(["cell/lib/axis.g7"]));
    page.ok(json!({ "do": "lend", "files": [{ "file": "cell/lib/axis.g7", "text": format!("use 'io.g7'\n{AXIS}") }] }));
    let look = page.ok(json!({ "do": "look", "file": "cell/a.g7" }));
    assert_eq!(look["wants"], json!(["cell/lib/io.g7"]), "what it uses in turn");
    page.ok(json!({ "do": "lend", "files": [{ "file": "cell/lib/io.g7", "text": null }] }));
    let look = page.ok(json!({ "do": "look", "file": "cell/a.g7" }));
    assert_eq!(look["wants"], json!([]));
    let problem = &look["problems"][0];
    assert_eq!((&problem["code"], &problem["line"]), (&json!("G0011"), &json!(1)));
    let what = problem["what"].as_str().expect("a text");
    assert_eq!(what, "cell/lib/axis.g7:1:5: `io.g7` cannot be used: there is no such file");
    assert_eq!(look["uses"], json!(["cell/lib/axis.g7", "cell/lib/io.g7"]), "it is waited for");
    page.ok(json!({ "do": "open", "file": "cell/lib/io.g7", "text": "type Mode : (Off, On)\n" }));
    let look = page.ok(json!({ "do": "look", "file": "cell/a.g7" }));
    assert_eq!(look["problems"], json!([]));
}

#[test]
fn a_used_file_that_is_open_is_seen_as_it_is_there() {
    let mut page = Asked::default();
    page.ok(json!({ "do": "open", "file": "lib/axis.g7", "text": AXIS }));
    let look = page.open(MAIN);
    assert_eq!((&look["wants"], &look["problems"]), (&json!([]), &json!([])));
    let charts = look["charts"].as_array().expect("charts");
    assert_eq!((&charts[0]["name"], &charts[0]["file"]), (&json!("Axis"), &json!("lib/axis.g7")));
    // Its drawing is that of its own file, and marks the line that leads there.
    let drawing = |file: &str| json!({ "do": "drawing", "file": file, "chart": "Axis" });
    let (here, there) = (page.ok(drawing("a.g7")), page.ok(drawing("lib/axis.g7")));
    let pictures = |d: &serde_json::Value| -> Vec<serde_json::Value> {
        d["items"].as_array().expect("items").iter().map(|i| json!([i["id"], i["svg"]])).collect()
    };
    assert_eq!(pictures(&here), pictures(&there));
    assert_eq!((&here["items"][0]["from"], &here["items"][0]["to"]), (&json!(4), &json!(17)));
    // A run of the head has marks for the symbols of the chart.
    let started = page.ok(json!({ "do": "run_start", "file": "a.g7", "run": "a" }));
    let hash = started["hash"].clone();
    page.ok(json!({ "do": "run_toggle", "run": "a", "signal": 0 }));
    let frame = page.ok(json!({ "do": "run_scan", "run": "a" }));
    assert!(
        frame["on"].to_string().contains("Axis[2]") || !frame["on"].as_array().expect("steps").is_empty()
    );
    // A change there is one of the head.
    let at = AXIS.find("not go").expect("it is there");
    let splices = json!([{ "from": at, "to": at + 6, "insert": "gone" }]);
    page.ok(json!({ "do": "splice", "file": "lib/axis.g7", "splices": splices }));
    let look = page.ok(json!({ "do": "look", "file": "a.g7" }));
    assert_eq!(look["problems"][0]["what"], "lib/axis.g7:7:15: nothing is called `gone`");
    assert_eq!(look["problems"][0]["fixes"], json!([]));
    assert_ne!(look["hash"], hash, "the text that would run is another one");
    page.ok(json!({ "do": "undo", "file": "lib/axis.g7" }));
    let look = page.ok(json!({ "do": "look", "file": "a.g7" }));
    assert_eq!((&look["problems"], &look["hash"]), (&json!([]), &hash));
    // When it is closed, the head asks for what the disk has.
    page.ok(json!({ "do": "close", "file": "lib/axis.g7" }));
    assert_eq!(page.ok(json!({ "do": "look", "file": "a.g7" }))["wants"], json!(["lib/axis.g7"]));
}

#[test]
fn a_text_is_opened_with_the_files_that_it_uses() {
    let mut page = Asked::default();
    page.ok(json!({ "do": "lend", "files": [{ "file": "cell/lib/axis.g7", "text": AXIS }] }));
    page.ok(json!({ "do": "open", "file": "cell/a.g7", "text": MAIN }));
    let uses = page.ok(json!({ "do": "used", "file": "cell/a.g7" }));
    assert_eq!(uses, json!([{ "file": "lib/axis.g7", "text": AXIS }]), "by its path from the folder");
    // The name does not matter: proofs and comparisons open the text under a name of their own.
    let look = page.ok(json!({ "do": "open", "file": "0/asked.g7", "text": MAIN, "uses": uses }));
    assert_eq!((&look["wants"], &look["problems"]), (&json!([]), &json!([])));
    let report = page.ok(json!({ "do": "prove", "file": "0/asked.g7", "states": 1000, "mib": 16 }));
    let rows = report["rows"].as_array().expect("answers");
    let axis = rows.iter().find(|r| r["id"] == "Axis/s/1").expect("a step of the used chart is asked about");
    assert_eq!(axis["verdict"], "proved");
    let both = json!({ "do": "compare", "files": ["0/asked.g7", "cell/a.g7"], "profiles": [null, null], "situations": true, "states": 1000, "mib": 16 });
    assert_eq!(page.ok(both)["is"], json!("equal"));
}

#[test]
fn gestures_change_the_own_text_alone() {
    let mut page = Asked::default();
    page.ok(json!({ "do": "lend", "files": [{ "file": "lib/axis.g7", "text": AXIS }] }));
    page.open(MAIN);
    for gesture in [
        json!({ "g": "add_step", "chart": "Axis" }),
        json!({ "g": "rename", "id": "Axis/s/1", "to": "9" }),
        json!({ "g": "delete_chart", "chart": "Axis" }),
    ] {
        page.no(json!({ "do": "edit", "file": "a.g7", "gesture": gesture }));
    }
    page.ok(json!({ "do": "edit", "file": "a.g7", "gesture": { "g": "add_chart", "kind": "chart" } }));
    assert!(page.text().starts_with("use 'lib/axis.g7'\n"), "{}", page.text());
    let complete = page.ok(json!({ "do": "complete", "file": "a.g7", "at": MAIN.len() }));
    assert!(complete["items"].as_array().is_some());
}
