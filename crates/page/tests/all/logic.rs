//! Logic in the languages of controllers: each form is shown and read back.
#![allow(clippy::disallowed_methods, reason = "the tests read the examples")]
use crate::common;

use common::Asked;
use serde_json::{Value, json};

const CHART: &str = "input a, b, c : BOOL
input n : INT
output q, r : BOOL
var k : INT
action Hold { q := a or q and not b; IF a THEN k := k + 1 END_IF }
action Count { FOR k := 1 TO 3 DO r := not r END_FOR }
chart G {
  initial step 1 { N Hold  N q if a and b }
  step 2 { N Count  on ↑c: k := 0 }
  1 -> 2 when a and (not b or ↑c) and n > 5
  2 -> 1 when TRUE
}
";

/// The languages.
const TONGUES: [&str; 3] = ["st", "il", "ld"];

/// The pieces of logic of a symbol in a language.
fn logic(page: &mut Asked, id: &str, tongue: &str) -> Vec<Value> {
    let found = page.ok(json!({ "do": "logic", "file": "a.g7", "id": id, "tongue": tongue }));
    found.as_array().expect("a list").clone()
}

#[test]
fn a_receptivity_is_shown_in_each_language_and_read_back_from_each() {
    let mut page = Asked::default();
    page.open(CHART);
    let [st, il, ld] = TONGUES.map(|tongue| {
        let pieces = logic(&mut page, "G/t/0", tongue);
        assert_eq!((pieces.len(), &pieces[0]["part"]), (1, &json!("receptivity")), "{tongue}");
        pieces[0]["text"].as_str().expect("a text").to_owned()
    });
    assert_eq!(st, "a and (not b or ↑c) and n > 5");
    let list = il.clone();
    assert!(list.starts_with("LD") && list.contains("ORN") || list.contains("AND("), "{list}");
    let rung = ld.clone();
    assert!(rung.contains("[a]") && rung.contains("[/b]") && rung.contains("[P c]"), "{rung}");
    for (tongue, text) in TONGUES.into_iter().zip([st, il, ld]) {
        let read = page.ok(json!({ "do": "logic_read", "tongue": tongue, "text": text }));
        assert_eq!(read["text"], "a and (not b or ↑c) and n > 5", "{tongue}");
    }
}

#[test]
fn a_step_shows_the_conditions_and_bodies_of_its_actions() {
    let mut page = Asked::default();
    page.open(CHART);
    let parts = |pieces: &[Value]| -> Vec<(String, u64)> {
        let part =
            |p: &Value| (p["part"].as_str().unwrap_or("").to_owned(), p["index"].as_u64().unwrap_or(9));
        pieces.iter().map(part).collect()
    };
    let [_, il, ld] = TONGUES.map(|tongue| logic(&mut page, "G/s/1", tongue));
    for pieces in [&il, &ld] {
        assert_eq!(parts(pieces), [("body".to_owned(), 0), ("condition".to_owned(), 1)]);
    }
    let rungs = ld[0]["text"].as_str().expect("rungs").to_owned();
    assert!(rungs.contains("(q)") && rungs.contains("(k := k + 1)"), "{rungs}");
    let list = il[0]["text"].as_str().expect("a list").to_owned();
    assert!(list.contains("ST") && list.contains("JMPCN"), "{list}");
    assert_eq!(logic(&mut page, "G/a/1/1", "ld"), [ld[1].clone()]);

    let [st, il, ld] = TONGUES.map(|tongue| logic(&mut page, "G/s/2", tongue));
    assert_eq!(parts(&st), [("body".to_owned(), 0), ("event".to_owned(), 1), ("body".to_owned(), 1)]);
    // Only Structured Text can express a counting loop.
    assert!(st[0]["text"].as_str().is_some_and(|t| t.contains("FOR")));
    assert_eq!([&il[0]["text"], &ld[0]["text"]], [&Value::Null, &Value::Null]);
}

#[test]
fn ladder_comes_with_its_picture() {
    let mut page = Asked::default();
    page.open(&CHART.replace("not b", "not (b and n < 3)"));
    let [st, il, ld] = TONGUES.map(|tongue| logic(&mut page, "G/t/0", tongue)[0]["picture"].clone());
    assert_eq!([st, il], [Value::Null, Value::Null]);
    let picture = ld.as_str().expect("a picture");
    assert!(picture.starts_with("<svg class=\"g7 g7-rungs\"") && picture.contains(">n &gt;"));
}

#[test]
fn what_is_no_logic_is_refused_with_its_line() {
    let mut page = Asked::default();
    page.open(CHART);
    let mut no =
        |tongue: &str, text: &str| page.no(json!({ "do": "logic_read", "tongue": tongue, "text": text }));
    assert!(no("il", "LD a\nAND )\n").starts_with("line 2: "));
    assert!(no("ld", "--[a\n").starts_with("line 1: "));
    assert!(no("st", "a and").starts_with("line 1: "));
    for tongue in TONGUES {
        assert!(!no(tongue, "").is_empty(), "{tongue}");
    }
    assert_eq!(
        page.no(json!({ "do": "logic", "file": "a.g7", "id": "G/s/9", "tongue": "il" })),
        "there is no `G/s/9`"
    );
}
