//! A panel: a machine that has no buttons of its own is operated on the page.
#![allow(clippy::disallowed_methods, reason = "programs run beside each other, in real time")]

use crate::common;

use common::Folder;
use common::station::Station;
use serde_json::{Value, json};

/// A chart that is operated from the page alone; its plant shows what an input measures, and more.
const PANEL: &str = "\
profile iec60848
input go : BOOL
input mode : INT
input target : REAL
input level : REAL
output valve : BOOL
chart Main {
  initial step 1
  step 2 { N valve }
  1 -> 2 when ↑go and mode = 1
  2 -> 1 when target > 50.0
}
plant Tank {
  state height : REAL := 0.0
  state hidden : REAL := 3.0
  drive level := height
  view 'tank.svg' { pipe.on := valve  water.height := height  deep.x := hidden }
}
";

const DESK: &str = "\
[controller]
watchdog = '10s'
[devices.desk]
kind = 'panel'
release = '600ms'
[inputs]
go = 'desk.button()'
mode = 'desk.choice(A1, F1)'
target = { at = 'desk.number()', min = 0, max = 100 }
level = { at = 'desk.number()', initial = 7 }
[outputs]
valve = 'desk.lamp(green)'
";

#[test]
fn a_machine_without_a_panel_is_operated_on_the_page() {
    let folder = Folder::with(PANEL);
    folder.write("chart.io.toml", DESK);
    let station = Station::new(&folder, &[]);
    let mut page = station.page();
    let told = page.seen["told"].clone();
    assert_eq!(told["signals"][1]["panel"]["words"], json!(["A1", "F1"]));
    assert_eq!(
        told["signals"][4]["panel"],
        json!({ "is": "lamp", "colour": "green", "min": null, "max": null })
    );
    // The plant is known where an input measures it or an output drives it; all else is not.
    let known: Vec<&Value> =
        told["picture"]["bindings"].as_array().expect("parts").iter().map(|b| &b["known"]).collect();
    assert_eq!(known, [true, true, false]);
    page.until("what an input measures", |p| {
        p.seen["view"].as_array().is_some_and(|view| view.contains(&json!([1, 7.0])))
    });
    page.until("a value is not there before a person gives it", |p| p.values[2].1 == "bad");
    let press = |down: bool| json!({ "do": "operator_press", "name": "go", "down": down });
    page.ok(press(true));
    page.until("pressed", |p| p.values[0].0 == "TRUE");
    // Nobody says it again: after 600 ms the button is released, though the page is still there.
    page.until("released", |p| p.values[0].0 == "FALSE");
    assert_eq!(page.values[4].0, "FALSE", "the mode is A1");
    page.no(json!({ "do": "operator_set", "name": "mode", "value": "F2" }), "A1, F1");
    page.no(json!({ "do": "operator_set", "name": "target", "value": "101" }), "from 0 to 100");
    page.no(json!({ "do": "operator_press", "name": "valve", "down": true }), "no input on a panel");
    page.ok(json!({ "do": "operator_set", "name": "mode", "value": "F1" }));
    page.ok(press(true));
    page.until("started", |p| p.values[4].0 == "TRUE" && p.values[1].0 == "1");
    page.ok(press(false));
    // Another page sees the same panel, and what was done at it.
    let mut other = station.page();
    other.ok(json!({ "do": "operator_set", "name": "target", "value": "80" }));
    page.until("stopped", |p| {
        p.values[4].0 == "FALSE" && p.values[2] == ("80.0".to_owned(), "good".to_owned())
            || p.values[2].0 == "80"
    });
    let deeds: Vec<(String, String)> = page.seen["events"]
        .as_array()
        .expect("events")
        .iter()
        .filter(|e| e["kind"] == "pressed" || e["kind"] == "set")
        .map(|e| (e["name"].as_str().unwrap_or("").to_owned(), e["value"].as_str().unwrap_or("").to_owned()))
        .collect();
    let expected = [("go", ""), ("mode", "F1"), ("go", ""), ("target", "80")];
    assert_eq!(
        deeds.iter().map(|(n, v)| (n.as_str(), v.trim_end_matches(".0"))).collect::<Vec<_>>(),
        expected
    );
    assert_eq!(station.interrupt(), 0);
}
