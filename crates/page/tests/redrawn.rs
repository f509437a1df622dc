//! The page is sent only what changed since the last drawing. These tests apply that difference, as the page does,
//! and compare the result with the whole drawing.
#![allow(clippy::disallowed_methods, reason = "the common part reads the examples")]

mod common;

use common::{Asked, examples};
use serde_json::{Value, json};

fn asked(page: &mut Asked, chart: &Value, since: Option<u64>) -> Value {
    let mut wish = json!({ "do": "drawing", "file": "a.g7", "chart": chart });
    if let (Some(wish), Some(since)) = (wish.as_object_mut(), since) {
        wish.insert("since".into(), since.into());
    }
    page.ok(wish)
}

/// The drawing of a chart that the page has.
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
        let mut places = answer["places"].as_array().into_iter().flatten();
        let mut sent = 0;
        let items = answer["items"].as_array().expect("items").iter().map(|item| {
            if let Some(k) = item.as_u64() {
                let mut same = self.items[usize::try_from(k).expect("a number")].clone();
                same["from"] = places.next().expect("a place").clone();
                same["to"] = places.next().expect("a place").clone();
                return same;
            }
            let mut item = item.clone();
            match item["as"].as_u64() {
                Some(k) => {
                    let old = &self.items[usize::try_from(k).expect("a number")];
                    item["svg"] = old["svg"].clone();
                    item["far"] = old["far"].clone();
                    item.as_object_mut().expect("an object").remove("as");
                }
                None => sent += 1,
            }
            item
        });
        self.items = items.collect();
        assert_eq!(places.next(), None, "a place for each symbol that is the same");
        self.sent = sent;
        self.number = answer["number"].as_u64().expect("a number");
    }
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
