//! Drawings of several charts: all of a file on one sheet, and the charts that steps open beside their chart.
#![allow(clippy::disallowed_methods, reason = "the common part reads the examples")]

use crate::common::Asked;

use serde_json::{Value, json};

const NESTED: &str = "input a : BOOL\n\
chart Main {\n  initial step 0\n  macro step M1 = Outer\n  0 -> M1 when a\n  M1 -> 0 when not a\n}\n\
macrochart Outer {\n  entry step E\n  macro step M2 = Inner\n  exit step S\n  E -> M2 when a\n  M2 -> S when not a\n}\n\
macrochart Inner {\n  entry step E\n  exit step S\n  E -> S when a\n}\n";

fn opened(text: &str) -> Asked {
    let mut page = Asked::default();
    page.ok(json!({ "do": "open", "file": "a.g7", "text": text }));
    page
}

fn drawing(page: &mut Asked, chart: &str, open: &[&str]) -> Value {
    page.ok(json!({ "do": "drawing", "file": "a.g7", "chart": chart, "open": open }))
}

/// The box of an item: left, top, width, height.
fn area(drawing: &Value, id: &str) -> [f64; 4] {
    let items = drawing["items"].as_array().expect("items");
    let found = items.iter().find(|i| i["id"] == id).unwrap_or_else(|| panic!("no {id}"));
    [0, 1, 2, 3].map(|n| found["area"][n].as_f64().expect("a length"))
}

fn has(drawing: &Value, id: &str) -> bool {
    drawing["items"].as_array().expect("items").iter().any(|i| i["id"] == id)
}

/// The box that holds all symbols of a chart.
fn whole(drawing: &Value, chart: &str) -> [f64; 4] {
    let mut all = [f64::MAX, f64::MAX, f64::MIN, f64::MIN];
    for item in drawing["items"].as_array().expect("items") {
        let id = item["id"].as_str().expect("an id");
        if item["part"] != "text" && id.split('/').next() == Some(chart) {
            let [x, y, w, h] = [0, 1, 2, 3].map(|n| item["area"][n].as_f64().expect("a length"));
            all = [all[0].min(x), all[1].min(y), all[2].max(x + w), all[3].max(y + h)];
        }
    }
    assert!(all[0] < all[2], "{chart} is drawn");
    all
}

fn apart(a: [f64; 4], b: [f64; 4]) -> bool {
    a[2] <= b[0] || b[2] <= a[0] || a[3] <= b[1] || b[3] <= a[1]
}

#[test]
fn all_charts_stand_on_the_sheet_and_do_not_overlap() {
    let gemma = std::fs::read_to_string("../../examples/structure/gemma.g7").expect("an example");
    let mut page = opened(&gemma);
    let sheet = drawing(&mut page, "*", &[]);
    let names = ["Safety", "Modes", "Production"];
    let boxes = names.map(|name| whole(&sheet, name));
    for (n, a) in boxes.iter().enumerate() {
        assert!(boxes[n + 1..].iter().all(|b| apart(*a, *b)), "{boxes:?}");
    }
    // A chart looks the same on the sheet: its symbols have their distances.
    let alone = drawing(&mut page, "Modes", &[]);
    let distance = |d: &Value| {
        let (a, b) = (area(d, "Modes/s/A6"), area(d, "Modes/s/F4"));
        [b[0] - a[0], b[1] - a[1]].map(|n| (n * 10.0).round())
    };
    assert_eq!(distance(&sheet), distance(&alone));
}

#[test]
fn a_chart_stands_where_it_is_put_and_the_others_stay() {
    let text =
        "chart A {\n  initial step 1\n}\nchart B {\n  initial step 2\n}\nchart C {\n  initial step 3\n}\n";
    let mut page = opened(text);
    let was = drawing(&mut page, "*", &[]);
    page.ok(
        json!({ "do": "edit", "file": "a.g7", "gesture": { "g": "sheet", "chart": "C", "at": [500, 400] } }),
    );
    let now = drawing(&mut page, "*", &[]);
    // The origin of the chart is the middle of the upper edge of its first step.
    let step = now["items"].as_array().expect("items").iter().find(|i| i["id"] == "C/s/3").expect("step 3");
    assert_eq!(step["at"], json!([500.0, 400.0]));
    for id in ["A/s/1", "B/s/2"] {
        assert_eq!(area(&now, id), area(&was, id));
    }
    // This chart is put where another one stands. Nobody has arranged that one, so it gives way.
    let b = was["items"].as_array().expect("items").iter().find(|i| i["id"] == "B/s/2").expect("step 2");
    page.ok(
        json!({ "do": "edit", "file": "a.g7", "gesture": { "g": "sheet", "chart": "C", "at": b["at"] } }),
    );
    let onto = drawing(&mut page, "*", &[]);
    assert!(apart(whole(&onto, "B"), whole(&onto, "C")));
    assert_eq!(area(&onto, "A/s/1"), area(&was, "A/s/1"));
}

#[test]
fn opened_charts_stand_at_the_right_and_move_nothing() {
    let mut page = opened(NESTED);
    let alone = drawing(&mut page, "Main", &[]);
    let one = drawing(&mut page, "Main", &["Main/s/M1"]);
    let both = drawing(&mut page, "Main", &["Main/s/M1", "Outer/s/M2"]);
    for id in ["Main/s/0", "Main/s/M1", "Main/t/0"] {
        assert_eq!(area(&one, id), area(&alone, id));
        assert_eq!(area(&both, id), area(&alone, id));
    }
    assert!(!has(&alone, "Outer/s/E") && has(&one, "Outer/s/E") && !has(&one, "Inner/s/E"));
    let columns = ["Main", "Outer", "Inner"].map(|name| whole(&both, name));
    assert!(columns[0][2] < columns[1][0] && columns[1][2] < columns[2][0], "{columns:?}");
    // A step that is not opened itself, and one that is not there, open nothing.
    let none = drawing(&mut page, "Main", &["Outer/s/M2", "Main/s/9"]);
    assert_eq!(none["items"], alone["items"]);
}

#[test]
fn charts_that_open_each_other_are_shown_once() {
    let text = "chart A {\n  initial step 1\n  macro step M = A\n}\n";
    let mut page = opened(text);
    let drawn = drawing(&mut page, "A", &["A/s/M"]);
    let steps = drawn["items"].as_array().expect("items").iter().filter(|i| i["part"] == "step").count();
    assert_eq!(steps, 2);
}
