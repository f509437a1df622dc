//! The properties that the drawing and the panel show and change: comments, steps of a transition,
//! switches of the profile; and copying to another file, and merging two changes of one file.
#![allow(clippy::disallowed_methods, reason = "the common part reads the examples")]

use crate::common;

use common::Asked;
use serde_json::{Value, json};

const CHART: &str = "input a, b : BOOL\nvar unused : INT\nchart G {\n  initial step 1\n  step 2\n  1 -> 2 when a\n  2 -> 1 when b\n}\n\nlayout G {\n  comment \"ö: why\" at (10, 2)\n}\n";

fn drawing(page: &mut Asked) -> Value {
    page.ok(json!({ "do": "drawing", "file": "a.g7", "chart": "G" }))
}

fn item(page: &mut Asked, id: &str) -> Value {
    let drawn = drawing(page);
    let items = drawn["items"].as_array().expect("items");
    items.iter().find(|i| i["id"] == id).unwrap_or_else(|| panic!("no {id}")).clone()
}

fn edit(page: &mut Asked, gesture: Value) -> Value {
    page.ok(json!({ "do": "edit", "file": "a.g7", "gesture": gesture }))
}

#[test]
fn a_comment_of_the_layout_is_an_item_with_its_place_and_text() {
    let mut page = Asked::default();
    page.open(CHART);
    let note = item(&mut page, "G/n/0");
    assert_eq!((&note["part"], &note["comment"]), (&json!("comment"), &json!("ö: why")));
    assert_eq!(note["at"], json!([100.0, 20.0]));
    let (from, to) = (note["from"].as_u64().expect("from"), note["to"].as_u64().expect("to"));
    let units: Vec<u16> = CHART.encode_utf16().collect();
    let text = String::from_utf16(&units[from as usize..to as usize]).expect("text");
    assert_eq!(text, "comment \"ö: why\" at (10, 2)");
    let moved = edit(&mut page, json!({ "g": "move", "ids": ["G/n/0"], "dx": 5, "dy": 0 }));
    assert_eq!(moved["select"], json!(["G/n/0"]));
    assert!(page.text().contains("comment \"ö: why\" at (10.5, 2)"));
    page.ok(json!({ "do": "undo", "file": "a.g7" }));
    assert_eq!(page.text(), CHART);
}

#[test]
fn a_transition_tells_its_steps() {
    let mut page = Asked::default();
    page.open(CHART);
    assert_eq!(item(&mut page, "G/t/0")["steps"], json!([["1"], ["2"]]));
    edit(&mut page, json!({ "g": "ends", "id": "G/t/0", "after": ["1", "2"] }));
    assert_eq!(item(&mut page, "G/t/0")["steps"], json!([["1"], ["1", "2"]]));
}

#[test]
fn the_switches_say_what_the_profile_has_and_what_is_set() {
    let mut page = Asked::default();
    let look = page.open(&format!("profile iec61131 {{ multi-token }}\n{CHART}"));
    let row = |look: &Value, word: &str| {
        let rows = look["switches"].as_array().expect("rows").clone();
        rows.into_iter().find(|r| r["words"][0] == word || r["words"][1] == word).expect("a row")
    };
    assert_eq!(look["switches"].as_array().map(Vec::len), Some(8));
    let token = row(&look, "multi-token");
    assert_eq!((&token["usual"], &token["set"]), (&json!("single-token"), &json!("multi-token")));
    let stable = row(&look, "stable");
    assert_eq!((&stable["usual"], &stable["set"]), (&json!("one-pass"), &Value::Null));
    assert_eq!(look["bound"]["set"], Value::Null);
    let after = edit(&mut page, json!({ "g": "switch", "name": "multi-token", "on": false }));
    assert_eq!(row(&after, "multi-token")["set"], Value::Null);
    let after = edit(&mut page, json!({ "g": "bound", "n": 7 }));
    assert_eq!(after["bound"]["set"], 7);
    assert!(page.text().starts_with("profile iec61131 { bound 7 }\n"), "{}", page.text());
}

#[test]
fn a_part_takes_its_variables_and_places_to_another_file() {
    let mut page = Asked::default();
    page.open(CHART);
    let ids = json!(["G/s/1", "G/s/2", "G/t/0", "G/n/0"]);
    let part = page.ok(json!({ "do": "copy", "file": "a.g7", "ids": ids }));
    let text = part["text"].as_str().expect("a text").to_owned();
    assert!(text.starts_with("input a, b : BOOL\n"), "{text}");
    assert!(!text.contains("unused"), "only what is named: {text}");
    page.ok(json!({ "do": "open", "file": "b.g7", "text": "var a : INT\nchart H {\n}\n" }));
    let gesture = json!({ "g": "paste", "chart": "H", "text": text, "at": [300, 100] });
    let pasted = page.ok(json!({ "do": "edit", "file": "b.g7", "gesture": gesture }));
    let told = pasted["told"][0].as_str().expect("a sentence");
    assert!(told.contains("`a`") && told.contains("`var INT`") && told.contains("`input BOOL`"), "{told}");
    let there = page.ok(json!({ "do": "drawing", "file": "b.g7", "chart": "H" }));
    let at = |drawn: &Value, id: &str| {
        let items = drawn["items"].as_array().expect("items").clone();
        let item = items.into_iter().find(|i| i["id"] == id).expect("drawn");
        [item["at"][0].as_f64().expect("x"), item["at"][1].as_f64().expect("y")]
    };
    let here = drawing(&mut page);
    assert_eq!(at(&there, "H/s/1"), [300.0, 100.0]);
    for (a, b) in [("G/s/2", "H/s/2"), ("G/t/0", "H/t/0"), ("G/n/0", "H/n/0")] {
        let (from, to) = (at(&here, a), at(&there, b));
        let first = at(&here, "G/s/1");
        assert_eq!([to[0] - 300.0, to[1] - 100.0], [from[0] - first[0], from[1] - first[1]], "{b}");
    }
}

#[test]
fn two_changes_of_a_text_are_merged_or_left_to_the_user() {
    let mut page = Asked::default();
    let ask =
        |mine: &str, theirs: &str| json!({ "do": "merge", "base": CHART, "mine": mine, "theirs": theirs });
    let mine = CHART.replace("step 2\n", "step 2 \"mine\"\n");
    let theirs = CHART.replace("input a, b", "input a, b, c");
    let both = page.ok(ask(&mine, &theirs));
    assert_eq!(both["text"], json!(mine.replace("input a, b", "input a, b, c")));
    assert_eq!(both["conflicts"], 0);
    let against = page.ok(ask(&mine, &CHART.replace("step 2\n", "step 2 \"theirs\"\n")));
    assert_eq!((&against["text"], &against["conflicts"]), (&Value::Null, &json!(1)));
}
