//! The page is sent only what changed since the last drawing. These tests apply that difference, as the page does,
//! and compare the result with the whole drawing.
#![allow(clippy::disallowed_methods, reason = "the common part reads the examples")]

use crate::common;

use common::{Asked, examples};
use serde_json::{Value, json};

fn asked(page: &mut Asked, chart: &Value, since: Option<u64>) -> Value {
    let mut wish = json!({ "do": "drawing", "file": "a.g7", "chart": chart });
    if let (Some(wish), Some(since)) = (wish.as_object_mut(), since) {
        wish.insert("since".into(), since.into());
    }
    page.ok(wish)
}

/// The drawing of a chart that the page has. The SVG of a symbol is moved with the symbol.
#[derive(Default)]
struct Had {
    number: u64,
    items: Vec<Value>,
    /// The symbols of the last answer whose drawing was sent.
    sent: usize,
}

impl Had {
    /// Takes an answer, as `web/src/lib/redrawn.ts` does.
    fn take(&mut self, answer: &Value) {
        if let Some(since) = answer["since"].as_u64() {
            assert_eq!(since, self.number);
        }
        let mut items = Vec::new();
        self.sent = 0;
        for sent in answer["items"].as_array().expect("items") {
            let Some(first) = sent["as"].as_u64() else {
                self.sent += 1;
                items.push(sent.clone());
                continue;
            };
            let first = usize::try_from(first).expect("a number");
            match sent["count"].as_u64() {
                Some(count) => {
                    let old = &self.items[first..first + usize::try_from(count).expect("a number")];
                    items.extend(kept(old, sent));
                }
                None => {
                    let mut item = sent.clone();
                    for name in ["svg", "far"] {
                        item[name] = moved_text(&self.items[first][name], &sent["by"]);
                    }
                    let fields = item.as_object_mut().expect("an object");
                    fields.remove("as");
                    fields.remove("by");
                    items.push(item);
                }
            }
        }
        self.items = items;
        self.number = answer["number"].as_u64().expect("a number");
    }
}

/// Symbols that are the same, but for their place, their places in the text and their ids.
fn kept(old: &[Value], sent: &Value) -> Vec<Value> {
    let (by, along) = (&sent["by"], sent["along"].as_i64().expect("a number"));
    let mut ids = sent["ids"].as_array().into_iter().flatten();
    let mut ends = sent["ends"].as_array().into_iter().flatten();
    let items = old.iter().map(|old| {
        let mut item = old.clone();
        for name in ["from", "to"] {
            item[name] = (old[name].as_i64().expect("a place") + along).into();
        }
        for name in ["area", "square", "bar", "text", "at"] {
            for (n, by) in by.as_array().expect("a vector").iter().enumerate() {
                if let Some(length) = item.get_mut(name).and_then(|lengths| lengths.get_mut(n)) {
                    *length = sum(length, by).into();
                }
            }
        }
        for name in ["svg", "far"] {
            item[name] = moved_text(&old[name], by);
        }
        if sent["ids"].is_array() {
            item["id"] = ids.next().expect("an id for each").clone();
            if old["ends"].is_array() {
                item["ends"] = ends.next().expect("ends for each link").clone();
            }
        }
        item
    });
    let items = items.collect();
    assert_eq!((ids.next(), ends.next()), (None, None));
    items
}

/// The sum of two lengths with one decimal.
fn sum(a: &Value, b: &Value) -> f64 {
    ((a.as_f64().expect("a length") + b.as_f64().expect("a length")) * 10.0).round() / 10.0
}

/// SVG, or the data of a path, moved by a vector.
fn moved_text(text: &Value, by: &Value) -> Value {
    let text = text.as_str().expect("a text");
    if !text.starts_with('<') {
        return moved_path(text, by).into();
    }
    let mut out = String::new();
    for (n, part) in text.split('"').enumerate() {
        let part = match out.rsplit(' ').next() {
            Some("x=" | "cx=") if n % 2 == 1 => added(part, &by[0]),
            Some("y=" | "cy=") if n % 2 == 1 => added(part, &by[1]),
            Some("d=") if n % 2 == 1 => moved_path(part, by),
            _ => part.to_owned(),
        };
        if n > 0 {
            out.push('"');
        }
        out.push_str(&part);
    }
    out.into()
}

/// The data of a path, of the commands M, L, H, V and Z, moved by a vector.
fn moved_path(path: &str, by: &Value) -> String {
    let mut out = String::new();
    for command in path.split_inclusive(|c: char| c.is_ascii_alphabetic()).collect::<Vec<_>>().windows(2) {
        let letter = command[0].chars().last().expect("a letter");
        let numbers = command[1].trim_end_matches(|c: char| c.is_ascii_alphabetic());
        out.push(letter);
        match (letter, numbers.split_once(' ')) {
            (_, Some((x, y))) => out.push_str(&format!("{} {}", added(x, &by[0]), added(y, &by[1]))),
            ('H', None) => out.push_str(&added(numbers, &by[0])),
            ('V', None) => out.push_str(&added(numbers, &by[1])),
            _ => out.push_str(numbers),
        }
    }
    if path.ends_with('Z') {
        out.push('Z');
    }
    out
}

fn added(length: &str, by: &Value) -> String {
    sum(&length.parse::<f64>().expect("a length").into(), by).to_string()
}

#[test]
fn differences_give_the_whole_drawing() {
    let mut page = Asked::default();
    for (path, text) in examples() {
        let look = page.open(&text);
        for chart in look["charts"].as_array().expect("charts") {
            let name = &chart["name"];
            let mut had = Had::default();
            had.take(&asked(&mut page, name, Some(0)));
            let step = had.items.iter().find(|i| i["part"] == "step").map(|i| i["id"].clone());
            let Some(step) = step else { continue };
            let gestures = [
                json!({ "g": "next", "id": step }),
                json!({ "g": "comment", "id": step, "text": "é" }),
                json!({ "g": "delete", "ids": [step], "heal": true }),
            ];
            for gesture in gestures {
                let _refused = page.ask(json!({ "do": "edit", "file": "a.g7", "gesture": gesture }));
                had.take(&asked(&mut page, name, Some(had.number)));
                let whole = asked(&mut page, name, None);
                assert_eq!(
                    had.items,
                    *whole["items"].as_array().expect("items"),
                    "{path}, {name}, {gesture}"
                );
            }
        }
    }
}

#[test]
fn only_what_looks_new_is_sent() {
    let steps: String = (1..100).map(|k| format!("  step {k}\n  {} -> {k} when a\n", k - 1)).collect();
    let mut page = Asked::default();
    page.open(&format!("input a : BOOL\nchart G {{\n  initial step 0\n{steps}}}\n"));
    let chart = json!("G");
    let mut had = Had::default();
    had.take(&asked(&mut page, &chart, Some(0)));
    let all = had.items.len();
    assert_eq!(had.sent, all, "the first drawing is whole");
    page.ok(
        json!({ "do": "edit", "file": "a.g7", "gesture": { "g": "action", "id": "G/s/5", "text": "N q" } }),
    );
    had.take(&asked(&mut page, &chart, Some(had.number)));
    assert_eq!(had.items.len(), all + 1);
    assert!(had.sent <= 3, "an action is drawn, {} symbols were sent", had.sent);
    // A number that the page does not know: all is sent.
    had.take(&asked(&mut page, &chart, Some(0)));
    assert_eq!(had.sent, all + 1);
}

#[test]
fn symbols_that_only_move_are_not_sent_again() {
    let steps: String = (1..100).map(|k| format!("  step {k}\n  {} -> {k} when a\n", k - 1)).collect();
    let mut page = Asked::default();
    page.open(&format!("input a : BOOL\nchart G {{\n  initial step 0\n{steps}}}\n"));
    let chart = json!("G");
    let mut had = Had::default();
    had.take(&asked(&mut page, &chart, Some(0)));
    for gesture in [
        json!({ "g": "next", "id": "G/s/50" }),
        json!({ "g": "next", "id": "G/s/20" }),
        json!({ "g": "delete", "ids": ["G/s/70", "G/t/71"], "heal": true }),
    ] {
        page.ok(json!({ "do": "edit", "file": "a.g7", "gesture": gesture }));
        let answer = asked(&mut page, &chart, Some(had.number));
        had.take(&answer);
        // A step, a transition, and the links that end at them.
        assert!(had.sent <= 6, "{gesture}: {} symbols were sent", had.sent);
        let bytes = answer["items"].to_string().len();
        assert!(bytes < 20_000, "{gesture}: {bytes} bytes");
        let whole = asked(&mut page, &chart, None);
        assert_eq!(had.items, *whole["items"].as_array().expect("items"), "{gesture}");
    }
}
